"""`grader db`: back the database up while the service runs, and put a backup back."""

import argparse
import fcntl
import os
import sqlite3
import sys
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path

from sqlalchemy import make_url

from grader.commands.storage import add_data_option, database_url
from grader.contracts.errors import SettingsError
from grader.settings import load
from grader.store.database import Database
from grader.store.schema import migrate

_PAGES = 256  # copied at a time, so that uploads go on in between
_PAUSE_S = 0.01


def configure(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments."""
    actions = parser.add_subparsers(dest="action", required=True, metavar="backup | restore")
    backup = actions.add_parser("backup", help="copy the database, also while the service runs")
    backup.add_argument("file", type=Path, help="where to; replaced when it exists")
    restore = actions.add_parser(
        "restore", help="put a backup in place of the database; stop the service first"
    )
    restore.add_argument("file", type=Path)
    for one in (backup, restore):
        add_data_option(one)


def run(arguments: argparse.Namespace) -> int:
    """Do it; 2, as a SettingsError, when a file is no database of the grader."""
    database = _path(arguments)
    if arguments.action == "backup":
        _copy(database, arguments.file)
        sys.stderr.write(f"{database} → {arguments.file}\n")
        return 0
    with _alone(database):
        _restore(arguments.file, database)
    return 0


def _path(arguments: argparse.Namespace) -> Path:
    return Path(make_url(database_url(arguments.data) or load().database_url).database or "")


def _copy(source: Path, target: Path) -> None:
    """Write a checked copy of `source`; `target` appears whole or not at all."""
    if not source.is_file():
        raise SettingsError(f"{source}: there is no such file")
    half = target.with_name(target.name + ".part")
    half.unlink(missing_ok=True)
    try:
        # URI: opening must not create an empty database; the copy holds people's work: only the owner reads it
        os.close(os.open(half, os.O_CREAT | os.O_WRONLY, 0o600))
        with (
            closing(sqlite3.connect(f"{source.resolve().as_uri()}?mode=rw", uri=True)) as origin,
            closing(sqlite3.connect(half)) as copy,
        ):
            origin.backup(copy, pages=_PAGES, sleep=_PAUSE_S)
            copy.execute("PRAGMA journal_mode=DELETE")  # one file, complete without a log beside it
            _check(copy, source)
        os.replace(half, target)
    except (sqlite3.Error, OSError) as error:
        raise SettingsError(f"{source} could not be copied to {target}: {error}") from error
    finally:
        half.unlink(missing_ok=True)


def _check(copy: sqlite3.Connection, source: Path) -> None:
    found = copy.execute("PRAGMA integrity_check").fetchone()
    if found != ("ok",):
        raise SettingsError(f"{source} is damaged: {found[0]}")
    tables = {row[0] for row in copy.execute("SELECT name FROM sqlite_master WHERE type = 'table'")}
    if not {"submission", "alembic_version"} <= tables:
        raise SettingsError(f"{source} is no database of the grader")


def _restore(backup: Path, database: Path) -> None:
    """Check the backup, bring a copy up to date, and only then let it take the database's place."""
    new = database.with_name(database.name + ".new")
    _copy(backup, new)
    try:
        opened = Database(f"sqlite:///{new.resolve()}")
        try:
            migrate(opened)
        finally:
            opened.close()
        if database.is_file():
            old = database.with_name(database.name + ".before-restore")
            _copy(database, old)  # with what its log holds
            sys.stderr.write(f"what was there: {old}\n")
        for log in ("-wal", "-shm"):
            Path(f"{database}{log}").unlink(missing_ok=True)
        os.replace(new, database)
    finally:
        for name in (new, Path(f"{new}-wal"), Path(f"{new}-shm")):
            name.unlink(missing_ok=True)
    sys.stderr.write(f"{backup} → {database}\n")


@contextmanager
def _alone(database: Path) -> Iterator[None]:
    """Hold the lock that workers share (`grader.store.workers.presence`), so that none begins meanwhile.

    Raises:
        SettingsError: a service works with the database.
    """
    descriptor = os.open(f"{database}.lock", os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o600)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        yield
    except BlockingIOError:
        raise SettingsError(f"a service works with {database}: stop it first") from None
    finally:
        os.close(descriptor)
