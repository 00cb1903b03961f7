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


def said(engine: PostgresEngine) -> dict[str, Any]:
    """What the comment says of who made the tables."""
    with engine.database.reading() as session:
        comment = session.execute(text("SELECT obj_description('procrastinate_jobs'::regclass)")).scalar_one()
    return json.loads(comment)


def say(engine: PostgresEngine, comment: object) -> None:
    engine.change(
        f"COMMENT ON TABLE procrastinate_jobs IS '{json.dumps(comment).replace(':', chr(92) + ':')}'"
    )


def made_by_an_older_version(engine: PostgresEngine) -> dict[str, Any]:
    return {**said(engine), "version": "3.9.2", "schema": "0123456789abcdef"}


def test_tables_of_this_version_stay(own_server: PostgresEngine) -> None:
    own_server.upload()
    migrate(own_server.database)
    assert own_server.jobs() == 1


def test_tables_of_an_older_version_are_replaced_and_nothing_is_lost(own_server: PostgresEngine) -> None:
    id_ = own_server.upload()
    own_server.change("CREATE FUNCTION procrastinate_old() RETURNS int LANGUAGE sql AS 'SELECT 1'")
    older, now = made_by_an_older_version(own_server), said(own_server)
    older["objects"].append(["FUNCTION", "procrastinate_old()"])
    say(own_server, older)
    migrate(own_server.database)
    assert said(own_server) == now
    assert own_server.jobs() == 0
    assert own_server.graded_in_order() == [id_]
    with pytest.raises(ProgrammingError, match="procrastinate_old"):
        own_server.change("SELECT procrastinate_old()")


def test_what_somebody_else_made_stays_whatever_it_is_called(own_server: PostgresEngine) -> None:
    body = "SELECT kept FROM procrastinate_archive"
    theirs = [
        "CREATE TABLE procrastinate_archive AS SELECT 7 AS kept",
        "CREATE TYPE procrastinate_archive_kind AS ENUM ('a')",
        f"CREATE FUNCTION procrastinate_archived() RETURNS int LANGUAGE sql AS '{body}'",
    ]
    for one in theirs:
        own_server.change(one)
    say(own_server, made_by_an_older_version(own_server))
    migrate(own_server.database)
    with own_server.database.reading() as session:
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
    own_server: PostgresEngine, changes: dict[str, str] | None, told: str
) -> None:
    own_server.upload()
    say(own_server, changes and {**made_by_an_older_version(own_server), **changes})
    with pytest.raises(SettingsError, match=told):
        migrate(own_server.database)
    assert own_server.jobs() == 1


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
