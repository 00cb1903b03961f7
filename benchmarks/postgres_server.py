"""A PostgreSQL server on loopback in a folder of its own, that can be killed at any moment."""

from __future__ import annotations

import contextlib
import os
import pwd
import shutil
import signal
import subprocess
import tempfile
import time
from pathlib import Path
from typing import Any, Self

from benchmarks.processes import free_port, tree

_PATIENCE_S = 60.0
_DATABASE = "grader"


class PostgresServer:
    """Debian's PostgreSQL with its default durability; use as a context manager."""

    def __init__(self) -> None:
        """Say where it will be; nothing is started yet.

        Raises:
            FileNotFoundError: PostgreSQL is not installed in Debian's place.
        """
        found = sorted(Path("/usr/lib/postgresql").glob("*/bin"), key=lambda path: int(path.parent.name))
        if not found:
            raise FileNotFoundError("no PostgreSQL in /usr/lib/postgresql: apt install postgresql")
        self._programs = found[-1]
        self._folder = Path(tempfile.mkdtemp(prefix="grader-chaos-pg-"))
        self._port = free_port()
        self._server: subprocess.Popen[bytes] | None = None

    @property
    def url(self) -> str:
        """The address of an empty database."""
        return f"postgresql+psycopg://postgres@127.0.0.1:{self._port}/{_DATABASE}"

    @property
    def pid(self) -> int:
        """The process above all others of the server."""
        assert self._server is not None
        return self._server.pid

    def __enter__(self) -> Self:
        if os.geteuid() == 0:
            owner = pwd.getpwnam("postgres")
            os.chown(self._folder, owner.pw_uid, owner.pw_gid)
        self._run("initdb", "-D", self._data, "-U", "postgres", "-A", "trust", "-E", "UTF8", "--no-locale")
        self.start()
        self._run("createdb", "-h", "127.0.0.1", "-p", str(self._port), "-U", "postgres", _DATABASE)
        return self

    def __exit__(self, *_: object) -> None:
        if self._server is not None:
            self._server.send_signal(signal.SIGINT)  # what PostgreSQL calls a fast shutdown
            self._server.wait()
        shutil.rmtree(self._folder, ignore_errors=True)

    def start(self) -> None:
        """Start it and wait until it takes connections.

        Raises:
            TimeoutError: it does not.
        """
        with (self._folder / "log").open("ab") as log:
            self._server = subprocess.Popen(
                [self._programs / "postgres", "-D", self._data, "-p", str(self._port), "-k", self._folder],
                stdout=log,
                stderr=log,
                **self._identity(),
            )
        ask = [str(self._programs / "pg_isready"), "-q", "-h", "127.0.0.1", "-p", str(self._port)]
        deadline = time.monotonic() + _PATIENCE_S
        while subprocess.run(ask, check=False).returncode:
            if time.monotonic() > deadline:
                raise TimeoutError(f"PostgreSQL does not start; see {self._folder / 'log'}")
            time.sleep(0.05)

    def kill(self) -> None:
        """End all its processes at once, unasked."""
        assert self._server is not None
        for pid in list(tree(self._server.pid)):
            with contextlib.suppress(ProcessLookupError):
                os.kill(pid, signal.SIGKILL)
        self._server.wait()

    @property
    def _data(self) -> Path:
        return self._folder / "data"

    def _run(self, program: str, *arguments: Any) -> None:
        command = [str(self._programs / program), *map(str, arguments)]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL, cwd=self._folder, **self._identity())

    def _identity(self) -> dict[str, Any]:
        """PostgreSQL refuses to run as root."""
        if os.geteuid() != 0:
            return {}
        owner = pwd.getpwnam("postgres")
        return {"user": owner.pw_uid, "group": owner.pw_gid, "extra_groups": []}
