"""The worker: claims submissions, has them graded in child processes, stores the reports.

One thread per slot supervises one grading process, so a crash of the physics is one retry and nothing more;
one more thread, the heart, renews leases while the slots are busy, mends what crashed workers left, and says
how this worker is. Killed at any moment, a worker loses nothing: its claims end with their leases.
"""

import hashlib
import logging
import os
import secrets
import socket
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, field

from grader.contracts.assignment import Assignment
from grader.contracts.errors import GraderError, InfrastructureError, SandboxUnavailableError
from grader.contracts.grading import (
    AssignmentSource,
    GradingJob,
    GradingResult,
    SandboxState,
    SupervisedGrader,
)
from grader.contracts.report import GradeStatus
from grader.contracts.submission import Claim, SubmissionState, WorkerState
from grader.contracts.telemetry import GradingObserver, Unobserved
from grader.store.columns import Clock
from grader.store.doorbell import Doorbell
from grader.store.queue import Queue
from grader.store.work import PolledWork, WorkSource
from grader.store.workers import Workers
from grader.telemetry.context import about

_log = logging.getLogger(__name__)
_STORE_PAUSES_S = (0.05, 0.2, 0.5, 1.0, 2.0, 4.0)  # a database server that restarts is back by then
_ABORT_S = 5.0


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


class GradingSlot:
    """One grading at a time. Only `claim` and `abort` may be used from other threads."""

    def __init__(self, name: str, parts: WorkerParts, sandbox: Sandbox) -> None:
        self._name = name
        self._parts = parts
        self._sandbox = sandbox
        self._grader = parts.make_grader()
        self.claim: Claim | None = None

    def warm_up(self) -> None:
        """Start the grading process before there is work."""
        try:
            self._grader.start()
        except GraderError as error:
            _log.warning("%s: the grading process did not start: %s", self._name, error)

    def step(self) -> bool:
        """Grade the submission that is due; False when there was nothing to do."""
        if not self._sandbox.state.ready:
            return False
        claim = self._parts.queue.claim(self._name)
        if claim is None:
            return False
        self.claim = claim
        try:
            with about(claim):
                self._grade(claim)
        finally:
            self.claim = None
        return True

    def abort(self) -> None:
        """Kill the grading under way."""
        self._grader.abort()

    def close(self) -> None:
        """End the grading process."""
        self._grader.close()

    def _grade(self, claim: Claim) -> None:
        begun_s = time.monotonic()
        try:
            assignment = self._parts.assignments.get(claim.assignment)
            job = GradingJob(file_name=claim.file_name, source=claim.source, assignment=assignment)
            self._grader.start()
            result = _checked(self._grader.grade(job), claim)
            stored = self._store(claim, result, assignment)
        except SandboxUnavailableError as error:
            self._sandbox.failed(error)
            self._parts.queue.hand_back(claim)
        except Exception as error:
            # no fault of the student, whatever it is: the child is replaced and the submission tried again
            self._fail(claim, error)
        else:
            _log.info("%s %s", claim.submission_id, result.report.status if stored else "dropped: fenced off")
            if stored:
                self._tell(claim, result, time.monotonic() - begun_s)

    def _tell(self, claim: Claim, result: GradingResult, grading_s: float) -> None:
        now, since = self._parts.clock(), claim.queued_at
        waited_s = None if since is None else max((now - since).total_seconds(), 0.0)
        self._parts.observer.graded(result.report.status, grading_s, waited_s)

    def _store(self, claim: Claim, result: GradingResult, assignment: Assignment) -> bool:
        for pause_s in _STORE_PAUSES_S:
            try:
                return self._parts.queue.finish(claim, result, assignment)
            except InfrastructureError as error:
                _log.warning("%s: the report could not be stored yet: %s", claim.submission_id, error)
                time.sleep(pause_s)
        return self._parts.queue.finish(claim, result, assignment)

    def _fail(self, claim: Claim, error: Exception) -> None:
        self._grader.close()
        state = self._parts.queue.fail(claim, f"{type(error).__name__}: {error}")
        if state is SubmissionState.INFRASTRUCTURE_ERROR:
            self._parts.observer.given_up()
        elif state is not None:
            self._parts.observer.retried()
        level = logging.ERROR if state is SubmissionState.INFRASTRUCTURE_ERROR else logging.WARNING
        unexpected = error if not isinstance(error, GraderError) else None
        _log.log(level, "%s, try %d: %s", claim.submission_id, claim.tries, error, exc_info=unexpected)


