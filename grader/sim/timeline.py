"""Virtual time: turtlesim's updates every 16 ms, and the physics steps of 1/240 s.

Update k stands at k * 16 ms, step k at k/240 s. Both are derived from their index, so no error accumulates. A
step is not a whole number of nanoseconds (12 500 000 / 3): its instant is rounded down once.
"""

from typing import Final

NS_PER_S: Final = 1_000_000_000
UPDATE_NS: Final = 16_000_000  # turtlesim's timer
UPDATE_S: Final = UPDATE_NS / NS_PER_S

STEPS_PER_S: Final = 240
STEP_S: Final = 1.0 / STEPS_PER_S

_THREE_STEPS_NS: Final = 3 * NS_PER_S // STEPS_PER_S


def next_update(t_ns: int) -> int:
    """Return the first update later than `t_ns`: the one that takes a command or request of that time."""
    return t_ns // UPDATE_NS + 1


def step_time_ns(step: int) -> int:
    """Return the virtual instant of step `step`, in nanoseconds."""
    return step * _THREE_STEPS_NS // 3


def last_step_at(t_ns: int) -> int:
    """Return the last step that stands at or before `t_ns`."""
    return (3 * t_ns + 2) // _THREE_STEPS_NS
