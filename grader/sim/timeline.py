"""Physics steps and virtual time: step k stands at k/240 s, derived from its index, never accumulated.

1/240 s is not a whole number of nanoseconds (12 500 000 / 3), so the instant of a step is rounded down once,
from its index; the error never grows.
"""

from typing import Final

STEPS_PER_S: Final = 240
STEP_S: Final = 1.0 / STEPS_PER_S
SAMPLE_STEPS: Final = 4  # a trajectory sample every 1/60 s
NS_PER_S: Final = 1_000_000_000

_THREE_STEPS_NS: Final = 3 * NS_PER_S // STEPS_PER_S


def step_time_ns(step: int) -> int:
    """Return the virtual instant of step `step`, in nanoseconds."""
    return step * _THREE_STEPS_NS // 3


def first_step_at(t_ns: int) -> int:
    """Return the first step that stands at or after `t_ns`: the one at which a command of `t_ns` acts."""
    return -(-3 * t_ns // _THREE_STEPS_NS)


def last_step_at(t_ns: int) -> int:
    """Return the last step that stands at or before `t_ns`."""
    return (3 * t_ns + 2) // _THREE_STEPS_NS
