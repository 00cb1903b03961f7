"""Forgetting a student, and erasing what is old: nothing of it is left anywhere in the database."""

import gzip
import re
from datetime import timedelta
from pathlib import Path

import pytest
from sqlalchemy import Column, MetaData, String, Table
from sqlmodel import SQLModel, select

from grader.contracts.errors import CourseError, RefusedError
from grader.contracts.grading import GradingJob
from grader.contracts.identity import Role, RosterEntry
from grader.contracts.regrade import Wanted
from grader.contracts.rules import Extension
from grader.contracts.submission import NewSubmission
from grader.store.audit import AuditLog, Signature
from grader.store.comments import Comments
from grader.store.course_life import CourseLife
from grader.store.courses import Courses
from grader.store.dashboard import Dashboard
from grader.store.database import Database
from grader.store.erasing import Space
from grader.store.forgetting import NAMES_NOBODY, naming_columns
from grader.store.judgements import Given, Judgements
from grader.store.queue import Queue, Retries
from grader.store.regrades import Regrades
from grader.store.rules import StoredRules
from grader.store.tables import PlainText
from grader.store.tokens import Tokens
from tests.fakes.clock import FakeClock
from tests.fakes.essays import ANSWER, grade_essay, question
from tests.fakes.grading import assignment, grade
from tests.fakes.submissions import Submissions

TRACES = ("20260123", "李雷", "李磊", "lilei@example.edu", "secret_of_lilei", "20260123_square.py")
OTHERS = ("20260124", "韩梅梅", "hers_alone")


class Class:
    """A course in which one student did everything that can be done."""

    def __init__(self, database: Database) -> None:
        self.database, self.clock = database, FakeClock()
        self.courses = Courses(database, self.clock)
        self.life = CourseLife(database, self.clock)
        self.submissions = Submissions(database, self.clock)
        self.queue = Queue(database, self.clock, Retries())
        self.signed = Signature(self.clock(), "ros", "wang")
        self.courses.create("ros", "ROS 2", "UTC", "me")
        entries = [
            RosterEntry(id="wang", name="王", role=Role.INSTRUCTOR),
            RosterEntry(id="20260123", name="李磊", email="lilei@example.edu", sections=("1",)),
            RosterEntry(id="20260124", name="韩梅梅"),
        ]
        self.courses.import_roster("ros", entries, "wang")
        self.courses.import_roster("ros", [RosterEntry(id="20260123", name="李雷")], "wang")  # a typing error

    def hand_in(self, student: str, source: bytes, essay: bool = False) -> str:
        self.clock.advance(1)
        new = NewSubmission(
            course="ros",
            student=student,
            assignment="essay" if essay else "square",
            file_name=f"{student}_square.py",
            source=source,
            key=f"k{self.clock():%M%S}",
            by="wang",
        )
        return self.submissions.add(new).id

    def work(self) -> None:
        """Grade all that waits."""
        while (claim := self.queue.claim("w")) is not None:
            essay = claim.assignment == "essay"
            job = GradingJob(
                file_name=claim.file_name,
                source=claim.source,
                assignment=question() if essay else assignment(),
            )
            self.queue.finish(claim, (grade_essay if essay else grade)(job), job.assignment)


@pytest.fixture
def taught(database: Database) -> Class:
    made = Class(database)
    Tokens(database, made.clock).issue("ros", "20260123", timedelta(days=1), "wang")
    StoredRules(database).extend(
        "square", "20260123", Extension(extra_attempts=1), made.signed, "李雷 is ill, see lilei@example.edu"
    )
    first = made.hand_in("20260123", b"raise good # secret_of_lilei 20260123")
    made.hand_in("20260123", ANSWER + "李雷 secret_of_lilei".encode(), essay=True)
    other = made.hand_in("20260124", b"good # hers_alone")
    made.work()
    essay = made.submissions.of_student("20260123", "essay", course="ros")[0].id
    Judgements(database).judge_all(
        essay, [(Given(item="timer", points=0.1, comment="well, 李雷"), None)], made.signed
    )
    comments = Comments(database)
    comments.add(first, "I am 李雷", 1, Signature(made.clock(), "ros", "20260123"), by_student=True)
    comments.add(first, "secret_of_lilei: why?", 1, made.signed, by_student=False)
    comments.add(other, "as 李雷 (20260123) does", None, made.signed, by_student=False)
    Regrades(database).open(Wanted(assignment="square", students=("20260123",)), made.signed)
    made.work()
    made.hand_in("20260123", b"good # secret_of_lilei waits")
    return made


