"""Connections that cannot be made, break, are too many, or may only read."""

import sys
from traceback import format_exception

import psycopg
import pytest

from grader.contracts.errors import InfrastructureError, SettingsError
from grader.store import database as store_database
from grader.store.database import Database
from grader.store.jobs import news
from tests.fakes.clock import FakeClock
from tests.fakes.postgres import PostgresServer
from tests.fakes.submissions import Submissions


@pytest.mark.parametrize(
    "url",
    [
        "sqlite:////no/such/folder/grader.db",
        "postgresql+psycopg://grader:3q9fKx72@/grader?host=/no/such/folder",
        "postgresql+psycopg://grader:3q9fKx72@127.0.0.1:1/grader",
    ],
)
def test_an_unreachable_database_is_an_infrastructure_fault(url: str) -> None:
    unreachable = Database(url)
    with pytest.raises(InfrastructureError, match="database") as caught, unreachable.reading() as session:
        session.connection().exec_driver_sql("SELECT 1")
    assert "3q9fKx72" not in f"{caught.value!r} {unreachable.name} {''.join(format_exception(caught.value))}"
    unreachable.close()


def test_a_server_that_vanished_without_a_word_is_noticed_within_half_a_minute(postgres_url: str) -> None:
    """By the store and by who hears of uploads, unless the address says otherwise."""
    patient = Database(f"{postgres_url}{'&' if '?' in postgres_url else '?'}keepalives_idle=77")
    with patient.reading() as session:
        store = session.connection().connection.driver_connection.info.get_parameters()
    patient.close()
    for told in (store, news._connect_arguments(patient)):
        waits_s = int(told["keepalives_interval"]) * int(told["keepalives_count"])
        assert (str(told["keepalives_idle"]), waits_s) == ("77", 15)
        assert waits_s < int(told["tcp_user_timeout"]) / 1_000 < 30


def test_a_server_that_restarted_fails_no_request(
    postgres_database: Database, postgres_server: PostgresServer
) -> None:
    submissions = Submissions(postgres_database, FakeClock())
    with postgres_database.reading(), postgres_database.reading():
        pass  # two connections wait in the pool
    postgres_server.disconnect()
    assert submissions.get("none") is None
    assert submissions.get("none") is None


@pytest.mark.parametrize(("long_idle_s", "asked"), [(3_600.0, False), (0.0, True)])
def test_only_a_connection_that_rested_for_long_is_tried_before_use(
    postgres_database: Database, monkeypatch: pytest.MonkeyPatch, long_idle_s: float, asked: bool
) -> None:
    tried: list[object] = []

    def answer(connection: object) -> bool:
        tried.append(connection)
        return True

    monkeypatch.setattr(store_database, "_LONG_IDLE_S", long_idle_s)
    monkeypatch.setattr(postgres_database.engine.dialect, "do_ping", answer)
    for _ in range(2):
        assert Submissions(postgres_database, FakeClock()).get("none") is None
    assert bool(tried) is asked


def test_a_connection_that_answers_no_more_is_replaced(
    postgres_database: Database, monkeypatch: pytest.MonkeyPatch
) -> None:
    dialect = postgres_database.engine.dialect
    tried: list[object] = []

    def fail(connection: object) -> bool:
        tried.append(connection)
        raise psycopg.OperationalError("the network forgot it")

    with postgres_database.reading() as session:
        session.connection().exec_driver_sql("SELECT 1")
    monkeypatch.setattr(store_database, "_LONG_IDLE_S", 0.0)
    monkeypatch.setattr(dialect, "do_ping", fail)
    with postgres_database.reading() as session:
        assert session.connection().connection.driver_connection not in tried
    assert len(tried) == 1


@pytest.mark.parametrize("again", [True, False], ids=["amid it", "at its end"])
def test_a_connection_that_breaks_in_a_transaction_is_an_infrastructure_fault(
    postgres_database: Database,
    postgres_server: PostgresServer,
    caplog: pytest.LogCaptureFixture,
    *,
    again: bool,
) -> None:
    with pytest.raises(InfrastructureError), postgres_database.writing() as session:  # noqa: PT012
        session.connection().exec_driver_sql("SELECT 1")
        postgres_server.disconnect()
        if again:
            session.connection().exec_driver_sql("SELECT 1")
    assert "psycopg" not in caplog.text  # one error says it all
    assert Submissions(postgres_database, FakeClock()).get("none") is None


@pytest.mark.parametrize(
    "mishap",
    [
        "SET LOCAL statement_timeout = 1; SELECT pg_sleep(9)",
        "DO 'BEGIN RAISE SQLSTATE ''25P03''; END'",
    ],
    ids=["too slow", "idle for too long"],
)
def test_a_server_that_gives_up_a_transaction_is_an_infrastructure_fault(
    postgres_database: Database, mishap: str
) -> None:
    with pytest.raises(InfrastructureError, match="does not answer"), postgres_database.writing() as session:  # noqa: PT012
        session.connection().exec_driver_sql("INSERT INTO source VALUES ('abc', '')")
        session.connection().exec_driver_sql(mishap)
    with postgres_database.reading() as session:
        assert session.connection().exec_driver_sql("SELECT count(*) FROM source").scalar_one() == 0


def test_a_process_has_as_many_connections_as_it_may(postgres_url: str) -> None:
    database = Database(postgres_url, connections=3)
    held = [database.engine.connect() for _ in range(3)]
    assert (database.engine.pool.size(), database.engine.pool.overflow()) == (3, 0)
    for connection in held:
        connection.close()
    database.close()


def test_a_server_that_takes_no_writes_is_an_infrastructure_fault(postgres_database: Database) -> None:
    """Such as the old one after another has taken its place."""
    with pytest.raises(InfrastructureError, match="read-only"), postgres_database.writing() as session:  # noqa: PT012
        session.connection().exec_driver_sql("SET TRANSACTION READ ONLY")
        session.connection().exec_driver_sql("DELETE FROM submission")


def test_without_its_driver_postgresql_is_refused_readably(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "psycopg", None)
    with pytest.raises(SettingsError, match="extra 'postgres'"):
        Database("postgresql+psycopg://localhost/grader")
