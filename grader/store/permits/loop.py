"""Taking permits: Procrastinate's worker in a thread of this process, restarted for as long as it is wanted."""

import asyncio
import logging
import threading
from collections import deque
from collections.abc import Callable
from concurrent.futures import Future
from typing import Any

import psycopg
from procrastinate import App, PsycopgConnector
from procrastinate.exceptions import ConnectorException

from grader.contracts.errors import GraderError
from grader.store.clock import Clock
from grader.store.database import PATIENCE, Database
from grader.store.permits.announcer import QUEUE, TASK, defer_again
from grader.store.work import PERMIT_CONNECTIONS, attempted

_log = logging.getLogger(__name__)
_HEARTBEAT_S = 2.0
_STALLED_S = 10.0
_LOOK_S = 0.1  # how often to ask whether permits may be taken
_LOOK_AGAIN_S = 1.0  # how often to ask whether they still may: what came meanwhile was given back
_PAUSES_S = (0.2, 0.5, 1.0, 2.0)  # before each next try to reach the database
_CONNECT_S = 5
_END_S = 10.0
_NOISY_LOGGERS = ("asyncio", "procrastinate.utils", "procrastinate.worker", "procrastinate.worker.worker")
"""Loggers that write pages of tracebacks whenever the database is away, which is said here in one line."""


class Exchange:
    """Hands permits to slots. Each permit is answered exactly once: whether it was used.

    Procrastinate cancels a job that somebody asked it to abort; no slot may end by that.
    """

    def __init__(self) -> None:
        self._changed = threading.Condition()
        self._offered: deque[Future[bool]] = deque()
        self._closed = False

    def offer(self) -> Future[bool]:
        """Offer a permit; the result says whether a slot found something to grade with it."""
        answer: Future[bool] = Future()
        with self._changed:
            if self._closed:
                answer.set_result(False)
            else:
                self._offered.append(answer)
                self._changed.notify()
        return answer

    def serve(self, step: Callable[[], bool]) -> None:
        """Call `step` once for each permit, in the calling thread, until the exchange closes."""
        while (answer := self._next()) is not None:
            used = False
            try:
                used = step()
            finally:
                answer.set_result(used)

    def close(self) -> None:
        """Take no more permits and return those that no slot has yet. What slots do is not disturbed."""
        with self._changed:
            self._closed = True
            for answer in self._offered:
                if answer.set_running_or_notify_cancel():
                    answer.set_result(False)
            self._offered.clear()
            self._changed.notify_all()

    def _next(self) -> Future[bool] | None:
        """Wait for a permit that is still wanted; from then on it cannot be withdrawn. None: there are no more."""
        with self._changed:
            while True:
                self._changed.wait_for(lambda: self._closed or self._offered)
                if self._closed:
                    return None
                answer = self._offered.popleft()
                if answer.set_running_or_notify_cancel():
                    return answer


class PermitLoop:
    """Brings permits to slots while `ready`. The database may go away and come back meanwhile.

    Permits are taken in a thread of their own, so that Procrastinate's heartbeat goes on while slots grade.
    """

    def __init__(self, database: Database, clock: Clock, poll_s: float) -> None:
        """Prepare; nothing is opened yet.

        `poll_s`: how often to look for permits that no notification announced.
        """
        self._database = database
        self._arguments = _connect_arguments(database)
        self._clock = clock
        self._poll_s = poll_s
        self._exchange = Exchange()
        self._stopping: Future[None] = Future()
        self._thread: threading.Thread | None = None

    def start(self, slots: int, ready: Callable[[], bool]) -> None:
        """Begin to take permits whenever `ready` says that work may be taken, at most `slots` at once."""
        for name in _NOISY_LOGGERS:
            logging.getLogger(name).addFilter(_says_something_new)
        self._thread = threading.Thread(
            target=lambda: asyncio.run(self._take_permits(slots, ready)), name="grader-permits", daemon=True
        )
        self._thread.start()

    def serve(self, step: Callable[[], bool]) -> None:
        """Call `step` for each permit that comes, in the calling thread, until there are to be no more."""
        self._exchange.serve(lambda: attempted(step))

    def drain(self) -> None:
        """Take no more permits; what slots grade goes on."""
        if not self._stopping.done():
            self._stopping.set_result(None)
        self._exchange.close()

    def close(self) -> None:
        """Wait until the permits that were used are put away."""
        if self._thread is not None:
            self._thread.join(_END_S)

    async def _take_permits(self, slots: int, ready: Callable[[], bool]) -> None:
        failures = 0
        while not self._stopping.done():
            if not ready():
                await asyncio.sleep(_LOOK_S)
                continue
            try:
                await self._reach()
                failures = 0
                await self._work(slots, ready)
            except Exception as error:
                _log.warning("permits cannot be taken: %s", _reason(error))
                await asyncio.sleep(_PAUSES_S[min(failures, len(_PAUSES_S) - 1)])
                failures += 1

    async def _reach(self) -> None:
        """Connect once: the pool below would try for half a minute, at growing intervals, before it says no."""
        connection = await psycopg.AsyncConnection.connect(**self._arguments)
        await connection.close()

    async def _work(self, slots: int, ready: Callable[[], bool]) -> None:
        """Run a worker until it fails, or is not wanted any more."""
        connector = PsycopgConnector(
            kwargs=self._arguments, min_size=1, max_size=PERMIT_CONNECTIONS - 1, timeout=float(_CONNECT_S)
        )
        app = App(connector=connector)
        app.task(name=TASK, queue=QUEUE)(self._use)
        async with app.open_async():
            worker = asyncio.create_task(
                app.run_worker_async(
                    queues=[QUEUE],
                    concurrency=slots,
                    fetch_job_polling_interval=self._poll_s,
                    update_heartbeat_interval=_HEARTBEAT_S,
                    stalled_worker_timeout=_STALLED_S,
                    delete_jobs="always",  # the row keeps the history
                    install_signal_handlers=False,
                )
            )
            ends = [worker, asyncio.wrap_future(self._stopping)]
            while ready() and not any(one.done() for one in ends):
                await asyncio.wait(ends, timeout=_LOOK_AGAIN_S, return_when=asyncio.FIRST_COMPLETED)
            worker.cancel()  # which lets the jobs under way end first
            await asyncio.wait([worker])
            if not worker.cancelled() and (error := worker.exception()) is not None:
                raise error

    async def _use(self, submission: str, attempt: int) -> None:
        """Grade something with a permit. Never raises: what goes wrong is on the row."""
        if not await asyncio.wrap_future(self._exchange.offer()):
            try:
                await asyncio.to_thread(self._give_back, submission, attempt)
            except GraderError as error:
                _log.warning("a permit is lost until the next sweep: %s", error)

    def _give_back(self, submission_id: str, attempt: int) -> None:
        with self._database.writing() as session:
            defer_again(session, submission_id, attempt, self._clock())


def _says_something_new(record: logging.LogRecord) -> bool:
    return not (record.exc_info and isinstance(record.exc_info[1], ConnectorException))


def _connect_arguments(database: Database) -> dict[str, Any]:
    _, arguments = database.engine.dialect.create_connect_args(database.engine.url)
    arguments.pop("context", None)  # SQLAlchemy's own adapters
    return {**PATIENCE, "connect_timeout": _CONNECT_S, **arguments, "application_name": "grader permits"}


def _reason(error: BaseException) -> str:
    while error.__cause__ is not None:
        error = error.__cause__
    return " ".join(str(error).split()) or type(error).__name__
