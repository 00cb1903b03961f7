"""Procrastinate's tables come, stay and go with its version."""

import json
import os
import threading
from typing import Any

import pytest
from sqlalchemy import text
from sqlalchemy.exc import ProgrammingError

from grader.contracts.errors import SettingsError
from grader.store.database import Database
from grader.store.schema import migrate
from tests.fakes.engines import PostgresEngine
from tests.fakes.postgres import PostgresServer


def said(permits: PostgresEngine) -> dict[str, Any]:
    """What the comment says of who made the tables."""
    with permits.database.reading() as session:
        comment = session.execute(text("SELECT obj_description('procrastinate_jobs'::regclass)")).scalar_one()
    return json.loads(comment)


def say(permits: PostgresEngine, comment: object) -> None:
    permits.change(
        f"COMMENT ON TABLE procrastinate_jobs IS '{json.dumps(comment).replace(':', chr(92) + ':')}'"
    )


def made_by_an_older_version(permits: PostgresEngine) -> dict[str, Any]:
    return {**said(permits), "version": "3.9.2", "schema": "0123456789abcdef"}


def test_tables_of_this_version_stay(own_permits: PostgresEngine) -> None:
    own_permits.upload()
    migrate(own_permits.database)
    assert own_permits.jobs() == 1


def test_tables_of_an_older_version_are_replaced_and_nothing_is_lost(own_permits: PostgresEngine) -> None:
    id_ = own_permits.upload()
    own_permits.change("CREATE FUNCTION procrastinate_old() RETURNS int LANGUAGE sql AS 'SELECT 1'")
    older, now = made_by_an_older_version(own_permits), said(own_permits)
    older["objects"].append(["FUNCTION", "procrastinate_old()"])
    say(own_permits, older)
    migrate(own_permits.database)
    assert said(own_permits) == now
    assert own_permits.jobs() == 0
    own_permits.clock.advance(5.1)
    assert own_permits.queue.reconcile().announced == 1
    assert own_permits.graded_in_order() == [id_]
    with pytest.raises(ProgrammingError, match="procrastinate_old"):
        own_permits.change("SELECT procrastinate_old()")


def test_what_somebody_else_made_stays_whatever_it_is_called(own_permits: PostgresEngine) -> None:
    body = "SELECT kept FROM procrastinate_archive"
    theirs = [
        "CREATE TABLE procrastinate_archive AS SELECT 7 AS kept",
        "CREATE TYPE procrastinate_archive_kind AS ENUM ('a')",
        f"CREATE FUNCTION procrastinate_archived() RETURNS int LANGUAGE sql AS '{body}'",
    ]
    for one in theirs:
        own_permits.change(one)
    say(own_permits, made_by_an_older_version(own_permits))
    migrate(own_permits.database)
    with own_permits.database.reading() as session:
        found = session.execute(text("SELECT procrastinate_archived(), 'a'\\:\\:procrastinate_archive_kind"))
        assert found.one() == (7, "a")


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"version": "99.1.0"}, "99.1.0"),
        ({"maker": "another"}, "its own database"),
        (None, "its own database"),
    ],
)
def test_tables_of_a_newer_version_or_of_others_are_left_alone(
    own_permits: PostgresEngine, changes: dict[str, str] | None, told: str
) -> None:
    own_permits.upload()
    say(own_permits, changes and {**made_by_an_older_version(own_permits), **changes})
    with pytest.raises(SettingsError, match=told):
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
