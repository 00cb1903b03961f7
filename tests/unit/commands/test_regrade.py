"""`grader regrade`: what a course graded again, and undoing it."""

from pathlib import Path

import pytest

from grader.commands import cli
from grader.contracts.identity import RosterEntry
from grader.contracts.regrade import Wanted
from grader.contracts.submission import NewSubmission
from grader.store.audit import Signature
from grader.store.courses import Courses
from grader.store.database import Database
from grader.store.queue import Queue, Retries
from grader.store.regrades import Regrades
from grader.store.schema import migrate
from tests.fakes.clock import FakeClock
from tests.fakes.grading import FakeAssignments, grade_next
from tests.fakes.submissions import Submissions


def test_a_regrade_is_listed_and_undone(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    database, clock = Database(f"sqlite:///{tmp_path / 'grader.db'}"), FakeClock()
    migrate(database)
    courses = Courses(database, clock)
    courses.create("ros", "ROS", "UTC", "me")
    courses.import_roster("ros", [RosterEntry(id="li", name="")], "me")
    new = NewSubmission(
        course="ros", student="li", assignment="square", file_name="a.py", source=b"good", ruled=False
    )
    Submissions(database, clock).add(new)
    queue, regrades = Queue(database, clock, Retries()), Regrades(database)
    signed = Signature(clock(), "ros", "wang")
    grade_next(queue, FakeAssignments())
    opened = regrades.open(Wanted(assignment="square"), signed)
    grade_next(queue, FakeAssignments())
    data = ["--data", str(tmp_path), "--lang", "en"]
    undo = ["regrade", "undo", opened.id, "--reason", "x", *data]
    assert cli.run(undo) == 2
    assert "does not stand" in capsys.readouterr().err
    regrades.apply(opened.id, signed, "why")
    assert cli.run(["regrade", "list", *data]) == 0
    assert capsys.readouterr().out.split("\t")[:3] == [opened.id, "square", "applied"]
    assert cli.run(undo) == 0
    assert "square: undone" in capsys.readouterr().err
    database.close()