def dump(database: Database) -> str:
    """Return every value of every table as text, and on SQLite what its files hold besides."""
    parts = []
    with database.reading() as session:
        for table in SQLModel.metadata.sorted_tables:
            for row in session.execute(select(table)):
                parts += [_text(value) for value in row]
    if database.is_sqlite:
        for path in (Path(database.name), Path(f"{database.name}-wal")):
            raw = path.read_bytes() if path.exists() else b""
            streams = [raw[one.start() :] for one in re.finditer(b"\x1f\x8b\x08", raw)]
            parts += [raw.decode(errors="ignore"), *(_text(one) for one in streams)]
    return "\n".join(parts)


def _text(value: object) -> str:
    if not isinstance(value, bytes):
        return str(value)
    try:
        return gzip.decompress(value).decode(errors="ignore")
    except (OSError, EOFError):
        return value.decode(errors="ignore")


def test_nothing_is_left_of_somebody_who_is_forgotten(taught: Class, database: Database) -> None:
    held = dump(database)
    assert all(one in held for one in (*TRACES, *OTHERS))
    found = taught.life.forget("20260123", taught.signed, "asked for by 李雷")
    assert found.submissions == 3
    held = dump(database)
    assert [one for one in TRACES if one in held] == []
    assert all(one in held for one in OTHERS)
    entries = AuditLog(database).entries("ros", 100)
    told = entries[0]
    assert (told.actor, told.action, told.subject) == ("wang", "member.forget", f"member {found.pseudonym}")
    assert told.reason == f"asked for by {found.pseudonym}"
    assert f"assignment square, member {found.pseudonym}" in {one.subject for one in entries}
    assert taught.submissions.of_student("20260124", course="ros")[0].score is not None


def test_somebody_forgotten_hands_in_nothing_more(taught: Class, database: Database) -> None:
    claim = taught.queue.claim("w")  # of the upload that waits
    assert claim is not None
    taught.life.forget("20260123", taught.signed)
    result = grade(GradingJob(file_name="a.py", source=claim.source, assignment=assignment()))
    assert not taught.queue.finish(claim, result, assignment())
    with pytest.raises(RefusedError, match="unknown_student"):
        taught.hand_in("20260123", b"good # again")
    assert [one for one in TRACES if one in dump(database)] == []


def test_another_id_takes_everything_along(taught: Class, database: Database) -> None:
    before = [(one.id, one.score) for one in taught.submissions.of_student("20260123", course="ros")]
    taught.life.renumber("20260123", "20269999", taught.signed, "moved to another school")
    after = [(one.id, one.score) for one in taught.submissions.of_student("20269999", course="ros")]
    assert after == before
    assert len(before) == 3
    assert taught.submissions.of_student("20260123", course="ros") == ()
    member = taught.courses.member("ros", "20269999")
    assert member is not None
    assert (member.name, member.sections, taught.courses.member("ros", "20260123")) == ("李雷", ("1",), None)
    rules = StoredRules(database).of("ros")
    assert {student for _, student in rules.extensions} == {"20269999"}
    (regrade,) = Regrades(database).all("ros")
    assert regrade.wanted.students == ("20269999",)
    entry = AuditLog(database).entries("ros", 1)[0]
    assert (entry.action, entry.before, entry.after) == (
        "member.renumber",
        {"id": "20260123"},
        {"id": "20269999"},
    )
    taught.work()
    taught.life.forget("20269999", taught.signed)
    assert [one for one in (*TRACES, "20269999") if one in dump(database)] == []


@pytest.mark.parametrize("new", ["20260124", "20260123", "020260124", "", "a b"])
def test_an_id_that_is_taken_or_none_is_refused(taught: Class, new: str) -> None:
    with pytest.raises(CourseError):
        taught.life.renumber("20260123", new, taught.signed)
    with pytest.raises(CourseError, match="no member"):
        taught.life.renumber("wang", "w2", taught.signed)


