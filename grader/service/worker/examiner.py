"""Examines what instructors upload: runs an assignment's own scripts behind all gradings of students.

A worker has one thread for it, with a grading process of its own that lives only while an upload is examined, of
a lower priority than theirs. Before each script it lets students go first for a while: a busy service examines
slowly, but it examines, and no student waits for more than a share of a processor.
"""

import json
import logging
import threading
import time
from collections.abc import Callable
from contextlib import closing
from dataclasses import dataclass, replace
from itertools import count

from grader.catalog.refreshed import same_version
from grader.contracts.assignment import Assignment
from grader.contracts.errors import AssignmentError, GraderError, InfrastructureError, UnknownAssignmentError
from grader.contracts.own_assignment import Examined, Misfit, ScriptVerdict
from grader.contracts.record import from_json, to_plain
from grader.contracts.text import EMPTY, Text
from grader.grading.examination import Examination, examine, own_scripts
from grader.grading.examination import misfits as misfits_with_check
from grader.grading.examination.reading import Reading, misfits_of
from grader.grading.examination.reference import traced, wants_reference
from grader.grading.examination.zipped import unpacked
from grader.grading.slot import Slot
from grader.store.own_assignments import OwnAssignments, OwnClaim
from grader.use_cases.course_assignments import CourseAssignments

