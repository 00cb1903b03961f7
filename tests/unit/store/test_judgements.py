"""What waits for a person around one submission, on both databases."""

from datetime import timedelta

import pytest

from grader.contracts.grading import GradingJob
from grader.contracts.submission import NewSubmission, Submission
from grader.store.audit import Signature
from grader.store.database import Database
from grader.store.judgements import Given, Judgements, Neighbours, WaitingFor
from grader.store.queue import Queue
from tests.fakes.clock import FakeClock
from tests.fakes.essays import ANSWER, grade_essay, question
from tests.fakes.submissions import Submissions

TIMER = WaitingFor(assignment="essay", item="timer")


@pytest.fixture
def essays(submissions: Submissions, queue: Queue, clock: FakeClock) -> list[Submission]:
    """Four graded essays in order of arrival; the second and the third arrived at the same instant."""
    added = []
    for number, pause_s in enumerate((0, 1, 0, 1)):
        clock.advance(pause_s)
        source = ANSWER + str(number).encode()
        essay = NewSubmission(
            course=None, student=f"s{number}", assignment="essay", file_name="a.txt", source=source
        )
        added.append(submissions.add(essay))
        queue.finish(
            queue.claim("w"),
            grade_essay(GradingJob(file_name="a.txt", source=source, assignment=question())),
            question(),
        )
    return sorted(added, key=lambda one: (one.received_at, one.id))


def around(database: Database, one: Submission) -> Neighbours:
    return Judgements(database).around(None, TIMER, one.id, one.received_at)


def test_neighbours_are_the_ones_beside_it_and_the_last_leads_to_the_first(
    database: Database, essays: list[Submission]
) -> None:
    assert essays[1].received_at == essays[2].received_at
    ids = [one.id for one in essays]
    found = [around(database, one) for one in essays]
    assert [one.previous for one in found] == [None, *ids[:3]]
    assert [one.next for one in found] == [*ids[1:], ids[0]]
    assert {one.waiting for one in found} == {4}


def test_what_is_judged_leads_on_to_what_waits(
    database: Database, essays: list[Submission], clock: FakeClock
) -> None:
    signed = Signature(clock() + timedelta(seconds=1), None, "wang")
    first, second, third, last = essays
    for one in (second, last):
        given = Given(item="timer", points=1.0, comment="")
        Judgements(database).judge_all(one.id, [(given, None)], signed)
    assert around(database, second) == Neighbours(previous=first.id, next=third.id, waiting=2)
    assert around(database, third) == Neighbours(previous=first.id, next=first.id, waiting=2)
    assert around(database, last) == Neighbours(previous=third.id, next=first.id, waiting=2)
    for one in (first, third):
        Judgements(database).judge_all(one.id, [(given, None)], signed)
    assert around(database, last) == Neighbours(previous=None, next=None, waiting=0)
