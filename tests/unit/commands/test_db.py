"""`grader db`: backups of a database in use, and putting them back."""

import sqlite3
import threading
from pathlib import Path

import pytest

from grader import cli
from grader.contracts.submission import NewSubmission
from grader.store.columns import utc_now
from grader.store.database import Database
from grader.store.schema import migrate
from grader.store.submissions import Submissions
from grader.store.workers import presence


@pytest.fixture
def database(tmp_path: Path):
    opened = Database(f"sqlite:///{tmp_path / 'grader.db'}")
    migrate(opened)
    yield opened
    opened.close()


@pytest.fixture
def db(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    def run(action: str, file: Path, status: int = 0) -> str:
        assert cli.run(["db", action, str(file), "--data", str(tmp_path)]) == status
        return capsys.readouterr().err

    return run


def add(database: Database, student: str) -> str:
    new = NewSubmission(student=student, assignment="square", file_name="a.py", source=student.encode())
    return Submissions(database, utc_now).add(new).id


def count(path: Path) -> int:
    connection = sqlite3.connect(path)
    (number,) = connection.execute("SELECT count(*) FROM submission").fetchone()
    connection.close()
    return number


def test_a_backup_of_a_database_in_use_is_whole(database: Database, db, tmp_path: Path) -> None:
    for number in range(5):
        add(database, f"s{number}")
    stop = threading.Event()

    def go_on() -> None:
        number = 0
        while not stop.is_set():
            number += 1
            add(database, f"t{number}")

    thread = threading.Thread(target=go_on)
    thread.start()
    db("backup", tmp_path / "backup.db")
    stop.set()
    thread.join()
    assert count(tmp_path / "backup.db") >= 5
    assert not list(tmp_path.glob("backup.db-*"))
    assert not list(tmp_path.glob("*.part"))
    assert (tmp_path / "backup.db").stat().st_mode & 0o077 == 0


def test_a_restored_database_is_as_it_was(database: Database, db, tmp_path: Path) -> None:
    first = add(database, "a")
    db("backup", tmp_path / "backup.db")
    add(database, "b")
    database.close()
    db("restore", tmp_path / "backup.db")
    again = Database(f"sqlite:///{tmp_path / 'grader.db'}")
    assert Submissions(again, utc_now).source(first) == b"a"
    again.close()
    assert count(tmp_path / "grader.db") == 1
    assert count(tmp_path / "grader.db.before-restore") == 2


def test_under_a_running_service_nothing_is_restored(database: Database, db, tmp_path: Path) -> None:
    add(database, "a")
    db("backup", tmp_path / "backup.db")
    with presence(f"sqlite:///{tmp_path / 'grader.db'}", lambda: None):
        assert "stop it first" in db("restore", tmp_path / "backup.db", status=2)
    assert count(tmp_path / "grader.db") == 1


def test_what_is_no_backup_changes_nothing(database: Database, db, tmp_path: Path) -> None:
    add(database, "a")
    (tmp_path / "text").write_text("hello" * 500)
    empty = sqlite3.connect(tmp_path / "empty")
    empty.execute("CREATE TABLE x (y)")
    empty.close()
    for name, why in (
        ("text", "not a database"),
        ("empty", "no database of the grader"),
        ("none", "no such"),
    ):
        assert why in db("restore", tmp_path / name, status=2)
    assert count(tmp_path / "grader.db") == 1
    assert not (tmp_path / "none").exists()