_log = logging.getLogger(__name__)
_LOOK_S = 2.0
_GLANCE_S = 0.2
_MOST_TRIES = 4
_PAUSE_S = 15.0
_GIVEN_UP = Text(
    zh="服务没能运行这些脚本：请稍后重新上传；再失败请告诉管理员",
    en="the service could not run the scripts; upload the folder again later, and tell the operator if that fails",
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Uploads:
    """What examining uploads takes.

    Attributes:
        make_grader: returns a new grader; called for each upload.
        patience_s: how long students' gradings go first before each script.
    """

    own: OwnAssignments
    make_grader: Callable[[], Slot]
    patience_s: float = 20.0


class _LostError(Exception):
    """Somebody else has the upload, it is gone, or the worker stops."""


class Examiner:
    """One thread that examines uploads while the sandbox is ready. Started once and stopped once."""

    def __init__(
        self,
        uploads: Uploads,
        assignments: CourseAssignments,
        *,
        ready: Callable[[], bool],
        students_wait: Callable[[], bool],
    ) -> None:
        """Prepare; nothing is started.

        Args:
            uploads: where they are, and what grades.
            assignments: which are in use already.
            ready: whether scripts can be confined.
            students_wait: whether a student's submission is due.
        """
        self._uploads = uploads
        self._assignments = assignments
        self._ready = ready
        self._students_wait = students_wait
        self._stopping = threading.Event()
        self._grader: Slot | None = None
        self._thread = threading.Thread(target=self._work, name="grader-examiner", daemon=True)

    def start(self) -> None:
        """Begin to look for uploads."""
        self._thread.start()

    def stop(self, patience_s: float) -> None:
        """End a script under way, give the upload back, and wait for that at most `patience_s`."""
        self._stopping.set()
        grader = self._grader
        if grader is not None:
            grader.abort()
        self._thread.join(patience_s)

    def step(self) -> bool:
        """Examine the upload that waits longest; False when none does."""
        claim = self._uploads.own.claim() if self._ready() else None
        if claim is None:
            return False
        try:
            with closing(self._uploads.make_grader()) as grader:
                self._grader = grader
                self._examine(claim, grader)
        except _LostError:
            if self._stopping.is_set():
                self._uploads.own.hand_back(claim, "", 0.0)
        except Exception as error:  # no fault of the upload's, whatever it is: it is tried again
            self._fail(claim, error)
        finally:
            self._grader = None
        return True

    def _work(self) -> None:
        while not self._stopping.is_set():
            busy = False
            try:
                busy = self.step()
            except InfrastructureError as error:
                _log.warning("no upload could be looked for: %s", error)
            except Exception:
                _log.exception("no upload could be looked for")
            if not busy:
                self._stopping.wait(_LOOK_S)

    def _examine(self, claim: OwnClaim, grader: Slot) -> None:
        files, reading = unpacked(claim.content), from_json(Reading, claim.reading)
        assert reading.assignment is not None
        try:
            assignment = self._recorded(claim, reading.assignment, files, grader)
            self._require_version(claim, assignment)
        except AssignmentError as error:
            self._finish(claim, Examined(misfits=misfits_of(error)), ready=False)
            return
        own = own_scripts(assignment, reading.wrong, reading.scripts(files))
        steps = (
            Examined(begun=number, scripts=2 + len(own.wrong)) for number in count(1)
        )  # the solution and the starter come first
        examination = examine(own, grader, before_each=lambda: self._give_way(claim, next(steps)))
        verdicts = _verdicts(examination)
        fine = all(verdict.problem == EMPTY for verdict in verdicts)
        changed = None if assignment is reading.assignment else replace(reading, assignment=assignment)
        self._finish(claim, Examined(verdicts=verdicts), ready=fine, reading=changed)

    def _recorded(
        self, claim: OwnClaim, assignment: Assignment, files: dict[str, bytes], grader: Slot
    ) -> Assignment:
        """Return an assignment with what its solution drives, where it wants that."""
        if not wants_reference(assignment) or assignment.path is None:
            return assignment
        self._give_way(claim)
        name = "solution.py"
        trace = traced(assignment, name, files[name], grader)
        whole = replace(assignment, path=replace(assignment.path, trace=trace))
        misfits = misfits_with_check(whole)
        if misfits:
            error = AssignmentError()
            error.problems = tuple(misfits)
            raise error
        return whole

    def _require_version(self, claim: OwnClaim, assignment: Assignment) -> None:
        """Refuse what drives otherwise than the one in use, under the same version."""
        try:
            before = self._assignments.of(claim.course).get(claim.assignment)
        except UnknownAssignmentError:
            return
        error = same_version(before, assignment)
        if error is not None:
            raise error

    def _give_way(self, claim: OwnClaim, progress: Examined = Examined()) -> None:  # noqa: B008 - frozen
        """Wait for a while until no student waits, then renew the claim and say how far it is.

        Raises _LostError: the claim is lost, or the worker stops.
        """
        until_s = time.monotonic() + self._uploads.patience_s
        while not self._stopping.is_set() and time.monotonic() < until_s and self._students_wait():
            self._stopping.wait(_GLANCE_S)
        if self._stopping.is_set() or not self._uploads.own.renew(claim, _json(progress)):
            raise _LostError

    def _finish(
        self, claim: OwnClaim, examined: Examined, *, ready: bool, reading: Reading | None = None
    ) -> None:
        content = None if reading is None else _json(reading)
        stored = self._uploads.own.finish(claim, _json(examined), ready=ready, reading=content)
        _log.info(
            "assignment %s of course %s: %s",
            claim.assignment,
            claim.course,
            ("can be used" if ready else "refused") if stored else "dropped: it was replaced",
        )

    def _fail(self, claim: OwnClaim, error: Exception) -> None:
        if self._stopping.is_set():
            self._uploads.own.hand_back(claim, "", 0.0)
            return
        trouble = f"{type(error).__name__}: {error}"
        level = logging.WARNING if isinstance(error, GraderError) else logging.ERROR
        _log.log(level, "assignment %s of course %s: %s", claim.assignment, claim.course, trouble)
        if claim.tries < _MOST_TRIES:
            self._uploads.own.hand_back(claim, trouble, _PAUSE_S * claim.tries)
        else:
            examined = Examined(misfits=(Misfit(file="", told=_GIVEN_UP),))
            self._uploads.own.finish(claim, _json(examined), ready=False)


def _verdicts(examination: Examination) -> tuple[ScriptVerdict, ...]:
    return tuple(
        ScriptVerdict(
            script=finding.script, score=finding.score, max_score=finding.max_score, problem=finding.problem
        )
        for finding in examination.findings
    )


def _json(value: object) -> bytes:
    return json.dumps(value, default=to_plain).encode()
