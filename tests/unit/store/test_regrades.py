"""What deciding about a re-grade does to the rows, and how much work it is."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import pytest
from sqlalchemy import event
from sqlmodel import SQLModel

from grader.contracts.regrade import Wanted
from grader.contracts.submission import NewSubmission
from grader.store.audit import Signature
from grader.store.database import Database
from grader.store.queue import Queue
from grader.store.regrades import Regrades
from tests.fakes.clock import FakeClock
from tests.fakes.grading import assignment
from tests.fakes.submissions import Submissions
from tests.unit.store.test_concurrency import result_of

GRADING_S = 2.0


def work(queue: Queue, clock: FakeClock) -> None:
    while (claim := queue.claim("w")) is not None:
        clock.advance(GRADING_S)
        assert queue.finish(claim, result_of(claim), assignment())


def graded(submissions: Submissions, queue: Queue, clock: FakeClock, number: int) -> list[str]:
    ids = []
    for student in range(number):
        new = NewSubmission(student=f"s{student}", assignment="square", file_name="a.py", source=b"good")
        ids.append(submissions.add(new).id)
    work(queue, clock)
    return ids


@contextmanager
def statements(database: Database) -> Iterator[list[str]]:
    """The statements that are executed meanwhile; the same one for many rows at once is one."""
    seen: list[str] = []

    def note(_connection: Any, _cursor: Any, statement: str, *_: Any) -> None:
        seen.append(statement)

    event.listen(database.engine, "before_cursor_execute", note)
    yield seen
    event.remove(database.engine, "before_cursor_execute", note)


@pytest.mark.parametrize("decision", ["apply", "discard"])
def test_deciding_takes_no_more_statements_for_more_trials(
    database: Database, queue: Queue, submissions: Submissions, clock: FakeClock, decision: str
) -> None:
    """On SQLite nobody hands in meanwhile."""
    regrades, signed, numbers = Regrades(database), Signature(clock(), None, "wang"), []
    for more in (2, 10):
        graded(submissions, queue, clock, more)
        opened = regrades.open(Wanted(assignment="square", which="all"), signed)
        work(queue, clock)
        with statements(database) as seen:
            getattr(regrades, decision)(opened.id, signed, "why")
        numbers.append(len(seen))
    assert numbers[0] == numbers[1]


def test_an_applied_regrade_does_not_look_like_a_slow_grading(
    database: Database, queue: Queue, submissions: Submissions, clock: FakeClock
) -> None:
    (id_,) = graded(submissions, queue, clock, 1)
    clock.advance(86_400)
    regrades, signed = Regrades(database), Signature(clock(), None, "wang")
    opened = regrades.open(Wanted(assignment="square", which="all"), signed)
    work(queue, clock)
    clock.advance(3_600)
    regrades.apply(opened.id, signed, "why")
    assert submissions.get(id_).graded_attempt == 2
    assert queue.mean_duration_s() == GRADING_S


def test_deleting_a_trial_does_not_read_whole_tables() -> None:
    """Databases look for rows that refer to a deleted one: in an index, or in all rows."""
    for table in SQLModel.metadata.tables.values():
        known = [next(iter(index.columns)).name for index in table.indexes]
        known.append(next(iter(table.primary_key.columns)).name)
        for key in table.foreign_key_constraints:
            if key.referred_table.name in {"submission", "grading"}:
                assert key.column_keys[0] in known, table.name
