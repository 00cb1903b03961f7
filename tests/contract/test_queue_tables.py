"""Procrastinate's tables come, stay and go with its version."""

import os
import threading

import pytest
import sqlalchemy

from grader.contracts.errors import SettingsError
from grader.store.database import Database
from grader.store.schema import migrate
from tests.fakes.engines import PostgresEngine
from tests.fakes.postgres import PostgresServer


def comment(permits: PostgresEngine, text: str) -> None:
    permits.change(f"COMMENT ON TABLE procrastinate_jobs IS {text}")


def test_tables_of_this_version_stay(own_permits: PostgresEngine) -> None:
    own_permits.upload()
    migrate(own_permits.database)
    assert own_permits.jobs() == 1


def test_tables_of_an_older_version_are_replaced_and_nothing_is_lost(own_permits: PostgresEngine) -> None:
    id_ = own_permits.upload()
    comment(own_permits, "'grader 3.9.2 0123456789abcdef'")
    own_permits.change("CREATE FUNCTION procrastinate_old() RETURNS int LANGUAGE sql AS 'SELECT 1'")
    migrate(own_permits.database)
    assert own_permits.jobs() == 0
    own_permits.clock.advance(5.1)
    assert own_permits.queue.reconcile().announced == 1
    assert own_permits.graded_in_order() == [id_]
    with pytest.raises(sqlalchemy.exc.ProgrammingError, match="procrastinate_old"):
        own_permits.change("SELECT procrastinate_old()")


@pytest.mark.parametrize(
    ("found", "said"), [("'grader 99.1.0 0123456789abcdef'", "99.1.0"), ("NULL", "its own database")]
)
def test_tables_of_a_newer_version_or_of_others_are_left_alone(
    own_permits: PostgresEngine, found: str, said: str
) -> None:
    own_permits.upload()
    comment(own_permits, found)
    with pytest.raises(SettingsError, match=said):
        migrate(own_permits.database)
    assert own_permits.jobs() == 1


def test_processes_that_start_at_once_create_them_once(postgres_server: PostgresServer) -> None:
    name = f"new_{os.getpid()}"
    url = postgres_server.create(name, empty=True)
    failures: list[Exception] = []

    def start() -> None:
        database = Database(url)
        try:
            migrate(database)
        except Exception as error:
            failures.append(error)
        finally:
            database.close()

    threads = [threading.Thread(target=start) for _ in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert failures == []
    engine = PostgresEngine(url)
    engine.upload()
    assert engine.jobs() == 1
    engine.database.close()
    postgres_server.drop(name)
