"""Moving everything to another database and back, and backups of either kind."""

import shutil
import sqlite3
from collections.abc import Iterator
from contextlib import closing
from dataclasses import asdict
from datetime import timedelta
from pathlib import Path

import pytest
from sqlalchemy import text
from sqlmodel import SQLModel

from grader.contracts.errors import InfrastructureError, SettingsError
from grader.contracts.grading import GradingJob
from grader.contracts.identity import RosterEntry
from grader.contracts.notice import Draft, MailWishes, NewWebhook, NoticeKind, Outlet, Vendor
from grader.contracts.platform import Picking, PlatformLink
from grader.contracts.regrade import Wanted
from grader.contracts.rules import Extension, Rules
from grader.contracts.submission import NewSubmission, WorkerState
from grader.store import transfer as module
from grader.store.appeals import Appeals, Asked
from grader.store.audit import Signature
from grader.store.backups import back_up, restore_rows
from grader.store.comments import Comments
from grader.store.courses import Courses
from grader.store.dashboard import Dashboard
from grader.store.database import Database
from grader.store.drafts import Drafts
from grader.store.identities import Identities
from grader.store.judgements import Given, Judgements
from grader.store.notices import Notices
from grader.store.own_assignments import NewOwnAssignment, OwnAssignments
from grader.store.phrases import Phrases
from grader.store.pinned import Pinned
from grader.store.platform_scores import PlatformScores
from grader.store.platforms import Platforms
from grader.store.queue import Queue, Retries
from grader.store.receipts import Receipts
from grader.store.refused import RefusedUploads
from grader.store.regrades import Regrades
from grader.store.rules import StoredRules
from grader.store.schema import migrate
from grader.store.teams import Teams
from grader.store.tokens import Tokens
from grader.store.transfer import contents, transfer
from grader.store.workers import Workers
from tests.fakes.clock import FakeClock
from tests.fakes.essays import ANSWER, grade_essay, question
from tests.fakes.grading import assignment, grade
from tests.fakes.platforms import new_platform
from tests.fakes.submissions import Submissions


