"""The processes of a service under test: started in a folder of their own, watched, killed, put away."""

from __future__ import annotations

import csv
import os
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Self

import httpx

COURSE = "ros2-load"
INSTRUCTOR = "wang"
_START_S = 600.0  # also on a machine that something else keeps busy
_LOOK_S = 2.0


class Service:
    """One or more API processes and workers over one database; use as a context manager.

    The class's own limits per student are lifted, because a load generator is quicker than students.
    """

    def __init__(  # noqa: PLR0913
        self,
        folder: Path,
        *,
        apis: int = 1,
        workers: int = 0,
        database: str | None = None,
        settings: Mapping[str, str] | None = None,
        enter: Callable[[], None] | None = None,
    ) -> None:
        """Say what is to run; nothing is started yet.

        Args:
            folder: for the database and the processes' output.
            apis: processes of ``grader serve``. They grade themselves when there are no `workers`.
            workers: processes of ``grader worker``, one grading at once each.
            database: URL; default: a SQLite file in `folder`.
            settings: by their names without ``GRADER_``, beside those that lift limits.
            enter: called in each process before it becomes the service, to bound it.
        """
        self.folder = folder
        self._apis = apis
        self._workers = workers
        self._settings = settings or {}
        self._enter = enter
        self.database = database or f"sqlite:///{folder / 'grader.db'}"
        self.urls = [f"http://127.0.0.1:{free_port()}" for _ in range(apis)]
        self.running: dict[str, subprocess.Popen[bytes]] = {}

    def __enter__(self) -> Self:
        for number in range(self._apis):
            self.start(f"api{number}")
            self.await_ready(self.urls[number])  # the first brings the database up to date
        for number in range(self._workers):
            self.start(f"worker{number}")
        return self

    def __exit__(self, *_: object) -> None:
        for process in self.running.values():
            process.terminate()
        for process in self.running.values():
            process.wait()

    def start(self, name: str) -> None:
        """Start ``api0``, ``worker1``, ...; its output goes to a file of that name."""
        if name.startswith("api"):
            port = self.urls[int(name.removeprefix("api"))].rpartition(":")[2]
            arguments = ["serve", "--port", port, *(["--slots", "0"] if self._workers else [])]
        else:
            arguments = ["worker", "--slots", "1"]
        with (self.folder / f"{name}.log").open("ab") as log:
            self.running[name] = subprocess.Popen(
                [sys.executable, "-m", "grader", *arguments],
                env=self.environment,
                stderr=log,
                stdout=log,
                preexec_fn=self._enter,  # noqa: PLW1509  no other thread runs when processes are started
                start_new_session=True,  # as a service manager starts it: it shares no priority with who hands in
            )

    def restart(self, settings: Mapping[str, str]) -> None:
        """End the first API process as an operator does, and start it anew with other settings besides."""
        self._settings = {**self._settings, **settings}
        self.running["api0"].terminate()
        self.running["api0"].wait()
        self.start("api0")
        self.await_ready(self.urls[0])

    def kill(self, name: str) -> None:
        """End a process as a power cut would."""
        self.running[name].send_signal(signal.SIGKILL)
        self.running[name].wait()

    @property
    def environment(self) -> dict[str, str]:
        """The environment of every process."""
        settings = {"DATABASE_URL": self.database, "UPLOADS_PER_MINUTE": "100000"}
        settings |= {"REQUESTS_PER_MINUTE": "1000000", "MAX_OPEN_SUBMISSIONS": "10000"}
        settings |= self._settings
        return os.environ | {f"GRADER_{name}": value for name, value in settings.items()}

    def command(self, *arguments: str) -> str:
        """Run ``grader`` with `arguments`; return what it prints."""
        command = [sys.executable, "-m", "grader", *arguments]
        done = subprocess.run(command, env=self.environment, check=True, capture_output=True, text=True)
        return done.stdout

    def enrol(self, students: Sequence[str]) -> dict[str, str]:
        """Create a course with a teacher; return everybody's token."""
        path = self.folder / "class.csv"
        path.write_text("id,name\n" + "".join(f"{one},Student {one}\n" for one in students))
        printed = self.command("course", "create", COURSE, "--instructor", INSTRUCTOR, "--roster", str(path))
        return {
            row["id"]: row["token"] for row in csv.DictReader(printed.removeprefix("\ufeff").splitlines())
        }

    def await_ready(self, url: str) -> None:
        """Wait until the API process at `url` answers.

        Raises:
            TimeoutError: it does not.
        """
        deadline = time.monotonic() + _START_S
        while time.monotonic() < deadline:
            try:
                httpx.get(f"{url}/healthz", trust_env=False)
            except httpx.TransportError:
                time.sleep(0.05)
                ended = self.running[f"api{self.urls.index(url)}"].poll()
                if ended is not None:
                    raise TimeoutError(f"the process of {url} ended ({ended}); see {self.folder}") from None
            else:
                return
        raise TimeoutError(f"nothing answers at {url}; see {self.folder}")


