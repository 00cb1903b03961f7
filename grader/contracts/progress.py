"""Where submissions and classes stand, for those who wait and watch."""

from dataclasses import dataclass, field
from datetime import datetime

from grader.contracts.submission import SubmissionState

_ENDS = (SubmissionState.GRADED, SubmissionState.INFRASTRUCTURE_ERROR)


@dataclass(frozen=True, slots=True, kw_only=True)
class Standing:
    """Where one submission stands.

    Attributes:
        attempt: claims so far.
        position: how many are before it while it waits.
        estimated_at: when it will probably be graded; guessed anew at each look, so it makes no difference
            between two standings.
    """

    id: str
    state: SubmissionState
    attempt: int
    position: int | None
    started_at: datetime | None
    estimated_at: datetime | None = field(default=None, compare=False)

    @property
    def is_final(self) -> bool:
        """Whether nothing more will happen to it by itself."""
        return self.state in _ENDS

    @property
    def mark(self) -> str:
        """Return one word that differs between standings that differ."""
        return f"{self.state.value}.{self.attempt}.{'' if self.position is None else self.position}"


@dataclass(frozen=True, slots=True, kw_only=True)
class ExplanationStanding:
    """Whether the explanation of a submission's latest grading is there, or nobody looks for one."""

    attempt: int | None
    is_final: bool

    @property
    def mark(self) -> str:
        """Return one word that differs between standings that differ."""
        return f"explanation.{self.attempt}.{self.is_final}"


@dataclass(frozen=True, slots=True, kw_only=True)
class ClassStanding:
    """Where a class stands: its submissions by state, trials left out.

    Attributes:
        mark: one word that differs whenever the class's dashboard may differ.
    """

    queued: int
    running: int
    graded: int
    infrastructure_errors: int
    mark: str

    @property
    def is_final(self) -> bool:
        """Whether nothing more will happen: a class goes on."""
        return False
