from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from grader.catalog import Catalog
from grader.catalog.refreshed import RefreshedAssignments
from grader.checks import problems
from grader.contracts.assignment import Assignment
from grader.contracts.errors import AssignmentError, UnknownAssignmentError
from grader.contracts.text import Text
from tests.fakes.grading import FakeAssignments

BROKEN = AssignmentError("square/assignment.yaml: line 3: points must be a number", "第 3 行：points 要是数")


class Editor:
    """A folder that somebody edits, under a clock that only the test moves."""

    def __init__(self) -> None:
        self.now_s = 0.0
        self.reads = 0
        self.saved: dict[str, Assignment | AssignmentError] = {one.id: one for one in FakeAssignments().all()}

    def each(self) -> Iterator[tuple[str, Assignment | AssignmentError]]:
        self.reads += 1
        yield from self.saved.items()

    def refreshed(self, *others: "Editor") -> RefreshedAssignments:
        return RefreshedAssignments((self, *others), lambda _: (), lambda: self.now_s)


def test_assignments_are_read_once_in_a_while() -> None:
    editor = Editor()
    assignments = editor.refreshed()
    for _ in range(50):
        assert assignments.get("square").version == 3
    assert editor.reads == 1


def test_an_edited_assignment_is_seen_without_a_restart() -> None:
    editor = Editor()
    assignments = editor.refreshed()
    editor.saved = {id_: replace(one, version=4) for id_, one in editor.saved.items()}
    assert assignments.get("square").version == 3
    editor.now_s += 2.0
    assert assignments.get("square").version == 4


def test_a_broken_file_stays_as_it_was_and_stops_no_other(caplog: pytest.LogCaptureFixture) -> None:
    editor = Editor()
    assignments = editor.refreshed()
    editor.saved |= {"square": BROKEN, "straight": replace(assignments.get("straight"), version=4)}
    editor.now_s += 2.0
    assert assignments.get("square").version == 3
    assert assignments.get("straight").version == 4
    assert assignments.troubles()["square"].zh == "第 3 行：points 要是数"
    for _ in range(3):
        editor.now_s += 2.0
        assignments.all()
    assert caplog.text.count("line 3") == 1
    del editor.saved["square"]
    editor.now_s += 2.0
    assert assignments.troubles() == {}
    with pytest.raises(UnknownAssignmentError, match="square"):
        assignments.get("square")


def test_a_rubric_changes_with_its_version_only() -> None:
    editor = Editor()
    assignments = editor.refreshed()
    before = assignments.get("square")
    stricter = replace(before.items[0], points=before.items[0].points + 1)
    edited = replace(
        before, brief=Text(zh="新", en="new"), items=(stricter, *before.items[1:]), horizon_s=9.0
    )
    editor.saved["square"] = edited
    editor.now_s += 2.0
    assert assignments.get("square") == before
    told = assignments.troubles()["square"].en
    assert told == f"horizon_s, items.{stricter.id}.points changed, but version is still 3: raise it"
    editor.saved["square"] = replace(edited, version=4)
    editor.now_s += 2.0
    assert assignments.get("square").horizon_s == 9.0
    editor.saved["square"] = replace(edited, version=4, title=Text(zh="题", en="title"))
    editor.now_s += 2.0
    assert assignments.get("square").title.en == "title"  # a text grades nothing
    assert assignments.troubles() == {}


def test_what_was_broken_at_the_start_is_missing_until_it_is_mended() -> None:
    editor = Editor()
    good, editor.saved["square"] = editor.saved["square"], BROKEN
    assignments = editor.refreshed()
    assert [one.id for one in assignments.all()] == ["straight"]
    editor.saved["square"] = good
    editor.now_s += 2.0
    assert [one.id for one in assignments.all()] == ["straight", "square"]
    assert assignments.troubles() == {}


def test_an_id_belongs_to_the_first_folder_that_has_it() -> None:
    first, second = Editor(), Editor()
    second.saved = {"square": replace(FakeAssignments().get("square"), version=9)}
    assignments = first.refreshed(second)
    assert assignments.get("square").version == 3
    assert "rename one" in assignments.troubles()["square"].en


def test_a_folder_that_is_not_there_stops_the_start(tmp_path: Path) -> None:
    with pytest.raises(AssignmentError, match="not a folder"):
        RefreshedAssignments([Catalog(tmp_path / "none")], problems)
    (tmp_path / "broken").mkdir()
    (tmp_path / "broken" / "assignment.yaml").write_text("id: [")
    assert list(RefreshedAssignments([Catalog(tmp_path)], problems).troubles()) == ["broken"]
