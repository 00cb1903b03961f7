"""Assignments that somebody may edit while the service runs."""

import logging
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress

from grader.catalog import Catalog
from grader.catalog.misfits import refusals
from grader.contracts.assignment import Assignment, graded_otherwise
from grader.contracts.errors import AssignmentError, UnknownAssignmentError
from grader.contracts.text import Text

_log = logging.getLogger(__name__)
_FRESH_S = 2.0


class RefreshedAssignments:
    """The assignments of several folders, read again when the last reading is two seconds old.

    A broken file stops nobody but its own assignment, which stays as it was last read; one that was never read is
    missing until the file is mended. The same holds for a rubric that was changed without a new version. The log
    says why, and so does `troubles`.

    Args:
        folders: of two assignments with one id, that of the first folder is taken.
        problems: returns (field, problem) for all that does not fit an assignment's check.
        monotonic_s: a clock.

    Raises:
        AssignmentError: one of the folders is not there.
    """

    def __init__(
        self,
        folders: Sequence[Catalog],
        problems: Callable[[Assignment], Sequence[tuple[str, Text]]],
        monotonic_s: Callable[[], float] = time.monotonic,
    ) -> None:
        self._folders = folders
        self._problems = problems
        self._monotonic_s = monotonic_s
        self._lock = threading.Lock()
        self._read_at_s = monotonic_s()
        self._assignments: tuple[Assignment, ...] = ()
        self._troubles: Mapping[str, Text] = {}
        self._read()

    def all(self) -> tuple[Assignment, ...]:
        """Return every assignment in the order of the checklist."""
        with self._lock:
            self._refresh()
            return self._assignments

    def troubles(self) -> Mapping[str, Text]:
        """Return by id what is wrong with assignments that cannot be read now."""
        with self._lock:
            self._refresh()
            return self._troubles

    def get(self, assignment_id: str) -> Assignment:
        """Return one assignment, or raise UnknownAssignmentError."""
        every = self.all()
        for assignment in every:
            if assignment.id == assignment_id:
                return assignment
        raise UnknownAssignmentError.among((one.id for one in every), assignment_id)

    def starter(self, assignment_id: str) -> bytes:
        """Return the script that students of an assignment begin with; empty where it has none."""
        for folder in self._folders:
            with suppress(UnknownAssignmentError):
                return folder.starter(assignment_id)
        return b""

    def files(self, assignment_id: str) -> Mapping[str, bytes]:
        """Return the files of an assignment's folder by their paths in it; empty where there is no folder."""
        for folder in self._folders:
            with suppress(UnknownAssignmentError):
                return folder.files(assignment_id)
        return {}

    def given_code(self) -> tuple[bytes, ...]:
        """Return the scripts that every student can read: starters, solutions and the lesson's listings."""
        return tuple(code for folder in self._folders for code in folder.given_code())

    def _refresh(self) -> None:
        now_s = self._monotonic_s()
        if now_s - self._read_at_s >= _FRESH_S:
            self._read_at_s = now_s
            try:
                self._read()
            except AssignmentError as error:  # a folder is gone
                _log.error("assignments stay as they were: %s", error)

    def _read(self) -> None:
        before = {assignment.id: assignment for assignment in self._assignments}
        assignments: dict[str, Assignment] = {}
        troubles: dict[str, Text] = {}
        for folder, id_, one in ((each, *pair) for each in self._folders for pair in each.each()):
            if id_ in assignments or id_ in troubles:
                told = AssignmentError(
                    f"two folders have an assignment {id_}; rename one", f"两个文件夹里都有作业 {id_}：请改名"
                )
                troubles[id_] = told.text
            elif (error := self._trouble(folder, before.get(id_), one)) is not None:
                troubles[id_] = error.text
                if id_ in before:
                    assignments[id_] = before[id_]
            elif isinstance(one, Assignment):
                assignments[id_] = one
        for id_, trouble in troubles.items():
            if self._troubles.get(id_) != trouble:
                _log.error("assignment %s cannot be read: %s", id_, trouble.en)
        self._assignments = tuple(
            sorted(assignments.values(), key=lambda assignment: (assignment.order, assignment.id))
        )
        self._troubles = troubles

    def _trouble(
        self, folder: Catalog, before: Assignment | None, now: Assignment | AssignmentError
    ) -> AssignmentError | None:
        """Return why what a folder has now cannot take the place of what was read before; None if it can."""
        if isinstance(now, AssignmentError):
            return now
        if now is before:  # its file is the same, and it was fit
            return None
        if found := self._problems(now):
            return refusals((folder.place(now.id, field), told) for field, told in found)
        return same_version(before, now)


def same_version(before: Assignment | None, after: Assignment) -> AssignmentError | None:
    """Return the error for a rubric that was changed under its version: two gradings of it would look alike."""
    if before is None or before is after or before.version != after.version:
        return None
    changed = ", ".join(graded_otherwise(before, after))
    if not changed:
        return None
    return AssignmentError(
        f"{changed} changed, but version is still {after.version}: raise it",
        f"{changed} 改了，但 version 还是 {after.version}：请加一",
    )
