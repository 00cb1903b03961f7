"""What a worker is built from, and what it knows of its sandbox."""

import logging
from collections.abc import Callable
from dataclasses import dataclass, field

from grader.contracts.errors import SandboxUnavailableError
from grader.contracts.grading import AssignmentSource, SandboxState, SupervisedGrader
from grader.contracts.telemetry import GradingObserver, Unobserved
from grader.store.columns import Clock
from grader.store.doorbell import Doorbell
from grader.store.queue import Queue
from grader.store.work import WorkSource
from grader.store.workers import Workers

_log = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True, kw_only=True)
class WorkerConfig:
    """Pace of a worker; the fields mean what they mean in `grader.settings.Settings`."""

    slots: int
    heartbeat_s: float = 3.0
    poll_s: float = 0.5
    drain_s: float = 30.0


@dataclass(frozen=True, slots=True, kw_only=True)
class WorkerParts:
    """What a worker is built from.

    Attributes:
        make_grader: returns a new grader; called once per slot.
        probe: tries the sandbox of this host; called before work is taken, and again while it is not ready.
        observer: is told how gradings went.
        work: tells the slots when to look for work; by default the doorbell and a look every `poll_s`.
    """

    queue: Queue
    workers: Workers
    assignments: AssignmentSource
    make_grader: Callable[[], SupervisedGrader]
    probe: Callable[[], SandboxState]
    doorbell: Doorbell
    clock: Clock
    observer: GradingObserver = field(default_factory=Unobserved)
    work: WorkSource | None = None


class Sandbox:
    """What is known of the sandbox; no slot takes work until it was seen ready."""

    def __init__(self, probe: Callable[[], SandboxState]) -> None:
        self._probe = probe
        self.state = SandboxState(ready=False, detail="the sandbox was not tried yet")

    def try_out(self) -> bool:
        """Try the sandbox; whether it became ready by that."""
        before = self.state
        try:
            self.state = self._probe()
        except Exception as error:  # whatever it is, nothing may be graded
            self.state = SandboxState(ready=False, detail=f"the sandbox could not be tried: {error}")
        if not self.state.ready and self.state.detail != before.detail:
            _log.error("nothing is graded: %s", self.state.detail)
        return self.state.ready and not before.ready

    def failed(self, error: SandboxUnavailableError) -> None:
        """Note that a grading found a layer missing."""
        _log.error("grading stops: %s", error)
        self.state = SandboxState(ready=False, isolation=self.state.isolation, detail=str(error))
