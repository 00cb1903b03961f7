"""Statements that are sent together are one transaction with the others, on both engines, also when they fail."""

import socket
from collections.abc import Iterator
from contextlib import contextmanager
from unittest.mock import MagicMock, call

import psycopg
import pytest
from sqlalchemy import Connection, event, text

from grader.contracts.errors import InfrastructureError
from grader.store.locks import one_at_a_time
from grader.store.together import together
from tests.fakes.engines import Engine, PostgresEngine


def trouble(engine: Engine) -> set[str]:
    with engine.database.reading() as session:
        return set(session.execute(text("SELECT trouble FROM submission")).scalars())


QUICK = pytest.mark.parametrize("quick", [False, True], ids=["", "quick"])
WAYS = pytest.mark.parametrize("way", ["", "quick", "last"])


@contextmanager
def changing(engine: Engine, way: str) -> Iterator[Connection]:
    if way == "last":
        with engine.database.changing() as connection, together(connection, last=True):
            yield connection
    else:
        with engine.database.writing(quick=way == "quick") as session, together(session.connection()):
            yield session.connection()


def change(engine: Engine, way: str, *statements: str) -> None:
    with changing(engine, way) as connection:
        for statement in statements:
            connection.execute(text(statement))


@QUICK
def test_what_was_sent_together_is_there(engine: Engine, quick: bool) -> None:
    engine.upload()
    with engine.database.writing(quick=quick) as session:
        with together(session.connection()):
            session.execute(text("UPDATE submission SET trouble = 'one'"))
            session.execute(text("UPDATE submission SET trouble = trouble || ' two'"))
        assert session.execute(text("SELECT trouble FROM submission")).scalar_one() == "one two"
    assert trouble(engine) == {"one two"}


@pytest.mark.parametrize("way", ["quick", "last"])
def test_what_was_sent_last_is_committed_and_nobody_elses_work(engine: Engine, way: str) -> None:
    engine.upload()
    change(engine, way, "UPDATE submission SET trouble = 'one'")
    for quick in (True, False):
        with pytest.raises(ZeroDivisionError), engine.database.writing(quick=quick) as session:  # noqa: PT012
            session.execute(text("UPDATE submission SET trouble = 'lost'"))
            raise ZeroDivisionError
    assert trouble(engine) == {"one"}


def test_an_upload_costs_few_statements_and_two_ways_to_the_server(
    engine: Engine, monkeypatch: pytest.MonkeyPatch
) -> None:
    engine.upload("s1")
    sent: list[str] = []
    waited: list[psycopg.Pipeline] = []
    wait = psycopg.Pipeline.sync

    def note(_connection: object, _cursor: object, statement: str, *_: object) -> None:
        sent.append(statement)

    def waiting(pipeline: psycopg.Pipeline) -> None:
        waited.append(pipeline)
        wait(pipeline)

    event.listen(engine.database.engine, "before_cursor_execute", note)
    monkeypatch.setattr(psycopg.Pipeline, "sync", waiting)
    engine.upload("s2")
    told = [" ".join(one.split()[:3]) for one in sent]
    alone, known, *stored = told
    assert alone.startswith(("BEGIN IMMEDIATE", "SELECT pg_advisory_xact_lock"))
    assert known.startswith("SELECT upload_key")  # and all else that decides about an upload
    permit = [] if engine.database.is_sqlite else ["INSERT INTO procrastinate_jobs"]
    assert stored == ["INSERT INTO source", "INSERT INTO submission", *permit]
    assert len(waited) == (0 if engine.database.is_sqlite else 1)  # the other way is the commit


def test_nothing_is_kept_back_that_an_answer_is_waited_for(
    permits: PostgresEngine, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The driver waits until its transaction has begun; over a network what it sent stayed here for 0.2 s."""
    wire = MagicMock(spec=socket.socket)
    wire.__enter__.return_value = wire
    monkeypatch.setattr(socket, "fromfd", lambda *_: wire)
    kept = [call(socket.IPPROTO_TCP, socket.TCP_CORK, value) for value in (1, 0)]
    with permits.database.writing() as session:
        one_at_a_time(session, "first")
        assert wire.setsockopt.mock_calls == []
        one_at_a_time(session, "second")
        assert wire.setsockopt.mock_calls == kept


def test_what_a_system_cannot_keep_back_is_sent_at_once(
    permits: PostgresEngine, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delattr(socket, "TCP_CORK")  # as on macOS
    with permits.database.writing() as session:
        one_at_a_time(session, "first")
        one_at_a_time(session, "second")


@WAYS
@pytest.mark.parametrize(
    "mishap",
    [
        ("SELECT pg_terminate_backend(pg_backend_pid())",),
        ("SET LOCAL statement_timeout = 1", "SELECT pg_sleep(9)"),
        ("DO 'BEGIN RAISE SQLSTATE ''25P03''; END'",),
    ],
    ids=["connection ended", "too slow", "idle for too long"],
)
def test_a_server_that_fails_meanwhile_is_said_not_to_answer(
    permits: PostgresEngine, mishap: tuple[str, ...], way: str
) -> None:
    permits.upload()
    with pytest.raises(InfrastructureError, match="does not answer"):
        change(permits, way, "UPDATE submission SET trouble = 'lost'", *mishap)
    assert trouble(permits) == {""}


@WAYS
def test_a_statement_that_is_wrong_undoes_the_others(permits: PostgresEngine, way: str) -> None:
    permits.upload()
    with pytest.raises(psycopg.errors.CheckViolation):
        change(
            permits,
            way,
            "UPDATE submission SET trouble = 'lost'",
            "UPDATE submission SET state = 'elsewhere'",
        )
    assert trouble(permits) == {""}
