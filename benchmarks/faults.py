"""Faults at random moments: processes killed, stopped, frozen; the database killed, the queue's tables emptied."""

from __future__ import annotations

import contextlib
import os
import random
import signal
import threading
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime

from sqlalchemy import text
from sqlalchemy.exc import SQLAlchemyError

from benchmarks.postgres_server import PostgresServer
from benchmarks.processes import Service, tree
from grader.contracts.errors import InfrastructureError
from grader.store.database import Database

KINDS = ("kill", "stop", "child", "freeze", "database", "wipe")
_FROZEN_S = 20.0  # longer than a lease
_FREEZE_AGAIN_S = 60.0
_DATABASE_AWAY_S = 3.0
_DATABASE_KILLS = 3
_RESTART_S = 1.0  # what a supervisor waits before it starts a process again
_LOOK_S = 0.2


@dataclass(frozen=True, slots=True)
class Fault:
    """A fault and what it hit. `struck`: submissions that were being graded by its victim at that moment."""

    at: datetime
    kind: str
    victim: str
    struck: tuple[str, ...]


class Faults(threading.Thread):
    """Makes faults every few seconds until stopped, and starts again what died, as a supervisor does.

    Attributes:
        made: every fault so far.
    """

    def __init__(
        self,
        service: Service,
        kinds: Sequence[str],
        every_s: float,
        seed: int,
        server: PostgresServer | None = None,
    ) -> None:
        super().__init__(daemon=True)
        self._service = service
        self._server = server
        self._kinds = [one for one in kinds if server is not None or one not in ("database", "wipe")]
        self._every_s = every_s
        self._chance = random.Random(seed)  # noqa: S311 - not a secret
        self._stopped = threading.Event()
        self._frozen: dict[str, float] = {}
        self._freeze_again = 0.0
        self._died: dict[str, float] = {}
        self._database = Database(service.database)
        self.made: list[Fault] = []

    def run(self) -> None:
        """Make faults until told to stop."""
        due = time.monotonic() + self._pause_s()
        while not self._stopped.wait(_LOOK_S):
            self._supervise()
            if time.monotonic() >= due and self._kinds:
                self._make(self._chance.choice(self._kinds))
                due = time.monotonic() + self._pause_s()

    def stop(self) -> None:
        """Make no more faults, thaw what is frozen and start what is down."""
        self._stopped.set()
        self.join()
        while self._frozen or self._died:
            self._supervise()
            time.sleep(_LOOK_S)
        self._database.close()

    def supervise(self) -> None:
        """Start again what died by itself; for the time after `stop`."""
        self._supervise()

    def _pause_s(self) -> float:
        return self._every_s * self._chance.uniform(0.5, 1.5)

    def _make(self, kind: str) -> None:
        acts: dict[str, Callable[[], tuple[str, int | None] | None]] = {
            "kill": self._kill,
            "stop": self._terminate,
            "child": self._kill_child,
            "freeze": self._freeze,
            "database": self._kill_database,
            "wipe": self._wipe,
        }
        running = self._running()  # before: afterwards a victim may not be found any more
        at = datetime.now(UTC)
        done = acts[kind]()
        if done is not None:
            victim, pid = done
            struck = tuple(id_ for id_, grading_pid in running if pid is not None and grading_pid == pid)
            self.made.append(Fault(at, kind, victim, struck))

    def _kill(self) -> tuple[str, int | None] | None:
        name = self._any_up()
        if name is None:
            return None
        pid = self._service.running[name].pid
        self._service.kill(name)
        return name, pid

    def _terminate(self) -> tuple[str, int | None] | None:
        name = self._any_up()
        if name is None:
            return None
        self._service.running[name].terminate()
        return name, self._service.running[name].pid

    def _kill_child(self) -> tuple[str, int | None] | None:
        name = self._any_up()
        children = [] if name is None else list(tree(self._service.running[name].pid))[1:]
        if name is None or not children:
            return None
        with contextlib.suppress(ProcessLookupError):
            os.kill(self._chance.choice(children), signal.SIGKILL)
        return f"{name}'s child", None

    def _freeze(self) -> tuple[str, int | None] | None:
        graders = [name for name in self._up() if name.startswith("worker")] or self._up()
        if not graders or time.monotonic() < self._freeze_again:
            return None
        self._freeze_again = time.monotonic() + _FREEZE_AGAIN_S
        name = self._chance.choice(graders)
        process = self._service.running[name]
        process.send_signal(signal.SIGSTOP)
        self._frozen[name] = time.monotonic() + _FROZEN_S
        return name, process.pid

    def _kill_database(self) -> tuple[str, int | None] | None:
        if self._server is None or sum(one.kind == "database" for one in self.made) >= _DATABASE_KILLS:
            return None
        self._server.kill()
        time.sleep(_DATABASE_AWAY_S)
        self._server.start()
        return "PostgreSQL", None

    def _wipe(self) -> tuple[str, int | None] | None:
        try:
            with self._database.writing() as session:
                session.execute(text("TRUNCATE procrastinate_jobs, procrastinate_workers CASCADE"))
        except (InfrastructureError, SQLAlchemyError):
            return None
        return "the queue's tables", None

    def _running(self) -> list[tuple[str, int]]:
        """Return what is being graded, and the pid of the process whose worker does it."""
        try:
            with self._database.reading() as session:
                rows = session.execute(
                    text("SELECT id, worker FROM submission WHERE state = 'running'")
                ).all()
        except (InfrastructureError, SQLAlchemyError):
            return []
        return [(row[0], int(row[1].split(":")[1])) for row in rows]

    def _any_up(self) -> str | None:
        up = self._up()
        return self._chance.choice(up) if up else None

    def _up(self) -> list[str]:
        running = self._service.running
        return [name for name in sorted(running) if running[name].poll() is None and name not in self._frozen]

    def _supervise(self) -> None:
        now = time.monotonic()
        for name, thaw in list(self._frozen.items()):
            if now >= thaw or self._stopped.is_set():
                self._service.running[name].send_signal(signal.SIGCONT)
                del self._frozen[name]
        for name, process in list(self._service.running.items()):
            if process.poll() is not None and name not in self._died:
                self._died[name] = now
        for name, since in list(self._died.items()):
            if now >= since + _RESTART_S:
                self._service.start(name)
                del self._died[name]
