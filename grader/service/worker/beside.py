"""The service's own worker: a process of its own, beside the one that answers HTTP.

In one process both would share one interpreter: an upload would wait for a report that is being stored, and a slot
for a dashboard. `WorkerProcess` is the service's end, `ServiceLink` the worker's. Between them is one socket, both
ways trusted. The service writes an empty line when something was queued. The worker writes an empty line when
something changed, and what it counts: the name of a method of `GradingCounts` and its arguments, as JSON. Each
message is also a hint to look at the rows. A message that does not fit is dropped: a lost hint costs a poll
interval, and counts are only measurements.

The socket's end is how both end. A worker whose service is gone, in whatever way, finishes what it grades and
leaves. A service whose worker is gone starts another one.
"""

import json
import logging
import os
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Mapping, Sequence
from contextlib import suppress

from grader.contracts.python import SAFE_PATH
from grader.contracts.report import GradeStatus
from grader.operation.settings import Settings
from grader.service.worker.slots import GradingCounts
from grader.store.work import Doorbell

_log = logging.getLogger(__name__)
_OF_WORKERS = (
    "assignments",
    "database_connections",
    "database_url",
    "default_language",
    "drain_s",
    "heartbeat_s",
    "lease_s",
    "log_format",
    "log_level",
    "max_tries",
    "poll_s",
    "retry_backoff_s",
    "slots",
)
"""Settings that a worker is told. It needs no token and no password but the database's."""
_PREFIX = "GRADER_"
_PROGRAM = (sys.executable, *SAFE_PATH, "-m", "grader")
_MOST_BYTES = 1_000
_PAUSE_S, _LONGEST_PAUSE_S = 0.5, 30.0
_LIVED_S = 60.0  # so long: what ended the worker is no fault that every start meets
_END_S = 20.0  # beyond `drain_s`: handing back, ending what grades


class WorkerProcess:
    """A worker process for as long as it is wanted; started once and stopped once."""

    def __init__(
        self,
        settings: Settings,
        doorbell: Doorbell,
        counts: GradingCounts,
        program: Sequence[str] = _PROGRAM,
    ) -> None:
        """Prepare; nothing is started yet.

        Args:
            settings: the service's.
            doorbell: rung by the service when something was queued, and here when the worker says something.
            counts: told what the worker counts.
            program: the grader's command.
        """
        self._program = program
        self._environment = environment_of(settings, os.environ)
        self._patience_s = settings.drain_s + _END_S
        self._doorbell = doorbell
        self._counts = counts
        self._stopping = threading.Event()
        self._lock = threading.Lock()  # nothing is started while it is being stopped
        self._link: socket.socket | None = None
        self._process: subprocess.Popen[bytes] | None = None
        self._thread = threading.Thread(target=self._keep, name="grader-worker-process", daemon=True)

    def start(self) -> None:
        """Start the worker; another one whenever it ends by itself."""
        self._doorbell.tell(self._ring)
        self._thread.start()

    def stop(self) -> None:
        """Let the worker finish what it grades, within the settings' `drain_s`, and wait for its end."""
        with self._lock:
            self._stopping.set()
            if self._link is not None:
                self._link.shutdown(socket.SHUT_WR)
        self._thread.join(self._patience_s)
        if self._thread.is_alive() and self._process is not None:
            _log.error("the worker process does not end: it is killed")
            self._process.kill()
            self._thread.join()

    def _keep(self) -> None:
        pause_s = _PAUSE_S
        while (link := self._started()) is not None:
            begun_s = time.monotonic()
            with link:
                self._listen(link)
                with self._lock:
                    self._link = None
            assert self._process is not None
            code = self._process.wait()
            if self._stopping.is_set():
                return
            pause_s = (
                _PAUSE_S if time.monotonic() - begun_s > _LIVED_S else min(2 * pause_s, _LONGEST_PAUSE_S)
            )
            _log.error("the worker process ended (%d); another one starts in %g s", code, pause_s)
            self._stopping.wait(pause_s)

    def _started(self) -> socket.socket | None:
        with self._lock:
            if self._stopping.is_set():
                return None
            ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
            with theirs:
                number = theirs.fileno()
                command = [*self._program, "worker", "--service", str(number)]
                self._process = subprocess.Popen(  # noqa: S603 - this very program
                    command, env=self._environment, stdin=subprocess.DEVNULL, pass_fds=[number]
                )
            self._link = ours
            return ours

    def _listen(self, link: socket.socket) -> None:
        while message := _received(link):
            self._count(message.strip())
            self._doorbell.ring_here()

    def _count(self, message: bytes) -> None:
        if not message:
            return
        name, *values = json.loads(message)
        if name == "graded":
            verdict, grading_s, waited_s = values
            self._counts.graded(GradeStatus(verdict), grading_s, waited_s)
        elif name == "retried":
            self._counts.retried(*values)
        else:
            self._counts.given_up(*values)

    def _ring(self) -> None:
        link = self._link
        if link is not None:
            _send(link, b"\n")


class ServiceLink:
    """The service that a worker process belongs to; counts for it what is graded."""

    def __init__(self, descriptor: int, doorbell: Doorbell, service_gone: threading.Event) -> None:
        """Begin to listen; `service_gone` is set when the service stops or has ended."""
        os.set_inheritable(descriptor, False)  # what grades must not keep it open
        self._socket = socket.socket(fileno=descriptor)
        self._doorbell = doorbell
        self._service_gone = service_gone
        doorbell.tell(lambda: _send(self._socket, b"\n"))
        threading.Thread(target=self._listen, name="grader-service", daemon=True).start()

    def graded(self, verdict: GradeStatus, grading_s: float, waited_s: float) -> None:
        """Count a grading, as `Metrics` does."""
        self._say("graded", verdict.value, grading_s, waited_s)

    def retried(self, tries: int = 1) -> None:
        """Count tries, as `Metrics` does."""
        self._say("retried", tries)

    def given_up(self, submissions: int = 1) -> None:
        """Count submissions, as `Metrics` does."""
        self._say("given_up", submissions)

    def _say(self, *message: str | float) -> None:
        _send(self._socket, json.dumps(message).encode())

    def _listen(self) -> None:
        while _received(self._socket):
            self._doorbell.ring_here()
        self._service_gone.set()


def environment_of(settings: Settings, inherited: Mapping[str, str]) -> dict[str, str]:
    """Return the environment of a worker of a service with `settings`."""
    others = {name: value for name, value in inherited.items() if not name.startswith(_PREFIX)}
    return others | {_PREFIX + name.upper(): str(getattr(settings, name)) for name in _OF_WORKERS}


def _received(link: socket.socket) -> bytes:
    """Return the next message; nothing when the other end is gone."""
    try:
        return link.recv(_MOST_BYTES)
    except OSError:
        return b""


def _send(link: socket.socket, message: bytes) -> None:
    with suppress(OSError):  # full, or the other end is gone
        link.send(message, socket.MSG_DONTWAIT | socket.MSG_NOSIGNAL)
