"""What is measured of the running service."""

from dataclasses import dataclass
from datetime import datetime

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
        oldest_queued_at: instant at which the fresh one that waits longest was queued; None when none waits.
        workers: those that live, of all processes.
        free_bytes: room on the database's disk; None of a server.
    """

    at: datetime
    depths: tuple[QueueDepth, ...]
    oldest_queued_at: datetime | None
    workers: tuple[WorkerState, ...]
    free_bytes: int | None
