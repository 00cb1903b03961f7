"""Rooms for tests, and a robot's body that tells what it felt."""

import math

from grader.contracts.assignment import Room, Solid
from grader.sim.car import PlanarPose


def solid(kind: str, x: float, y: float, length: float, width: float, heading_deg: float = 0.0) -> Solid:
    return Solid(
        kind=kind,  # type: ignore[arg-type]
        x_m=x,
        y_m=y,
        heading_deg=heading_deg,
        length_m=length,
        width_m=width,
        height_m=0.4,
    )


def room(left: float, bottom: float, right: float, top: float, *things: Solid) -> Room:
    """Return a room whose walls are 0.1 m thick and stand outside of its floor."""
    x, y, wide, high = (left + right) / 2, (bottom + top) / 2, right - left + 0.2, top - bottom + 0.2
    edges = (
        solid("edge", left - 0.05, y, 0.1, high),
        solid("edge", x, bottom - 0.05, wide, 0.1),
        solid("edge", right + 0.05, y, 0.1, high),
        solid("edge", x, top + 0.05, wide, 0.1),
    )
    return Room(left_m=left, bottom_m=bottom, right_m=right, top_m=top, solids=(*edges, *things))


class Notebook:
    """Keeps what a car does."""

    def __init__(self) -> None:
        self.samples: list[tuple[int, PlanarPose, float, float]] = []
        self.contacts: list[tuple[int, int, str]] = []

    def sample(self, t_ns: int, pose: PlanarPose, v_mps: float, w_radps: float) -> None:
        self.samples.append((t_ns, pose, v_mps, w_radps))

    def jump(self, t_ns: int, pose: PlanarPose, v_mps: float, w_radps: float) -> None:
        raise AssertionError("a robot never jumps")

    def contact(self, start_ns: int, end_ns: int, wall: str) -> None:
        self.contacts.append((start_ns, end_ns, wall))


def seen_from(start: PlanarPose, pose: PlanarPose) -> PlanarPose:
    """Return a pose in the frame of another one."""
    dx, dy = pose[0] - start[0], pose[1] - start[1]
    c, s = math.cos(start[2]), math.sin(start[2])
    return dx * c + dy * s, dy * c - dx * s, math.remainder(pose[2] - start[2], math.tau)
