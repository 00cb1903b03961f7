"""A worker process: its slots, its heart, and how both start and stop."""

import logging
import os
import secrets
import socket
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial

from grader.contracts.errors import InfrastructureError
from grader.operation.logs import bound
from grader.service.worker.examiner import Examiner
from grader.service.worker.explainer import Explainer
from grader.service.worker.heart import Heart
from grader.service.worker.slots import SandboxHealth, WorkerParts, WorkerSlot
from grader.store.work import PolledWork

_log = logging.getLogger(__name__)
_ABORT_S = 5.0


@dataclass(frozen=True, slots=True, kw_only=True)
class WorkerConfig:
    """Pace of a worker; the fields mean what they mean in `grader.operation.settings.Settings`."""

    slots: int
    heartbeat_s: float = 3.0
    poll_s: float = 0.5
    drain_s: float = 30.0


class Worker:
    """Slots and a heart, in threads of this process. Started once and stopped once."""

    def __init__(self, parts: WorkerParts, config: WorkerConfig) -> None:
        self.id = f"{socket.gethostname()}:{os.getpid()}:{secrets.token_hex(4)}"
        self._parts = parts
        self._config = config
        self._sandbox = SandboxHealth(parts.probe)
        keeps_one = config.slots > 1  # for those whose turn it is
        self._slots = [
            WorkerSlot(f"{self.id}/{number}", parts, self._sandbox, reserved=number == 0 and keeps_one)
            for number in range(config.slots)
        ]
        self._work = PolledWork(parts.doorbell, config.poll_s)
        self._heart = Heart(self.id, self._slots, parts, self._sandbox, config.heartbeat_s)
        self._behind = _behind(parts, lambda: self._sandbox.state.ready) if config.slots else ()
        self._threads = [
            threading.Thread(target=self._work_on, args=(slot,), name=f"grader-slot-{number}", daemon=True)
            for number, slot in enumerate(self._slots)
        ]

    def start(self) -> None:
        """Try the sandbox, then begin to take work."""
        self._heart.start()
        for thread in (*self._threads, *self._behind):
            thread.start()

    def stop(self) -> None:
        """Take no more work, let running gradings finish, and return to the queue what takes too long."""
        for slot in self._slots:
            slot.stop()
        self._work.drain()
        for background in self._behind:
            background.stop(_ABORT_S)
        self._join(self._config.drain_s)
        self._heart.stop(_ABORT_S)
        with _database_may_be_away():
            for id_ in self._parts.queue.hand_back_all([slot.name for slot in self._slots]):
                with bound(submission=id_, worker=self.id):
                    _log.warning("%s goes back to the queue: the worker stops", id_)
            self._parts.workers.leave(self.id)
        for slot in self._slots:  # only now: its claim is handed back, so that the kill counts for nothing
            if slot.claim is not None:
                slot.abort()
        self._join(_ABORT_S)

    def _work_on(self, slot: WorkerSlot) -> None:
        slot.warm_up()
        self._work.serve(slot.step)
        slot.close()

    def _join(self, timeout_s: float) -> None:
        deadline_s = time.monotonic() + timeout_s
        for thread in self._threads:
            thread.join(max(0.0, deadline_s - time.monotonic()))


def _behind(parts: WorkerParts, ready: Callable[[], bool]) -> tuple[Examiner | Explainer, ...]:
    """Return what works behind the slots."""
    is_due = parts.queue.is_due
    behind: list[Examiner | Explainer] = []
    if parts.uploads is not None:
        students_wait = partial(is_due, in_turn=True)
        behind.append(Examiner(parts.uploads, parts.assignments, ready=ready, students_wait=students_wait))
    if parts.explaining is not None:
        behind.append(Explainer(parts.explaining, parts.doorbell, ready=ready, submissions_wait=is_due))
    return tuple(behind)


@contextmanager
def _database_may_be_away() -> Iterator[None]:
    """Catch that the database does not answer, so that a stop goes on without it."""
    try:
        yield
    except InfrastructureError as error:
        _log.warning("stopped without the database, leases end what was under way: %s", error)
