"""The assignments of each course: those of every course, from folders, and those that were uploaded to it.

One that was uploaded stands in the place of the one of its id that every course has.
"""

import logging
import threading
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from grader.catalog.misfits import refusals
from grader.contracts.assignment import Assignment
from grader.contracts.errors import UnknownAssignmentError
from grader.contracts.grading import AssignmentSource
from grader.contracts.record import from_json
from grader.contracts.text import Text
from grader.grading.examination import misfits
from grader.grading.examination.reading import Reading
from grader.grading.examination.zipped import unpacked
from grader.store.own_assignments import Mark, OwnAssignments

_log = logging.getLogger(__name__)
_FRESH_S = 0.5
_GIVEN_FILES = ("starter.py", "solution.py", "starter.zip", "solution.zip")
_OUTDATED = Text(
    zh="服务升级后这个作业的文件要重新上传",
    en="the service was upgraded since this was uploaded; upload the folder again",
)


class CourseAssignments:
    """The assignments of each course; thread-safe.

    What is uploaded to a course is read again when the last look is half a second old. An upload
    that this version of the grader cannot use disables only itself: `troubles` of its course names it.
    """

    def __init__(
        self,
        shared: AssignmentSource,
        own: OwnAssignments,
        monotonic_s: Callable[[], float] = time.monotonic,
    ) -> None:
        self._shared = shared
        self._own = own
        self._monotonic_s = monotonic_s
        self._lock = threading.Lock()
        self._read_at_s: float | None = None
        self._known: dict[tuple[str, str], tuple[Mark, Assignment | Text]] = {}

    def of(self, course: str | None) -> AssignmentSource:
        """Return the assignments of a course; None: those that every course has."""
        if course is None:
            return self._shared
        with self._lock:
            self._refresh()
            uploaded = {id_: one for (of, id_), (_, one) in self._known.items() if of == course}
        return _OfCourse(self._shared, self._own, course, uploaded) if uploaded else self._shared

    def look_again(self) -> None:
        """Look for uploads at the next question."""
        with self._lock:
            self._read_at_s = None

    def _refresh(self) -> None:
        now_s = self._monotonic_s()
        if self._read_at_s is not None and now_s - self._read_at_s < _FRESH_S:
            return
        fresh = {}
        for key, mark in self._own.marks().items():
            before = self._known.get(key)
            fresh[key] = (mark, self._read(key, mark)) if before is None or before[0] != mark else before
        self._known, self._read_at_s = fresh, now_s

    def _read(self, key: tuple[str, str], mark: Mark) -> Assignment | Text:
        course, assignment_id = key
        content = self._own.reading(course, assignment_id, mark[0]) or b""
        try:
            assignment = from_json(Reading, content).assignment
        except ValueError as error:
            _log.error("assignment %s of course %s cannot be used: %s", assignment_id, course, error)
            return _OUTDATED
        if assignment is None:
            return _OUTDATED
        problems = misfits(assignment)
        if problems:
            refusal = refusals(problems)
            return Text(zh=refusal.message_in("zh"), en=refusal.message_in("en"))
        return assignment


@dataclass(frozen=True, slots=True)
class _OfCourse:
    """The assignments of one course at one moment."""

    shared: AssignmentSource
    stored: OwnAssignments
    course: str
    uploaded: Mapping[str, Assignment | Text]

    def all(self) -> tuple[Assignment, ...]:
        own = {id_: one for id_, one in self.uploaded.items() if isinstance(one, Assignment)}
        shared = (assignment for assignment in self.shared.all() if assignment.id not in own)
        return tuple(sorted((*shared, *own.values()), key=lambda one: (one.order, one.id)))

    def get(self, assignment_id: str) -> Assignment:
        own = self.uploaded.get(assignment_id)
        if isinstance(own, Assignment):
            return own
        try:
            return self.shared.get(assignment_id)
        except UnknownAssignmentError:
            raise UnknownAssignmentError.among(
                (assignment.id for assignment in self.all()), assignment_id
            ) from None

    def troubles(self) -> Mapping[str, Text]:
        own = {id_: one for id_, one in self.uploaded.items() if isinstance(one, Text)}
        return {**self.shared.troubles(), **own}

    def starter(self, assignment_id: str) -> bytes:
        return self._stored(assignment_id).get("starter.py") or self.shared.starter(assignment_id)

    def files(self, assignment_id: str) -> Mapping[str, bytes]:
        return self._stored(assignment_id) or self.shared.files(assignment_id)

    def _stored(self, assignment_id: str) -> Mapping[str, bytes]:
        folder = self.stored.in_use(self.course).get(assignment_id)
        return {} if folder is None else unpacked(folder)

    def given_code(self) -> tuple[bytes, ...]:
        folders = [unpacked(folder) for folder in self.stored.in_use(self.course).values()]
        own = tuple(files[name] for files in folders for name in _GIVEN_FILES if name in files)
        return (*self.shared.given_code(), *own)
