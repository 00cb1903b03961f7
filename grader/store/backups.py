"""Backups, which are SQLite files, and putting them back.

A SQLite database is copied page by page, a PostgreSQL database row by row from one snapshot; the service may run
meanwhile. To put a backup back, stop the service first.
"""

import itertools
import os
import sqlite3
import stat
import tempfile
from collections.abc import Iterator
from contextlib import closing, contextmanager, suppress
from pathlib import Path

from grader.contracts.errors import SettingsError
from grader.store.database import Database, sqlite_address
from grader.store.schema import migrate
from grader.store.transfer import transfer

_PAGES = 256  # copied at a time, so that uploads go on in between
_PAUSE_S = 0.01
_PRIVATE = 0o600  # people's work: only the owner reads it


def back_up(database: Database, file: Path) -> None:
    """Write a checked copy of `database`; `file` appears whole or not at all.

    Raises:
        SettingsError: it is no database of the grader, or the file cannot be written.
        InfrastructureError: the database does not answer.
    """
    if database.is_sqlite:
        copy_file(Path(database.name), file)
        return
    with _folder_beside(file) as folder:
        with closing(Database(sqlite_address(folder / "rows.db"))) as rows:
            migrate(rows)
            transfer(database, rows)
        copy_file(folder / "rows.db", file)


def restore_file(backup: Path, database: Path) -> Path | None:
    """Check a backup, bring a copy up to date, and only then let it take the place of the file `database`.

    At whatever moment this is killed, `database` is whole: either as it was, with what its log held, or as the
    backup. So both files are complete without a log, and on disk, before one takes the place of the other.

    Returns:
        The file that keeps the old database, or None if there was none.

    Raises:
        SettingsError: the file is not a backup, or something cannot be written.
    """
    new = database.with_name(database.name + ".new")
    try:
        _forget_log(new)  # of an earlier restore that was killed
        copy_file(backup, new)
        with closing(Database(sqlite_address(new))) as opened:
            migrate(opened)
        _settle(new)
        old = None
        if database.is_file():
            old = _free_name(database.with_name(database.name + ".before-restore"))
            copy_file(database, old)  # with what its log holds
            _settle(database)
            _pass_on_access(database, new)
        else:
            _forget_log(database)  # of a database that is gone
        _put(new, database)
    except (sqlite3.Error, OSError) as error:
        raise SettingsError(
            f"{backup} could not be put in place of {database}: {error}",
            f"无法用 {backup} 替换 {database}：{error}",
        ) from error
    finally:
        new.unlink(missing_ok=True)
        _forget_log(new)
    return old


def _free_name(file: Path) -> Path:
    """Return `file`, with a number behind its name if there is one: what an earlier restore kept stays."""
    numbered = (file.with_name(f"{file.name}.{number}") for number in itertools.count(2))
    return file if not file.exists() else next(backup for backup in numbered if not backup.exists())


def restore_rows(backup: Path, database: Database, *, replace: bool) -> int:
    """Put a backup into a database on a server, in one transaction; return how many submissions it has.

    Raises:
        SettingsError: the file is not a backup, or the database is not empty and `replace` is false.
        InfrastructureError: the database does not answer.
    """
    with tempfile.TemporaryDirectory(prefix="grader-restore-") as folder:
        copy_file(backup, Path(folder) / "rows.db")
        with closing(Database(sqlite_address(Path(folder) / "rows.db"))) as rows:
            migrate(rows)
            migrate(database)
            copied = transfer(rows, database, replace=replace)
    return next(table.rows for table in copied if table.table == "submission")


def copy_file(source: Path, target: Path) -> None:
    """Write a checked copy of a SQLite database that may be in use; `target` appears whole or not at all.

    Raises SettingsError: `source` is no database of the grader, or `target` cannot be written.
    """
    if not source.is_file():
        raise SettingsError(f"{source}: there is no such file", f"{source}：没有这个文件")
    if target.is_dir():
        raise SettingsError(
            f"{target} is a folder: name a file in it", f"{target} 是文件夹：请写出里面的文件名"
        )
    if target.exists() and target.samefile(source):  # its users would go on with a file without a name
        raise SettingsError(
            f"{target} is the very file that is to be copied", f"{target} 就是要复制的那个文件"
        )
    half = target.with_name(target.name + ".part")
    try:
        half.unlink(missing_ok=True)
        _forget_log(half)
        os.close(os.open(half, os.O_CREAT | os.O_WRONLY, _PRIVATE))
        with (
            # URI: opening must not create an empty database
            closing(sqlite3.connect(f"{source.resolve().as_uri()}?mode=rw", uri=True)) as origin,
            closing(sqlite3.connect(half)) as copy,
        ):
            origin.backup(copy, pages=_PAGES, sleep=_PAUSE_S)
            copy.execute("PRAGMA journal_mode=DELETE")  # one file, complete without a log beside it
            _check(copy, source)
        _put(half, target)
    except (sqlite3.Error, OSError) as error:
        raise SettingsError(
            f"{source} could not be copied to {target}: {error}", f"无法把 {source} 复制到 {target}：{error}"
        ) from error
    finally:
        half.unlink(missing_ok=True)


@contextmanager
def _folder_beside(file: Path) -> Iterator[Path]:
    """Make a folder where there is room for as much as `file`; in a container there is little in /tmp."""
    try:
        temporary = tempfile.TemporaryDirectory(prefix=".grader-backup-", dir=file.parent)
    except OSError as error:
        raise SettingsError(
            f"{file} cannot be written: {error.strerror}", f"无法写入 {file}：{error.strerror}"
        ) from error
    with temporary as folder:
        yield Path(folder)


def _put(file: Path, target: Path) -> None:
    """Replace `target` by `file` in the same folder; return when that is on disk."""
    _sync(file)
    os.replace(file, target)
    _sync(target.parent)


def _sync(path: Path) -> None:
    descriptor = os.open(path, os.O_RDONLY | os.O_CLOEXEC)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def _settle(database: Path) -> None:
    """Move what the log of a database holds into its file and remove the log; SQLite survives a crash in between.

    Raises:
        sqlite3.Error: somebody else has it open.
    """
    with closing(sqlite3.connect(f"{database.resolve().as_uri()}?mode=rw", uri=True)) as connection:
        connection.execute("PRAGMA journal_mode=DELETE")


def _check(copy: sqlite3.Connection, source: Path) -> None:
    verdict = copy.execute("PRAGMA integrity_check").fetchone()
    if verdict != ("ok",):
        raise SettingsError(f"{source} is damaged: {verdict[0]}", f"{source} 已损坏：{verdict[0]}")
    tables = {row[0] for row in copy.execute("SELECT name FROM sqlite_master WHERE type = 'table'")}
    if not {"submission", "alembic_version"} <= tables:
        raise SettingsError(f"{source} is no database of the grader", f"{source} 不是评分系统的数据库")


def _pass_on_access(old: Path, new: Path) -> None:
    """Give `new` the owner and mode of `old`: an administrator restores what the service must be able to open."""
    was = old.stat()
    with suppress(PermissionError):  # only an administrator may give files away
        os.chown(new, was.st_uid, was.st_gid)
    new.chmod(stat.S_IMODE(was.st_mode))


def _forget_log(database: Path) -> None:
    for log in ("-wal", "-shm", "-journal"):
        Path(f"{database}{log}").unlink(missing_ok=True)
