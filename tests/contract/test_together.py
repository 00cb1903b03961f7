"""Statements that are sent together are one transaction with the others, on both engines, also when they fail."""

import psycopg
import pytest
from sqlalchemy import event, text

from grader.contracts.errors import InfrastructureError
from grader.store.together import together
from tests.fakes.engines import Engine, PostgresEngine


def trouble(engine: Engine) -> set[str]:
    with engine.database.reading() as session:
        return set(session.execute(text("SELECT trouble FROM submission")).scalars())


def change(engine: Engine, *statements: str) -> None:
    with engine.database.writing() as session, together(session.connection()):
        for statement in statements:
            session.execute(text(statement))


def test_what_was_sent_together_is_there(engine: Engine) -> None:
    engine.upload()
    with engine.database.writing() as session:
        with together(session.connection()):
            session.execute(text("UPDATE submission SET trouble = 'one'"))
            session.execute(text("UPDATE submission SET trouble = trouble || ' two'"))
        assert session.execute(text("SELECT trouble FROM submission")).scalar_one() == "one two"
    assert trouble(engine) == {"one two"}


def test_an_upload_costs_few_statements_besides_its_permit(engine: Engine) -> None:
    engine.upload("s1")
    sent: list[str] = []

    def note(_connection: object, _cursor: object, statement: str, *_: object) -> None:
        sent.append(statement)

    event.listen(engine.database.engine, "before_cursor_execute", note)
    engine.upload("s2")
    told = [" ".join(one.split()[:3]) for one in sent]
    assert len(told) == 4, told  # alone, what there is of the student, the source, the submission
    assert told[2:] == ["INSERT INTO source", "INSERT INTO submission"]


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
    permits: PostgresEngine, mishap: tuple[str, ...]
) -> None:
    permits.upload()
    with pytest.raises(InfrastructureError, match="does not answer"):
        change(permits, "UPDATE submission SET trouble = 'lost'", *mishap)
    assert trouble(permits) == {""}


def test_a_statement_that_is_wrong_undoes_the_others(permits: PostgresEngine) -> None:
    permits.upload()
    with pytest.raises(psycopg.errors.CheckViolation):
        change(
            permits,
            "UPDATE submission SET trouble = 'lost'",
            "UPDATE submission SET state = 'elsewhere'",
        )
    assert trouble(permits) == {""}
