"""What is measured of the running service, and the observer of its gradings."""

from dataclasses import dataclass
from datetime import datetime
from typing import Protocol

from grader.contracts.report import GradeStatus
from grader.contracts.submission import WorkerState


@dataclass(frozen=True, slots=True, kw_only=True)
class QueueDepth:
    """How many submissions of one priority are in one state. Priority 0 is the fresh ones."""

    state: str
    priority: int
    count: int


@dataclass(frozen=True, slots=True, kw_only=True)
class ServiceState:
    """What the database says about queue and workers at one instant.

    Attributes:
        oldest_queued_at: instant at which the one that waits longest was queued; None when nothing waits.
        workers: those that live, of all processes.
    """

    at: datetime
    depths: tuple[QueueDepth, ...]
    oldest_queued_at: datetime | None
    workers: tuple[WorkerState, ...]


class GradingObserver(Protocol):
    """Observes how gradings of this process went. Called from many threads; must be quick and not raise."""

    def graded(self, verdict: GradeStatus, grading_s: float, waited_s: float | None) -> None:
        """A grading was stored, `grading_s` after its claim and `waited_s` after it was queued."""

    def retried(self, tries: int = 1) -> None:
        """Tries failed through the grader's own fault and are made again."""

    def given_up(self, submissions: int = 1) -> None:
        """The last try of submissions failed: they end without a grade."""


class Unobserved:
    """An observer that forgets everything."""

    def graded(self, verdict: GradeStatus, grading_s: float, waited_s: float | None) -> None:
        """Do nothing."""

    def retried(self, tries: int = 1) -> None:
        """Do nothing."""

    def given_up(self, submissions: int = 1) -> None:
        """Do nothing."""
