"""Assignments that somebody may edit while the service runs."""

import logging
import threading
import time
from collections.abc import Callable

from grader.contracts.assignment import Assignment
from grader.contracts.errors import AssignmentError, UnknownAssignmentError
from grader.contracts.grading import AssignmentSource

_log = logging.getLogger(__name__)
_FRESH_S = 2.0


class RefreshedAssignments:
    """Assignments that are read again when the last reading is two seconds old.

    A broken file that an instructor saves does not stop the class. Until it is mended, the assignments stay as
    they were last read, and the log says why.
    """

    def __init__(self, source: AssignmentSource, monotonic_s: Callable[[], float] = time.monotonic) -> None:
        """Read everything once.

        Raises:
            AssignmentError: a file is wrong.
        """
        self._source = source
        self._monotonic_s = monotonic_s
        self._lock = threading.Lock()
        self._read_at_s = monotonic_s()
        self._assignments = source.all()

    def all(self) -> tuple[Assignment, ...]:
        """Return every assignment in the order of the checklist."""
        with self._lock:
            now_s = self._monotonic_s()
            if now_s - self._read_at_s >= _FRESH_S:
                self._read_at_s = now_s
                try:
                    self._assignments = self._source.all()
                except AssignmentError as error:
                    _log.error("assignments stay as they were: %s", error)
            return self._assignments

    def get(self, assignment_id: str) -> Assignment:
        """Return one assignment, or raise UnknownAssignmentError."""
        for assignment in self.all():
            if assignment.id == assignment_id:
                return assignment
        raise UnknownAssignmentError(f"there is no assignment {assignment_id!r}")