def fill(database: Database) -> str:
    """Put rows into every table; return a token."""
    clock = FakeClock()
    courses, submissions = Courses(database, clock), Submissions(database, clock)
    queue, signed = Queue(database, clock, Retries()), Signature(clock(), "ros", "wang")
    courses.create("ros", "ROS 2 入门", "Asia/Shanghai", "me", "jazzy")
    courses.import_roster("ros", [RosterEntry(id="li", name="李雷", sections=("1",))], "me")
    _, token = Tokens(database, clock).issue("ros", "li", timedelta(days=1), "me")
    identities = Identities(database, clock)
    assert identities.bind("campus", "l1", "ros", "li", by_token=True)
    identities.hold("campus", "somebody")
    platforms = Platforms(database, clock)
    used = platforms.add(new_platform(), signed)
    line = {"resource": "1", "title": "方", "assignment": "square", "line_item": ""}
    opened = platforms.open_link(PlatformLink(platform=used.id, used_at=clock(), **line))
    assert identities.bind(used.provider, "l1", "ros", "li", by_token=True)
    assert PlatformScores(database, clock).claim(opened, "ros", "li", "a" * 64)
    assert platforms.use("message", clock())
    platforms.invite(signed)
    picking = Picking(back="https://a.example", data="数据", several=True, scored=False)
    platforms.open_picking(used.id, "l1", picking)
    notices = Notices(database, clock)
    notices.set_webhook(NewWebhook(outlet=Outlet.CLASS, vendor=Vendor.WECOM, address="https://a"), signed)
    notices.set_wishes(MailWishes(graded=True), signed)
    draft = Draft(
        outlet=Outlet.MAIL,
        kind=NoticeKind.GRADED,
        person="li",
        heading="好",
        body="好",
        until=clock() + timedelta(days=1),
        told={"graded/square": "x"},
    )
    assert notices.add("ros", [draft]) == 1
    platforms.keys(lambda: ("k", "{}"))
    rules = StoredRules(database)
    rules.set("square", Rules(attempts=9), signed)
    rules.extend("square", "li", Extension(extra_attempts=1), signed)
    for number in range(3):
        clock.advance(1.000001)
        new = NewSubmission(
            course="ros",
            student="li",
            assignment="square",
            file_name="方.py",
            source=b"raise good # %d\n" % number,
            key=f"k{number}",
        )
        submissions.add(new)
        claim = queue.claim("w")
        job = GradingJob(file_name="方.py", source=claim.source, assignment=assignment())
        queue.finish(claim, grade(job), assignment())
    regrades = Regrades(database)
    applied = regrades.open(Wanted(assignment="square"), signed)
    while (claim := queue.claim("w")) is not None:
        job = GradingJob(file_name="方.py", source=b"good good", assignment=assignment())
        queue.finish(claim, grade(job), assignment())
    regrades.apply(applied.id, signed, "好")
    regrades.open(Wanted(assignment="square", which="latest"), signed)
    clock.advance(1)
    essay = NewSubmission(
        course="ros", student="li", assignment="essay", file_name="a.txt", source=ANSWER, key="e"
    )
    submissions.add(essay)
    claim = queue.claim("w")
    essay_job = GradingJob(file_name="a.txt", source=ANSWER, assignment=question())
    queue.finish(claim, grade_essay(essay_job), question())
    Judgements(database).judge_all(
        claim.submission_id, [(Given(item="timer", points=0.1, comment="好"), None)], signed
    )
    Phrases(database).set({"q": "?"}, signed)
    Pinned(database).pin("square", "no_commands", "?", signed)
    Receipts(database).key_to_sign()
    Teams(database).set(signed, "square", [["li"]])
    Drafts(database).keep(Signature(clock(), "ros", "li"), "square", "import rclpy\n")
    RefusedUploads(database, clock).add("ros", "li", "square", "empty", "a.py", None)
    Comments(database).add(claim.submission_id, "好", 1, signed, by_student=False)
    asked = Asked(item="timer", reason="为什么？", attempt=1, earned=0.1, points=45.0)
    Appeals(database).ask(claim.submission_id, asked, signed)
    new = NewOwnAssignment(assignment="walk", version=1, content=b"PK\0", reading=b"{}")
    OwnAssignments(database, clock).add(new, signed)
    now = clock()
    state = {"id": "h:1", "slots": 2, "busy": 0, "sandbox_ready": True, "isolation": "strict", "detail": ""}
    Workers(database, clock).report(WorkerState(**state, started_at=now, seen_at=now))
    return token


