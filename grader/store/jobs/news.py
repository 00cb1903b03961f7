"""News of uploads as jobs of Procrastinate: hearing of them in a thread of a worker."""

import asyncio
import logging
import threading
from collections.abc import Iterator
from concurrent.futures import Future
from contextlib import contextmanager, suppress
from typing import Any

import psycopg
from procrastinate import App, PsycopgConnector
from procrastinate.exceptions import ConnectorException
from sqlalchemy import text

from grader.contracts.errors import InfrastructureError
from grader.store.database import PATIENCE, Database
from grader.store.work import JOB_QUEUE, JOB_TASK, NEWS_CONNECTIONS, Doorbell

_log = logging.getLogger(__name__)
_HEARTBEAT_S = 2.0
_STALLED_S = 10.0
_POLL_S = 5.0  # for jobs that no notification told of; slots look at the rows far more often
_PAUSES_S = (0.2, 0.5, 1.0, 2.0)  # before each next try to reach the database
_CONNECT_S = 5
_END_S = 10.0
_NOISY_LOGGERS = ("asyncio", "procrastinate.utils", "procrastinate.worker", "procrastinate.worker.worker")
"""Loggers that write pages of tracebacks whenever the database is away, which is said here in one line."""

_FORGET = text(  # SKIP LOCKED: somebody may be taking the same jobs at this moment
    "DELETE FROM procrastinate_jobs WHERE id IN (SELECT id FROM procrastinate_jobs"
    " WHERE status <> 'doing' OR worker_id IS NULL ORDER BY id FOR UPDATE SKIP LOCKED)"
)


@contextmanager
def heard(database: Database, doorbell: Doorbell) -> Iterator[None]:
    """Ring `doorbell` whenever a job comes, in a thread, while the context lasts.

    The database may go away and come back meanwhile.
    """
    for name in _NOISY_LOGGERS:
        logging.getLogger(name).addFilter(_says_something_new)
    stopping: Future[None] = Future()
    ear = _Ear(database, doorbell, stopping)
    thread = threading.Thread(target=lambda: asyncio.run(ear.listen()), name="grader-news", daemon=True)
    thread.start()
    try:
        yield
    finally:
        stopping.set_result(None)
        thread.join(_END_S)


class _Ear:
    """Procrastinate's worker, begun again for as long as it is wanted."""

    def __init__(self, database: Database, doorbell: Doorbell, stopping: Future[None]) -> None:
        self._database = database
        self._doorbell = doorbell
        self._stopping = stopping
        self._arguments = _connect_arguments(database)

    async def listen(self) -> None:
        failures = 0
        while not self._stopping.done():
            try:
                await self._reach()
                failures = 0
                await self._take_jobs()
            except Exception as error:
                _log.warning("uploads are found by looking only: %s", _reason(error))
                await asyncio.sleep(_PAUSES_S[min(failures, len(_PAUSES_S) - 1)])
                failures += 1

    async def _reach(self) -> None:
        """Connect once: the pool below would try for half a minute, at growing intervals, before it says no."""
        connection = await psycopg.AsyncConnection.connect(**self._arguments)
        await connection.close()

    async def _take_jobs(self) -> None:
        """Run a worker until it fails, or is not wanted any more."""
        connector = PsycopgConnector(
            kwargs=self._arguments, min_size=1, max_size=NEWS_CONNECTIONS - 1, timeout=float(_CONNECT_S)
        )
        app = App(connector=connector)
        app.task(name=JOB_TASK, queue=JOB_QUEUE)(self._ring)
        await asyncio.to_thread(self._forget_old_news)
        async with app.open_async():
            worker = asyncio.create_task(
                app.run_worker_async(
                    queues=[JOB_QUEUE],
                    fetch_job_polling_interval=_POLL_S,
                    update_heartbeat_interval=_HEARTBEAT_S,
                    stalled_worker_timeout=_STALLED_S,
                    delete_jobs="always",
                    install_signal_handlers=False,
                )
            )
            await asyncio.wait(
                [worker, asyncio.wrap_future(self._stopping)], return_when=asyncio.FIRST_COMPLETED
            )
            worker.cancel()
            await asyncio.wait([worker])
            if not worker.cancelled() and (error := worker.exception()) is not None:
                raise error

    async def _ring(self) -> None:
        self._doorbell.ring_here()

    def _forget_old_news(self) -> None:
        """Delete what nobody took: all slots look now. Jobs that are being taken stay."""
        with suppress(InfrastructureError), self._database.writing(lasting=False) as session:
            session.execute(_FORGET)
        self._doorbell.ring_here()


def _says_something_new(record: logging.LogRecord) -> bool:
    return not (record.exc_info and isinstance(record.exc_info[1], ConnectorException))


def _connect_arguments(database: Database) -> dict[str, Any]:
    _, arguments = database.engine.dialect.create_connect_args(database.engine.url)
    arguments.pop("context", None)  # SQLAlchemy's own adapters
    return {**PATIENCE, "connect_timeout": _CONNECT_S, **arguments, "application_name": "grader news"}


def _reason(error: BaseException) -> str:
    while error.__cause__ is not None:
        error = error.__cause__
    return " ".join(str(error).split()) or type(error).__name__
