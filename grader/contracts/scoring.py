"""What the checks take and return. A module of its own, so that `rubric` is read without importing numpy."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

from grader.contracts.conversation import Conversation
from grader.contracts.outcome import RunOutcome
from grader.contracts.package import PackageProblem
from grader.contracts.record import Record
from grader.contracts.rubric import RubricItem
from grader.contracts.text import EMPTY, Text
from grader.contracts.trajectory import Trajectory

if TYPE_CHECKING:
    from grader.contracts.replay import Replayed


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Run:
    """One run of the script, as the checks see it.

    Attributes:
        case: id of one of the assignment's cases.
        conversation: what was said; None: nothing was, and nothing is expected.
        source: the script, decoded. Hints are worded by it; points never depend on it.
        package: what is wrong with the files of a package; None: a script.
        at_horizon: where the main thread was when Ctrl+C came, as the script's process says.
        replayed: what the script's PyBullet calls came to; None: it is of another world.
    """

    trajectory: Trajectory
    outcome: RunOutcome
    case: str = "default"
    conversation: Conversation | None = None
    source: str = ""
    at_horizon: str = ""
    package: tuple[PackageProblem, ...] | None = None
    replayed: "Replayed | None" = None


class Scoring(Record):
    """The checks' answer for one submission.

    Attributes:
        items: in the order of the rubric, case by case.
        summary: one sentence for the student. hint: the one next step that matters most, or empty.
        mistakes: codes of recognised mistakes, most likely first.
    """

    items: tuple[RubricItem, ...]
    summary: Text
    hint: Text = EMPTY
    mistakes: tuple[str, ...] = ()
