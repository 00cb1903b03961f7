"""turtlesim's own turtle, which obeys at once: the oracle for what the car should do."""

import math
from collections.abc import Sequence

Poses = list[tuple[float, float, float]]


def drive(
    commands: Sequence[tuple[float, float, float]], until_s: float, *, heading: float = 0.0, dt: float = 1e-3
) -> Poses:
    """Return poses every `dt` from the origin under commands (t, v, w), each held at most 1.0 s."""
    x = y = 0.0
    poses = [(x, y, heading)]
    pending = list(commands)
    v = w = 0.0
    last = -math.inf
    for tick in range(round(until_s / dt)):
        now = tick * dt
        while pending and pending[0][0] <= now + 1e-9:
            last, v, w = pending.pop(0)
        if now - last > 1.0:
            v = w = 0.0
        middle = heading + 0.5 * w * dt
        x += v * dt * math.cos(middle)
        y += v * dt * math.sin(middle)
        heading += w * dt
        poses.append((x, y, heading))
    return poses
