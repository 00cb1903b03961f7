"""`grader db`: backups of a database in use, and putting them back."""

import os
import re
import sqlite3
import tempfile
import threading
from pathlib import Path

import pytest

from grader.commands import cli
from grader.contracts.submission import NewSubmission
from grader.operation.settings import Settings
from grader.service import composition
from grader.store.clock import utc_now
from grader.store.database import Database
from grader.store.occupancy import in_use
from tests.conftest import on_sqlite
from tests.fakes.grading import FakePreflight
from tests.fakes.postgres import PostgresServer
from tests.fakes.submissions import Submissions
from tests.fakes.waiting import wait_until


@pytest.fixture
def database(database_url: str):
    opened = Database(database_url)
    yield opened
    opened.close()


@pytest.fixture
def db(database_url: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv("GRADER_DATABASE_URL", database_url)

    def run(action: str, *arguments: str | Path, status: int = 0) -> str:
        assert cli.run(["db", action, *map(str, arguments), "--lang", "en"]) == status
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


@on_sqlite
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
    db("restore", tmp_path / "backup.db")
    assert count(tmp_path / "grader.db.before-restore") == 2
    assert count(tmp_path / "grader.db.before-restore.2") == 1


@on_sqlite
def test_a_database_is_its_owners_only_and_stays_whose_it_is(database: Database, db, tmp_path: Path) -> None:
    add(database, "a")
    files = [tmp_path / name for name in ("grader.db", "grader.db-wal", "backup.db")]
    db("backup", files[-1])
    assert [oct(one.stat().st_mode & 0o777) for one in files] == ["0o600"] * 3
    database.close()
    files[0].chmod(0o640)  # say, a group makes backups
    db("restore", files[-1])
    assert oct(files[0].stat().st_mode & 0o777) == "0o640"


@pytest.mark.parametrize("folder", [".", "kept"])
def test_a_backup_is_a_file(
    database: Database, db, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, folder: str
) -> None:
    add(database, "s1")
    place = tmp_path / "place"
    (place / "kept").mkdir(parents=True)
    monkeypatch.chdir(place)
    assert "is a folder: name a file in it" in db("backup", folder, status=2)
    assert list(place.rglob("*")) == [place / "kept"]


@on_sqlite
def test_a_backup_does_not_take_the_place_of_the_database(database: Database, db, tmp_path: Path) -> None:
    before = (tmp_path / "grader.db").stat().st_ino
    (tmp_path / "link.db").symlink_to("grader.db")
    for name in ("grader.db", "link.db"):
        assert "the very file" in db("backup", tmp_path / name, status=2)
    assert (tmp_path / "grader.db").stat().st_ino == before


@on_sqlite
def test_under_a_running_service_nothing_is_restored(database: Database, db, tmp_path: Path) -> None:
    add(database, "a")
    db("backup", tmp_path / "backup.db")
    with in_use(database):
        assert "stop it first" in db("restore", tmp_path / "backup.db", status=2)
    assert count(tmp_path / "grader.db") == 1


def test_what_is_no_backup_changes_nothing(database: Database, db, tmp_path: Path) -> None:
    kept = add(database, "a")
    (tmp_path / "text").write_text("hello" * 500)
    empty = sqlite3.connect(tmp_path / "empty")
    empty.execute("CREATE TABLE x (y)")
    empty.close()
    for name, why in (
        ("text", "not a database"),
        ("empty", "no database of the grader"),
        ("none", "no such"),
    ):
        assert why in db("restore", tmp_path / name, "--replace", status=2)
    assert Submissions(database, utc_now).source(kept) == b"a"
    assert not (tmp_path / "none").exists()


@on_sqlite
def test_a_service_that_leaves_grading_to_others_is_not_overlooked(
    database: Database, db, tmp_path: Path
) -> None:
    add(database, "a")
    db("backup", tmp_path / "backup.db")
    settings = Settings(database_url=f"sqlite:///{tmp_path / 'grader.db'}", slots=0)
    database.close()
    with composition.running(settings, FakePreflight()):
        assert "stop it first" in db("restore", tmp_path / "backup.db", status=2)
    db("restore", tmp_path / "backup.db")


def test_the_schema_is_brought_up_to_date(blank_url: str, monkeypatch, capsys) -> None:
    monkeypatch.setenv("GRADER_DATABASE_URL", blank_url)
    assert cli.run(["db", "migrate", "--lang", "en"]) == 0
    assert ", made" in capsys.readouterr().err
    assert cli.run(["db", "migrate", "--lang", "en"]) == 0
    assert "is up to date" in capsys.readouterr().err
    assert cli.run(["db", "migrate"]) == 0
    assert "已是最新" in capsys.readouterr().err


@on_sqlite
def test_an_installation_moves_to_postgresql(
    database: Database, postgres_url: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    id_ = add(database, "a")
    url = postgres_url.replace("postgres@", "postgres:3q9fKx72@")
    move = ["db", "move", "--data", str(tmp_path), "--lang", "en", "--to", url]
    with in_use(database):
        assert cli.run(move) == 2
    assert cli.run(move) == 0
    said = capsys.readouterr()
    assert re.search(r"^submission +1 rows  [0-9a-f]{16}  same$", said.out, re.MULTILINE)
    assert "3q9fKx72" not in said.out + said.err
    moved = Database(postgres_url)
    assert Submissions(moved, utc_now).get(id_) == Submissions(database, utc_now).get(id_)
    moved.close()
    assert cli.run(move) == 2
    assert "not empty" in capsys.readouterr().err


@on_sqlite
def test_a_move_from_or_to_a_wrong_place_is_refused_in_one_line(
    database: Database, postgres_server: PostgresServer, tmp_path: Path, capsys, monkeypatch
) -> None:
    blank, strange = (
        postgres_server.create(f"{name}_{os.getpid()}", empty=True) for name in ("blank", "strange")
    )
    ascii_only = postgres_server.create(f"ascii_{os.getpid()}", empty=True, encoding="SQL_ASCII")
    other = Database(strange)
    with other.writing() as session:
        session.connection().exec_driver_sql("CREATE TABLE submission (number int)")
    other.close()
    (tmp_path / "nothing").mkdir()
    file = f"sqlite:///{tmp_path / 'grader.db'}"
    for source, target, why in (
        (blank, f"sqlite:///{tmp_path / 'new.db'}", "holds no tables of the grader"),
        (f"sqlite:///{tmp_path / 'nothing/grader.db'}", blank, "there is no database"),
        (file, file, "the very database"),
        (file, strange, "cannot be brought up to date"),
        (file, blank.replace("/blank_", "/none_"), "does not exist"),
        (file, ascii_only, "encoded in SQL_ASCII"),
        (file, f"{blank}&sslmod=require", 'invalid connection option "sslmod"'),
    ):
        monkeypatch.setenv("GRADER_DATABASE_URL", source)
        assert cli.run(["db", "move", "--lang", "en", "--to", target]) == 2
        said = capsys.readouterr().err
        assert why in said
        assert said.count("\n") == 1
    assert not list((tmp_path / "nothing").iterdir())
    assert not (tmp_path / "new.db").exists()


def test_postgresql_is_backed_up_and_restored(
    postgres_url: str, monkeypatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("DATABASE_URL", postgres_url)
    database = Database(postgres_url)
    first = add(database, "a")
    backup = str(tmp_path / "backup.db")
    with pytest.MonkeyPatch.context() as full:
        full.setattr(tempfile, "tempdir", "/no/such/folder")
        assert cli.run(["db", "backup", "/no/such/folder/backup.db"]) == 2
        assert cli.run(["db", "backup", backup]) == 0
    assert list(tmp_path.iterdir()) == [tmp_path / "backup.db"]
    second = add(database, "b")
    assert cli.run(["db", "restore", backup, "--lang", "en"]) == 2
    assert "not empty" in capsys.readouterr().err
    settings = Settings(database_url=postgres_url, slots=0)
    with composition.running(settings, FakePreflight()):
        assert cli.run(["db", "restore", "--replace", backup, "--lang", "en"]) == 2
    assert "in use by grader serve" in capsys.readouterr().err
    # the server notices a little later that the service's connections ended
    wait_until(lambda: cli.run(["db", "restore", "--replace", backup]) == 0)
    assert Submissions(database, utc_now).source(first) == b"a"
    assert Submissions(database, utc_now).get(second) is None
    database.close()


@pytest.mark.parametrize("action", [["backup", "b.db"], ["move", "--to", "sqlite:///other.db"]])
def test_what_only_reads_makes_no_database(
    action: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert cli.run(["db", *action, "--data", "dta"]) == 2
    assert "没有这个数据库" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("name", ["a?b", "e%20f", "g#h", "方 形", "q'r"])
def test_a_folder_may_have_any_name(tmp_path: Path, monkeypatch, name: str) -> None:
    monkeypatch.chdir(tmp_path)
    assert cli.run(["db", "migrate", "--data", name]) == 0
    assert cli.run(["db", "backup", f"{name}.db", "--data", name]) == 0
    assert cli.run(["db", "restore", f"{name}.db", "--data", name]) == 0
    assert (count(tmp_path / name / "grader.db"), count(tmp_path / f"{name}.db")) == (0, 0)
    assert {path.name for path in tmp_path.iterdir()} == {name, f"{name}.db"}


def test_migrate_makes_the_database(tmp_path: Path) -> None:
    assert cli.run(["db", "migrate", "--data", str(tmp_path / "new")]) == 0
    assert (tmp_path / "new" / "grader.db").is_file()
