"""Who works with a PostgreSQL database keeps others from replacing it; files are in `tests/unit/commands`."""

import os
import threading
from collections.abc import Iterator

import pytest

from grader.contracts.errors import InfrastructureError, SettingsError
from grader.store.database import Database
from grader.store.occupancy import OccupiedError, Sole, alone, in_use
from tests.fakes.postgres import PostgresServer
from tests.fakes.waiting import PATIENCE_S, wait_until


@pytest.fixture
def administrator(postgres_url: str) -> Iterator[Database]:
    """The same database, as another process opens it."""
    opened = Database(postgres_url)
    yield opened
    opened.close()


def used(database: Database) -> None:
    with database.reading() as session:
        session.connection()


def may_be_alone(database: Database) -> bool:
    try:
        with alone(database):
            return True
    except OccupiedError:
        return False


def test_who_works_with_a_database_is_named(postgres_database: Database, administrator: Database) -> None:
    with in_use(postgres_database, "grader serve"):
        used(postgres_database)
        with (
            pytest.raises(SettingsError, match=rf"grader serve, process {os.getpid()} on .*: stop it first"),
            alone(administrator),
        ):
            pass
    wait_until(lambda: may_be_alone(administrator))  # a server notices a little later that a connection ended


def test_one_that_lost_every_connection_keeps_others_away_with_the_next(
    postgres_database: Database, administrator: Database, postgres_server: PostgresServer
) -> None:
    with in_use(postgres_database):
        postgres_server.disconnect()
        used(postgres_database)
        with pytest.raises(SettingsError, match="stop it first"), alone(administrator):
            pass


def test_who_comes_while_a_database_is_replaced_waits(
    postgres_database: Database, administrator: Database, caplog: pytest.LogCaptureFixture
) -> None:
    entered = threading.Event()

    def enter() -> None:
        with in_use(postgres_database):
            entered.set()

    with alone(administrator):
        thread = threading.Thread(target=enter)
        thread.start()
        assert not entered.wait(0.1)
    assert entered.wait(PATIENCE_S)
    thread.join()
    assert len(caplog.records) <= 1


def test_whose_connections_broke_meanwhile_gets_no_new_one(
    postgres_database: Database, administrator: Database, postgres_server: PostgresServer
) -> None:
    with in_use(postgres_database):
        postgres_server.disconnect()
        with alone(administrator), pytest.raises(InfrastructureError, match="is being replaced"):
            used(postgres_database)
        used(postgres_database)


def test_one_at_a_time_may_be_alone(postgres_database: Database, administrator: Database) -> None:
    with (
        alone(postgres_database),
        pytest.raises(SettingsError, match="grader db, process"),
        alone(administrator),
    ):
        pass


def test_who_worked_with_a_database_leaves_nothing_behind_for_its_next_connections(
    postgres_database: Database,
) -> None:
    """Else who waits overnight for an upgrade would look ever more slowly."""
    before = len(postgres_database.engine.pool.dispatch.connect)
    for _ in range(2):
        with in_use(postgres_database):
            pass
    assert len(postgres_database.engine.pool.dispatch.connect) == before


def test_what_one_process_alone_may_have_passes_on_when_it_ends(database: Database) -> None:
    other_database = Database(database.engine.url.render_as_string(hide_password=False))
    first, other = Sole(database), Sole(other_database)
    assert [first.is_mine(), other.is_mine(), first.is_mine(), other.is_mine()] == [True, False, True, False]
    first.close()
    assert [other.is_mine(), first.is_mine()] == [True, False]
    other.close()
    first.close()
    other_database.close()


def test_what_one_process_alone_may_have_is_taken_again_after_an_outage(
    postgres_database: Database, postgres_server: PostgresServer
) -> None:
    one = Sole(postgres_database)
    assert one.is_mine()
    postgres_server.disconnect()
    with pytest.raises(InfrastructureError):
        one.is_mine()
    assert one.is_mine()
    one.close()