class Memory(threading.Thread):
    """Looks now and then at how much memory a service's processes use, and remembers the most.

    Attributes:
        peak_mib: sum of proportional set sizes: pages that several processes share are counted once.
    """

    def __init__(self, service: Service) -> None:
        super().__init__(daemon=True)
        self._service = service
        self._stopped = threading.Event()
        self.peak_mib = 0.0

    def run(self) -> None:
        """Look until told to stop."""
        while not self._stopped.wait(_LOOK_S):
            pids = [process.pid for process in self._service.running.values()]
            used = sum(proportional_mib(pid) for first in pids for pid in tree(first))
            self.peak_mib = max(self.peak_mib, used)

    def stop(self) -> None:
        """Look no more."""
        self._stopped.set()
        self.join()


def tree(pid: int) -> Iterator[int]:
    """Yield a process and everything below it."""
    yield pid
    for child in children(pid):
        yield from tree(child)


def children(pid: int) -> Iterator[int]:
    """Yield what a process and its threads have started and not yet reaped."""
    for task in _entries(Path(f"/proc/{pid}/task")):
        try:
            found = (task / "children").read_text(encoding="ascii").split()
        except OSError:
            continue
        yield from map(int, found)


def cpu_s(pid: int) -> float:
    """Return the CPU seconds of one process, children not counted; 0.0 when it is gone."""
    return _ticks_s(pid, 11)


def reaped_cpu_s(pid: int) -> float:
    """Return the CPU seconds of those children that a process has reaped; 0.0 when it is gone itself."""
    return _ticks_s(pid, 13)


@dataclass(frozen=True, slots=True)
class Spent:
    """Processor seconds by kind of process."""

    parent: float
    grading: float
    scripts: float
    database: float = 0.0

    def since(self, before: Spent) -> Spent:
        """Return what was spent after `before`."""
        return Spent(
            self.parent - before.parent,
            self.grading - before.grading,
            self.scripts - before.scripts,
            self.database - before.database,
        )

    def plus(self, other: Spent) -> Spent:
        """Return the sum."""
        return other.since(Spent(-self.parent, -self.grading, -self.scripts, -self.database))


def spent(parents: Sequence[int], server: int | None = None) -> Spent:
    """Return what was spent up to now by `parents`, their grading processes, and the database server `server`.

    The worker process of a service counts as a parent.
    """
    beside = [child for parent in parents for child in children(parent) if _is_worker(child)]
    parents = [*parents, *beside]
    grading = [child for parent in parents for child in children(parent) if child not in beside]
    below = [one for process in grading for child in children(process) for one in tree(child)]
    return Spent(
        parent=sum(map(cpu_s, parents)),
        grading=sum(map(cpu_s, grading)),
        scripts=sum(cpu_s(one) + reaped_cpu_s(one) for one in below),
        database=0.0 if server is None else reaped_cpu_s(server) + sum(map(cpu_s, tree(server))),
    )


def _is_worker(pid: int) -> bool:
    try:
        return b"\0worker\0" in Path(f"/proc/{pid}/cmdline").read_bytes()
    except OSError:
        return False


def _ticks_s(pid: int, field: int) -> float:
    """Return the sum of two neighbouring fields of a process's times (proc(5); 0 is its state)."""
    try:
        fields = Path(f"/proc/{pid}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()
    except OSError:
        return 0.0
    return (int(fields[field]) + int(fields[field + 1])) / os.sysconf("SC_CLK_TCK")


def proportional_mib(pid: int) -> float:
    """Return the memory of one process, of pages that several share its part; 0.0 when it is gone."""
    try:
        lines = Path(f"/proc/{pid}/smaps_rollup").read_text(encoding="ascii").splitlines()
    except OSError:
        return 0.0
    sizes: Mapping[str, str] = dict(line.split(":", 1) for line in lines[1:])
    return int(sizes["Pss"].split()[0]) / 1024


def _entries(folder: Path) -> list[Path]:
    try:
        return list(folder.iterdir())
    except OSError:
        return []


def free_port() -> int:
    """Return a port of loopback that nobody listens on at present."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port: int = probe.getsockname()[1]
        return port