def test_a_new_column_of_text_is_searched_until_it_is_said_to_name_nobody() -> None:
    columns = (Column("trouble", PlainText()), Column("note", PlainText()), Column("noted_by", String(64)))
    ids, texts = naming_columns(Table("submission", MetaData(), *columns))
    assert ([one.name for one in ids], [one.name for one in texts]) == (["noted_by"], ["note"])
    known = {str(column) for table in SQLModel.metadata.sorted_tables for column in table.c}
    assert known >= NAMES_NOBODY


def test_who_was_removed_before_is_forgotten_too(taught: Class, database: Database) -> None:
    taught.courses.remove("ros", ["20260123"], "wang", "left")
    assert "李雷" in dump(database)
    taught.life.forget("20260123", taught.signed)
    assert [one for one in TRACES if one in dump(database)] == []


def test_only_students_who_were_there_are_forgotten(taught: Class) -> None:
    for person, reason in (("wang", "no student"), ("nobody", "no member")):
        with pytest.raises(CourseError, match=reason):
            taught.life.forget(person, taught.signed)


def test_what_is_old_is_erased_after_a_dry_run(taught: Class, database: Database) -> None:
    taught.work()
    taught.clock.advance(400 * 86_400)
    new = taught.hand_in("20260124", b"good # hers_alone, later")
    whole = taught.life.space("ros")["ros"]
    would = taught.life.old_work("ros", 400)["ros"]
    assert (would.submissions, would.sources_bytes > 0, would.reports_bytes > 0) == (4, True, True)
    assert taught.life.space("ros")["ros"] == whole
    assert taught.life.erase_old_work(None, 400, "cron") == {"ros": would}
    left = taught.life.space("ros")["ros"]
    assert left == Space(submissions=1, sources_bytes=len(b"good # hers_alone, later"))
    assert taught.submissions.get(new) is not None
    assert "secret_of_lilei" not in dump(database)
    entry = AuditLog(database).entries("ros", 1)[0]
    assert (entry.action, entry.after) == ("course.retain", {"submissions": 4, "older_than_days": 400})
    assert taught.life.erase_old_work(None, 400, "cron") == {}


def test_a_source_that_another_student_handed_in_stays(taught: Class, database: Database) -> None:
    taught.hand_in("20260123", b"good # the same")
    same = taught.hand_in("20260124", b"good # the same")
    taught.life.forget("20260123", taught.signed)
    assert taught.submissions.source(same) == b"good # the same"


def test_a_regrade_names_nobody_who_was_forgotten(taught: Class, database: Database) -> None:
    """Not from memory either; and a name that is a word of the grader's own spoils nothing."""
    regrades = Regrades(database)
    taught.courses.import_roster("ros", [RosterEntry(id="20260123", name="All")], "wang")
    (open_one,) = regrades.all("ros")
    taught.work()
    regrades.discard(open_one.id, taught.signed, "李雷 asked all of it")
    assert "20260123" in repr(regrades.all("ros"))
    pseudonym = taught.life.forget("20260123", taught.signed).pseudonym
    (shown,) = regrades.all("ros")
    assert shown.wanted == Wanted(assignment="square", which="all", students=(pseudonym,))
    assert shown.reason == f"{pseudonym} asked {pseudonym} of it"


def test_the_class_is_counted_anew_when_as_much_is_erased_as_came(taught: Class, database: Database) -> None:
    taught.work()
    board = Dashboard(database, taught.clock)
    before = {one.student: one for one in board.state("ros").progress}["20260124"]
    taught.clock.advance(401 * 86_400)
    taught.life.erase_old_work("ros", 400, "cron")
    later = taught.hand_in("20260124", b"good good # later")
    taught.work()
    (after,) = board.state("ros").progress
    assert (before.best_score, after.best_score, after.best_submission) == (5.0, 10.0, later)


def test_what_is_erased_is_in_the_log_even_if_not_all_was(
    taught: Class, database: Database, monkeypatch: pytest.MonkeyPatch
) -> None:
    taught.work()
    taught.clock.advance(400 * 86_400)
    monkeypatch.setattr("grader.store.course_life.erase", lambda *_: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        taught.life.erase_old_work("ros", 400, "cron")
    assert AuditLog(database).entries("ros", 1)[0].action == "course.retain"
