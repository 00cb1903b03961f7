"""Replayed worlds, made by hand."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from grader.contracts.replay import Replayed, ReplayedBody

EVERY_NS = 16_666_667


def replayed(
    places: Sequence[tuple[float, float, float]] = ((0.0, 0.0, 0.5),) * 2,
    links: Sequence[tuple[float, float, float]] = (),
    **more: Any,
) -> Replayed:
    """Return a world in which the object was at `places` and the robot's link at `links`, 60 times a second."""
    count = max(len(places), len(links))
    rows = np.full((count, 13), np.nan)
    if places:
        at = np.array([*places, *[places[-1]] * (count - len(places))])
        rows[:, :3], rows[:, 3:6], rows[:, 6] = at, 0.0, 1.0
        rows[:, 7:] = 0.0
        rows[1:, 7:10] = np.diff(at, axis=0) * 60.0
    hands = np.full((count, 7), np.nan)
    if links:
        hands[:, :3], hands[:, 3:6], hands[:, 6] = links, 0.0, 1.0
    bodies = [ReplayedBody(id=1, role="object", file="sphere2.urdf")] if places else []
    bodies += [ReplayedBody(id=2, role="robot", file="panda.urdf")] if links else []
    known: dict[str, Any] = {
        "end": "complete",
        "steps": 4 * (count - 1),
        "calls": 4 * count,
        "gravity": (0.0, 0.0, -9.8),
        "t_ns": np.arange(count, dtype=np.int64) * EVERY_NS,
        "calls_at": np.arange(count, dtype=np.int64) * 4,
        "object": rows,
        "power_w": np.full(count, 1e3),
        "base": np.zeros((count, 3)),
        "object_joints": np.zeros((count, 0)),
        "link": hands,
        "robot_joints": np.zeros((count, 0)),
        "pushes": ((),) * count,
        "bodies": tuple(bodies),
    }
    return Replayed(**{**known, **more})
