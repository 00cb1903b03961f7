"""One slot of a worker: a thread that claims a submission, has it graded in a child process, stores the report.

`WorkerParts` and `SandboxHealth` are what all slots of a worker and its heart share.
"""

import hashlib
import logging
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from datetime import timedelta
from itertools import repeat
from typing import Protocol

from grader.contracts.assignment import Assignment
from grader.contracts.errors import GraderError, InfrastructureError, NoRoomError, SandboxUnavailableError
from grader.contracts.grading import (
    GradingJob,
    GradingResult,
    SandboxState,
)
from grader.contracts.report import GradeStatus
from grader.contracts.submission import Claim, SubmissionState
from grader.grading.slot import Slot
from grader.operation.logs import about
from grader.service.worker.examiner import Uploads
from grader.service.worker.explainer import Explaining
from grader.store.clock import Clock
from grader.store.queue import Finished, Queue
from grader.store.work import Doorbell
from grader.store.workers import Workers
from grader.use_cases.course_assignments import CourseAssignments

_log = logging.getLogger(__name__)
_STORE_PAUSES_S = (0.05, 0.2, 0.5, 1.0, 2.0, *repeat(4.0, 150))
"""Pauses between tries to store a result: short at first, then 4 s each, for ten minutes in all."""
_STEP_S = 60.0  # how long a slot goes from one claim to the next without asking for work anew
TURN = timedelta(seconds=4)
"""How long a reserved slot grades one submission before it may give way to others that wait."""
_TIMES_ORDINARY = 4.0
"""A grading counts as long when it takes this many times as long as an ordinary one."""
_ROOM_PAUSE_S = 1.0
"""A script that holds every process id is ended within milliseconds, but the kernel frees them later."""


class GradingCounts(Protocol):
    """What a worker counts. `grader.operation.metrics.Metrics` says what each of it means."""

    def graded(self, verdict: GradeStatus, grading_s: float, waited_s: float) -> None:
        """Count a grading that was stored."""

    def retried(self, tries: int = 1) -> None:
        """Count tries that failed and are made again."""

    def given_up(self, submissions: int = 1) -> None:
        """Count submissions that end without a grade."""


@dataclass(frozen=True, slots=True, kw_only=True)
class WorkerParts:
    """What a worker is built from.

    Attributes:
        make_grader: returns a new grader; called once per slot.
        probe: tries the sandbox of this host; called before work is taken, and again while it is not ready.
        metrics: count how gradings went.
        uploads: assignments whose scripts are to be run; by default that is left to other workers.
        explaining: what explains marks; by default other workers do.
    """

    queue: Queue
    workers: Workers
    assignments: CourseAssignments
    make_grader: Callable[[], Slot]
    probe: Callable[[], SandboxState]
    doorbell: Doorbell
    clock: Clock
    metrics: GradingCounts
    uploads: Uploads | None = None
    explaining: Explaining | None = None


class SandboxHealth:
    """Whether gradings can be confined on this host. No slot takes work until the sandbox was found ready."""

    def __init__(self, probe: Callable[[], SandboxState]) -> None:
        self._probe = probe
        self.state = SandboxState(ready=False, detail="the sandbox was not tried yet")

    def try_out(self) -> bool:
        """Try the sandbox; return whether it became ready just now."""
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


