"""Putting a backup back: what is on disk at every moment at which the power may fail."""

import os
import shutil
import sqlite3
from collections.abc import Callable
from pathlib import Path

import pytest

from grader.contracts.errors import SettingsError
from grader.contracts.submission import NewSubmission
from grader.store.backups import copy_file, restore_file
from grader.store.database import Database
from tests.fakes.clock import FakeClock
from tests.fakes.submissions import Submissions


def add(database: Database, student: str) -> None:
    new = NewSubmission(student=student, assignment="square", file_name="a.py", source=b"x")
    Submissions(database, FakeClock()).add(new)


def students(file: Path) -> set[str]:
    connection = sqlite3.connect(file)
    assert connection.execute("PRAGMA integrity_check").fetchone() == ("ok",)
    found = {row[0] for row in connection.execute("SELECT student FROM submission")}
    connection.close()
    return found


@pytest.fixture
def crashed(sqlite_database: Database, tmp_path: Path) -> Path:
    """The folder of a service that was killed: a backup of one upload, and a second in the log only."""
    add(sqlite_database, "first")
    copy_file(tmp_path / "grader.db", tmp_path / "backup.db")
    add(sqlite_database, "second")
    folder = tmp_path / "crashed"
    folder.mkdir()
    for file in tmp_path.glob("*.db*"):
        shutil.copy(file, folder)
    (folder / "grader.db-shm").unlink()
    assert (folder / "grader.db-wal").stat().st_size
    return folder


class Moments:
    """Copies a folder before and after each step that changes or secures files; has the steps' names, too."""

    def __init__(self, folder: Path, copies: Path, patch: pytest.MonkeyPatch) -> None:
        self.copies: list[Path] = []
        self.steps: list[str] = []
        self._folder, self._into = folder, copies
        for name in ("replace", "unlink", "rename", "fsync"):
            patch.setattr(os, name, self._watched(name, getattr(os, name)))

    def _watched(self, name: str, real: Callable[..., None]) -> Callable[..., None]:
        def act(*arguments: object, **options: object) -> None:
            self._copy()
            real(*arguments, **options)
            self._copy()
            files = [self._name(one) for one in arguments]
            self.steps.append(" ".join([name, *files]))

        return act

    def _copy(self) -> None:
        copy = self._into / str(len(self.copies))
        shutil.copytree(self._folder, copy)
        self.copies.append(copy)

    @staticmethod
    def _name(argument: object) -> str:
        path = os.readlink(f"/proc/self/fd/{argument}") if isinstance(argument, int) else str(argument)
        return Path(path).name


def test_whenever_the_power_fails_the_database_is_whole(
    crashed: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with monkeypatch.context() as patch:
        moments = Moments(crashed, tmp_path / "moments", patch)
        restore_file(crashed / "backup.db", crashed / "grader.db")
    found = [students(copy / "grader.db") for copy in moments.copies]
    changed = found.index({"first"})
    assert changed > 4
    assert found == [{"first", "second"}] * changed + [{"first"}] * (len(found) - changed)
    assert students(crashed / "grader.db.before-restore") == {"first", "second"}
    step = moments.steps.index("replace grader.db.new grader.db")
    assert moments.steps[step - 1 : step + 2 : 2] == ["fsync grader.db.new", "fsync crashed"]
    assert {file.name for file in crashed.iterdir()} == {"backup.db", "grader.db", "grader.db.before-restore"}


def test_a_log_without_its_database_does_not_become_the_backups(crashed: Path) -> None:
    (crashed / "grader.db").unlink()
    assert restore_file(crashed / "backup.db", crashed / "grader.db") is None
    assert students(crashed / "grader.db") == {"first"}


def test_the_log_of_a_restore_that_was_killed_does_not_spoil_the_next(crashed: Path) -> None:
    shutil.copy(crashed / "grader.db-wal", crashed / "grader.db.new-wal")
    restore_file(crashed / "backup.db", crashed / "grader.db")
    assert students(crashed / "grader.db") == {"first"}


def test_a_database_that_somebody_else_has_open_stays(crashed: Path) -> None:
    other = sqlite3.connect(crashed / "grader.db")
    other.execute("SELECT count(*) FROM submission").fetchone()
    with pytest.raises(SettingsError, match="locked"):
        restore_file(crashed / "backup.db", crashed / "grader.db")
    other.close()
    assert students(crashed / "grader.db") == {"first", "second"}