class Worker:
    """Slots and a heart, in threads of this process. Started once and stopped once."""

    def __init__(self, parts: WorkerParts, config: WorkerConfig) -> None:
        self.id = f"{socket.gethostname()}:{os.getpid()}:{secrets.token_hex(4)}"
        self._parts = parts
        self._config = config
        self._started_at = parts.clock()
        self._sandbox = Sandbox(parts.probe)
        self._slots = [
            GradingSlot(f"{self.id}/{number}", parts, self._sandbox) for number in range(config.slots)
        ]
        self._work = parts.work or PolledWork(parts.doorbell, config.poll_s)
        self._stopped = threading.Event()
        self._heart = threading.Thread(target=self._beat_on, name="grader-heart", daemon=True)
        self._threads = [
            threading.Thread(target=self._work_on, args=(slot,), name=f"grader-slot-{number}", daemon=True)
            for number, slot in enumerate(self._slots)
        ]

    def start(self) -> None:
        """Try the sandbox, then begin to take work."""
        self._heart.start()
        self._work.start(len(self._slots), lambda: self._sandbox.state.ready)
        for thread in self._threads:
            thread.start()

    def stop(self) -> None:
        """Take no more work, let running gradings finish, and return to the queue what takes too long."""
        self._work.drain()
        self._join(self._config.drain_s)
        self._stopped.set()
        self._heart.join(_ABORT_S)
        try:
            self._return_unfinished()
            self._parts.workers.leave(self.id)
        except InfrastructureError as error:
            _log.warning("stopped without the database, leases will end what was under way: %s", error)
        self._join(_ABORT_S)
        self._work.close()

    def beat(self) -> None:
        """Renew leases, mend what crashed workers left, say how this worker is."""
        claims = [claim for slot in self._slots if (claim := slot.claim) is not None]
        if claims:
            self._parts.queue.renew(claims)
        # only while nothing runs: trying may take longer than a lease
        if self._slots and not claims and not self._sandbox.state.ready and self._sandbox.try_out():
            self._parts.doorbell.ring()
        mended = self._parts.queue.reconcile()
        if mended.requeued or mended.given_up:
            level = logging.ERROR if mended.given_up else logging.WARNING
            _log.log(level, "%d lost gradings queued again, %d given up", mended.requeued, mended.given_up)
            self._parts.observer.retried(mended.requeued)
            self._parts.observer.given_up(mended.given_up)
            self._parts.doorbell.ring()
        self._parts.workers.report(self._state(len(claims)))

    def _return_unfinished(self) -> None:
        for slot in self._slots:
            if (claim := slot.claim) is not None:
                with about(claim):
                    _log.warning("%s goes back to the queue: the worker stops", claim.submission_id)
                self._parts.queue.hand_back(claim)  # first, so that the abort below counts for nothing
                slot.abort()

    def _state(self, busy: int) -> WorkerState:
        sandbox = self._sandbox.state
        return WorkerState(
            id=self.id,
            slots=len(self._slots),
            busy=busy,
            sandbox_ready=sandbox.ready,
            isolation=sandbox.isolation,
            detail=sandbox.detail,
            started_at=self._started_at,
            seen_at=self._parts.clock(),
        )

    def _beat_on(self) -> None:
        while True:
            try:
                self.beat()
            except Exception as error:  # a heart that stopped would give away every grading of this worker
                _log.warning("heartbeat failed: %s", error)
            if self._stopped.wait(self._config.heartbeat_s):
                return

    def _work_on(self, slot: GradingSlot) -> None:
        def step() -> bool:
            busy = slot.step()
            if busy:
                self._parts.doorbell.ring()  # for those who watch
            return busy

        slot.warm_up()
        self._work.serve(step)
        slot.close()

    def _join(self, timeout_s: float) -> None:
        deadline_s = time.monotonic() + timeout_s
        for thread in self._threads:
            thread.join(max(0.0, deadline_s - time.monotonic()))


def _checked(result: GradingResult, claim: Claim) -> GradingResult:
    """Return `result` if it grades the claimed bytes under the claimed assignment."""
    report = result.report
    if report.submission_sha256 != hashlib.sha256(claim.source).hexdigest():
        raise InfrastructureError("the grading process answered with the report of another file")
    if report.assignment != claim.assignment:
        raise InfrastructureError("the grading process graded another assignment")
    if report.status is GradeStatus.INFRASTRUCTURE_ERROR:
        raise InfrastructureError(report.summary.en or "the grading process reported a fault of its own")
    return result