class WorkerSlot:
    """One grading at a time. Only `claim`, `stop`, `abort` and `abandon` may be used from other threads.

    Attributes:
        name: the name under which it claims submissions.
        claim: the submission being graded; None between two gradings.
    """

    def __init__(
        self, name: str, parts: WorkerParts, sandbox: SandboxHealth, *, reserved: bool = False
    ) -> None:
        """Make the grader, not started yet.

        Args:
            name: the name under which it claims submissions.
            parts: shared with the other slots of the worker.
            sandbox: shared with them, too.
            reserved: keep the slot free for short gradings: claim a submission before its turn only if grading it
                will probably be short. One of a student who is being graded already, or whose gradings took long
                lately, waits for its turn or for another slot.
        """
        self.name = name
        self._reserved = reserved
        self._parts = parts
        self._sandbox = sandbox
        self._grader = parts.make_grader()
        self.claim: Claim | None = None
        self._claimed_at = parts.clock()
        self._abandoned: Claim | None = None
        self._gives_way = False
        self._stopping = threading.Event()
        self._lock = threading.Lock()  # whoever abandons a claim must not kill the grading of the next one

    def warm_up(self) -> None:
        """Start the grading process before there is work."""
        try:
            self._grader.start()
        except GraderError as error:
            _log.warning("%s: the grading process did not start: %s", self.name, error)

    def step(self) -> bool:
        """Grade the submission that is due, then those due after it; False when there was nothing to do.

        Ends after a minute even if more is due, and at once when the worker stops or a try fails.
        """
        if not self._sandbox.state.ready:
            return False
        claim = self._parts.queue.claim(self.name, in_turn=self._reserved)
        if claim is None:
            return False
        until_s = time.monotonic() + _STEP_S
        while claim is not None:
            self._claimed_at, self.claim = self._parts.clock(), claim
            try:
                with about(claim):
                    claim = self._grade(claim, until_s)
            finally:
                with self._lock:
                    ended, self.claim = self.claim, None
                if self._abandoned is ended:  # the kill may come late: it must not hit the next grading
                    self._grader.close()
            self._parts.doorbell.ring()  # for those who watch
        return True

    def stop(self) -> None:
        """Take nothing more once the grading under way has ended; from any thread."""
        self._stopping.set()

    def abort(self) -> None:
        """Kill the grading under way."""
        self._grader.abort()

    def abandon(self, claim: Claim, *, gives_way: bool = False) -> None:
        """Kill the grading of `claim`, which was lost or gives way to others, unless it has ended already."""
        with self._lock:
            if self.claim is claim and self._abandoned is not claim:
                self._abandoned, self._gives_way = claim, gives_way
                self._grader.abort()

    def give_way(self) -> None:
        """In a reserved slot, end a first try that takes long while others' turn has come.

        A try takes long if it exceeds both `TURN` and a multiple of the median of recent gradings (the median,
        so that gradings of minutes do not count as ordinary). The submission goes behind those that wait, and its
        second try runs to the end in any slot. That may be much later, hence the multiple: on a busy host, where
        every grading takes longer, a right script must not give way.
        """
        claim, queue = self.claim, self._parts.queue
        if claim is None or not self._reserved or claim.tries > 1:
            return
        held = self._parts.clock() - self._claimed_at
        if held <= TURN or held.total_seconds() <= _TIMES_ORDINARY * (queue.median_duration_s() or 0.0):
            return
        if queue.is_due(in_turn=True):
            self.abandon(claim, gives_way=True)

    def close(self) -> None:
        """End the grading process."""
        self._grader.close()

    def _grade(self, claim: Claim, until_s: float) -> Claim | None:
        """Grade a claimed submission and store the report; return what was claimed next."""
        begun_s = time.monotonic()
        running = threading.Event()
        try:
            assignments = self._parts.assignments.of(claim.course)
            assignment = assignments.get(claim.assignment).of_course(claim.distro, claim.runs_as)
            job = GradingJob(file_name=claim.file_name, source=claim.source, assignment=assignment)
            self._grader.start()
            result = _checked(self._grader.grade(job, running.set), claim)
            finished = self._store(claim, result, assignment, until_s)
        except SandboxUnavailableError as error:
            self._sandbox.failed(error)
            self._parts.queue.hand_back(claim)
        except NoRoomError as error:
            self._wait_for_room(claim, error)
        except Exception as error:
            # never the student's fault: the child is replaced and the submission tried again
            self._fail(claim, error, had_run=running.is_set())
        else:
            _log.info(
                "%s %s",
                claim.submission_id,
                result.report.status if finished.stored else "dropped: fenced off",
            )
            if finished.stored:
                self._count(claim, result, time.monotonic() - begun_s)
            return finished.following
        return None

    def _count(self, claim: Claim, result: GradingResult, grading_s: float) -> None:
        # a clock may be set back
        waited_s = max((self._parts.clock() - claim.queued_at).total_seconds(), 0.0)
        self._parts.metrics.graded(result.report.status, grading_s, waited_s)

    def _store(self, claim: Claim, result: GradingResult, assignment: Assignment, until_s: float) -> Finished:
        """Store `result`; return whether it was taken, and what was claimed next unless the slot should pause."""
        for pause_s in _STORE_PAUSES_S:
            try:
                return self._store_once(claim, result, assignment, until_s)
            except InfrastructureError as error:
                _log.warning("%s: the report could not be stored yet: %s", claim.submission_id, error)
            time.sleep(pause_s)
        return self._store_once(claim, result, assignment, until_s)

    def _store_once(
        self, claim: Claim, result: GradingResult, assignment: Assignment, until_s: float
    ) -> Finished:
        queue = self._parts.queue
        if self._stopping.is_set() or not self._sandbox.state.ready or time.monotonic() >= until_s:
            return Finished(queue.finish(claim, result, assignment))
        finished = queue.finish_and_claim(claim, result, assignment, self.name, self._reserved)
        if finished.following is not None and self._stopping.is_set():  # `stop` was called meanwhile
            queue.hand_back(finished.following)
            return Finished(finished.stored)
        return finished

    def _wait_for_room(self, claim: Claim, error: NoRoomError) -> None:
        """Queue a submission again that could not be started for lack of room; this does not count as a try."""
        if self._abandoned is claim:
            self._fail(claim, error, had_run=False)
            return
        self._grader.close()
        self._parts.queue.hand_back(claim, f"{type(error).__name__}: {error}", _ROOM_PAUSE_S)
        _log.warning("%s waits for room: %s", claim.submission_id, error)
        self._stopping.wait(_ROOM_PAUSE_S)  # the next submission would find no room either

    def _fail(self, claim: Claim, error: Exception, *, had_run: bool) -> None:
        self._grader.close()
        if self._abandoned is claim and self._gives_way:
            self._parts.queue.put_behind(claim, "it took long while others waited")
            _log.warning("%s takes long while others wait: it goes on behind them", claim.submission_id)
            return
        if self._abandoned is claim:
            _log.warning("%s: its claim was lost, this grading of it is given up", claim.submission_id)
            return
        state = self._parts.queue.fail(claim, f"{type(error).__name__}: {error}", had_run=had_run)
        if state is SubmissionState.INFRASTRUCTURE_ERROR:
            self._parts.metrics.given_up()
        elif state is not None:
            self._parts.metrics.retried()
        # None: by now another slot has claimed the submission
        ends = {None: logging.INFO, SubmissionState.INFRASTRUCTURE_ERROR: logging.ERROR}
        level = ends.get(state, logging.WARNING)
        unexpected = error if not isinstance(error, GraderError) else None
        _log.log(level, "%s, try %d: %s", claim.submission_id, claim.tries, error, exc_info=unexpected)


def _checked(result: GradingResult, claim: Claim) -> GradingResult:
    """Return `result` if it grades the claimed bytes under the claimed assignment."""
    report = result.report
    if report.submission_sha256 != hashlib.sha256(claim.source).hexdigest():
        raise InfrastructureError("the grading process answered with the report of another file")
    if report.assignment != claim.assignment:
        raise InfrastructureError("the grading process graded another assignment")
    return result
