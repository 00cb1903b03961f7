"""What is expected of a script in `scripts/`, written by hand from reading the script."""

from dataclasses import dataclass

from grader.contracts.outcome import RunStatus
from tests.styles.ideal import Jump, Leg

Plan = tuple[Leg | Jump, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Expectation:
    """How a script must behave.

    Attributes:
        plan: what an ideal turtle does under it.
        horizon_s: when Ctrl+C comes. args, stdin: what the script is given.
        stdout: all of it, or None where it does not matter.
        says: texts that stderr (where logs go) must hold, in this order.
        error, cleanup: type of the exception that ended the script, before or after Ctrl+C, or empty.
        exit_code: of the process, or None where it does not matter.
        notes: codes of the notes to the student that must be among the run's.
    """

    plan: Plan
    status: RunStatus = RunStatus.FINISHED
    horizon_s: float = 20.0
    args: tuple[str, ...] = ()
    stdin: str = ""
    stdout: str | None = None
    says: tuple[str, ...] = ()
    error: str = ""
    cleanup: str = ""
    exit_code: int | None = None
    notes: tuple[str, ...] = ()


def drive(start_s: float, *legs: tuple[float, float, float]) -> Plan:
    """Return legs (duration, v, w) that follow each other without a gap from `start_s` on."""
    plan: list[Leg] = []
    for duration_s, v_mps, w_radps in legs:
        plan.append(Leg(start_s, duration_s, v_mps, w_radps))
        start_s += duration_s
    return tuple(plan)