@pytest.fixture(scope="module")
def filled_file(migrated_file: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A file to copy: filling one anew for each test would take most of the time."""
    path = Path(shutil.copy(migrated_file, tmp_path_factory.mktemp("filled") / "grader.db"))
    with closing(Database(f"sqlite:///{path}")) as database:
        fill(database)
    return path


@pytest.fixture
def full(filled_file: Path, tmp_path: Path) -> Iterator[Database]:
    with closing(Database(f"sqlite:///{shutil.copy(filled_file, tmp_path / 'grader.db')}")) as opened:
        yield opened


@pytest.fixture
def other(migrated_file: Path, tmp_path: Path) -> Iterator[Database]:
    with closing(Database(f"sqlite:///{shutil.copy(migrated_file, tmp_path / 'other.db')}")) as opened:
        yield opened


def held(database: Database) -> object:
    with database.reading() as session:
        return contents(session)


def test_the_sample_has_rows_in_every_table(full: Database) -> None:
    assert [one.table for one in held(full) if not one.rows] == []
    assert {one.table for one in held(full)} == set(SQLModel.metadata.tables)


def test_there_and_back_nothing_changes(full: Database, postgres_database: Database, other: Database) -> None:
    before = held(full)
    assert transfer(full, postgres_database) == before
    assert held(postgres_database) == before
    there, here = (Dashboard(one, FakeClock()).state("ros") for one in (postgres_database, full))
    assert asdict(there) == asdict(here)
    transfer(postgres_database, other)
    assert held(other) == before == held(full)


def test_after_a_move_the_service_goes_on(full: Database, postgres_database: Database) -> None:
    clock = FakeClock()
    clock.advance(60)
    transfer(full, postgres_database)
    Courses(postgres_database, clock).create("new", "new", "UTC", "me")  # the audit log counts on
    claim = Queue(postgres_database, clock, Retries()).claim("w")
    assert claim is not None
    assert claim.source.startswith(b"raise good")


def test_every_value_matters_to_the_digest(full: Database, other: Database) -> None:
    transfer(full, other)
    before = held(other)
    for change in (
        "UPDATE grading SET score = score + 1e-15 WHERE score IS NOT NULL",
        "UPDATE submission SET trouble = 'x'",
        "UPDATE member SET name = '李蕾'",
        "UPDATE submission SET received_at = '2026-03-02 08:00:00.000001'",
        "UPDATE token SET revoked_at = expires_at",
        "UPDATE source SET content = x'00'",
        "UPDATE worker SET sandbox_ready = 0",
        "DELETE FROM upload_key",
    ):
        with pytest.raises(ZeroDivisionError), other.writing() as session:  # noqa: PT012
            session.execute(text(change))
            assert contents(session) != before, change
            raise ZeroDivisionError


@pytest.mark.usefixtures("compiled_anew")
def test_what_arrived_otherwise_is_not_kept(
    full: Database, postgres_database: Database, monkeypatch: pytest.MonkeyPatch
) -> None:
    with postgres_database.writing() as session:  # a server that rounds
        session.execute(text("ALTER TABLE grading ALTER COLUMN max_score TYPE integer"))
        session.execute(text("ALTER TABLE graded_item ALTER COLUMN earned TYPE numeric(3, 1)"))
        session.execute(text("ALTER TABLE judgement ALTER COLUMN points TYPE integer"))
    empty = held(postgres_database)
    with pytest.raises(InfrastructureError, match="not the same"):
        transfer(full, postgres_database)
    assert held(postgres_database) == empty


def test_a_database_in_use_is_not_filled(full: Database, postgres_database: Database) -> None:
    Courses(postgres_database, FakeClock()).create("mine", "mine", "UTC", "me")
    before = held(postgres_database)
    with pytest.raises(SettingsError, match="not empty"):
        transfer(full, postgres_database)
    assert held(postgres_database) == before
    assert transfer(full, postgres_database, replace=True) == held(full) == held(postgres_database)


def test_another_schema_is_not_copied(full: Database, blank_url: str) -> None:
    blank = Database(blank_url)
    with pytest.raises(SettingsError, match="no tables of the grader"):
        transfer(full, blank)
    with pytest.raises(SettingsError, match="no tables of the grader"):
        transfer(blank, full)
    migrate(blank)
    with blank.writing() as session:
        session.execute(text("UPDATE alembic_version SET version_num = '9999'"))
    with pytest.raises(SettingsError, match=r"9999.*grader db migrate"):
        transfer(blank, full)
    blank.close()


def test_a_row_that_does_not_fit_is_named(full: Database, postgres_database: Database) -> None:
    with full.writing() as session:  # SQLite minds no lengths
        session.execute(text("UPDATE submission SET file_name = :long"), {"long": "x" * 256})
    with pytest.raises(SettingsError, match="submission does not fit"):
        transfer(full, postgres_database)


def test_only_some_rows_are_in_memory_at_once(
    full: Database, other: Database, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "_ROWS_AT_ONCE", 1)
    assert transfer(full, other) == held(full)


def test_a_backup_of_postgresql_is_a_file_that_sqlite_opens(
    full: Database, postgres_database: Database, tmp_path: Path
) -> None:
    transfer(full, postgres_database)
    back_up(postgres_database, tmp_path / "backup.db")
    assert (tmp_path / "backup.db").stat().st_mode & 0o077 == 0
    connection = sqlite3.connect(tmp_path / "backup.db")
    assert connection.execute("PRAGMA journal_mode").fetchone() == ("delete",)
    assert connection.execute("SELECT count(*) FROM submission").fetchone() == (5,)
    connection.close()
    with pytest.raises(SettingsError, match="not empty"):
        restore_rows(tmp_path / "backup.db", postgres_database, replace=False)
    before = held(postgres_database)
    with postgres_database.writing() as session:
        session.execute(text("UPDATE submission SET trouble = 'lost'"))
    assert restore_rows(tmp_path / "backup.db", postgres_database, replace=True) == 5
    assert held(postgres_database) == before
    assert not list(tmp_path.glob("*.part"))
