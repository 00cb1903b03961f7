from dataclasses import replace

import pytest

from grader.catalog.refreshed import RefreshedAssignments
from grader.contracts.assignment import Assignment
from grader.contracts.errors import AssignmentError, UnknownAssignmentError
from tests.fakes.grading import FakeAssignments


class Editor:
    """Assignments that somebody edits, under a clock that only the test moves."""

    def __init__(self) -> None:
        self.now_s = 0.0
        self.reads = 0
        self.saved: tuple[Assignment, ...] = FakeAssignments().all()
        self.broken = False

    def all(self) -> tuple[Assignment, ...]:
        self.reads += 1
        if self.broken:
            raise AssignmentError("square/assignment.yaml: line 3: points must be a number")
        return self.saved

    def get(self, assignment_id: str) -> Assignment:
        raise AssertionError("read all of them at once")

    def refreshed(self) -> RefreshedAssignments:
        return RefreshedAssignments(self, lambda: self.now_s)


def test_assignments_are_read_once_in_a_while() -> None:
    editor = Editor()
    assignments = editor.refreshed()
    for _ in range(50):
        assert assignments.get("square").version == 3
    assert editor.reads == 1


def test_an_edited_assignment_is_seen_without_a_restart() -> None:
    editor = Editor()
    assignments = editor.refreshed()
    editor.saved = tuple(replace(one, version=4) for one in editor.saved)
    assert assignments.get("square").version == 3
    editor.now_s += 2.0
    assert assignments.get("square").version == 4


def test_a_broken_file_does_not_stop_the_class(caplog: pytest.LogCaptureFixture) -> None:
    editor = Editor()
    assignments = editor.refreshed()
    editor.broken = True
    editor.now_s += 2.0
    assert assignments.get("square").version == 3
    assert "line 3" in caplog.text
    editor.broken = False
    editor.saved = editor.saved[:1]
    editor.now_s += 2.0
    with pytest.raises(UnknownAssignmentError, match="square"):
        assignments.get("square")


def test_a_broken_file_stops_the_start() -> None:
    editor = Editor()
    editor.broken = True
    with pytest.raises(AssignmentError):
        editor.refreshed()
