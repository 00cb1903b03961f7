"""Who is explained when, and what is kept of it."""

from collections.abc import Callable
from dataclasses import replace
from datetime import timedelta

import pytest
from sqlalchemy import select
from sqlmodel import col

from grader.contracts.explanation import ChangedText, Explanation, ProvenChange
from grader.contracts.grading import GradingJob, GradingResult
from grader.contracts.submission import NewSubmission
from grader.contracts.text import Text
from grader.store.database import Database
from grader.store.explanations import LEASE_S, MOST_BYTES, Explanations
from grader.store.queue import Queue
from grader.store.tables import GradedMistakeRow
from tests.fakes.clock import FakeClock
from tests.fakes.grading import FakeAssignments, grade, grade_next
from tests.fakes.submissions import Submissions

CHANGE = ProvenChange(
    code="scaled",
    text=Text(zh="写 2", en="write 2"),
    lines=(ChangedText(number=1, before="1", after="2"),),
    before=5.0,
    after=10.0,
    gains=("closed",),
)


@pytest.fixture
def explanations(database: Database, clock: FakeClock) -> Explanations:
    return Explanations(database, clock)


@pytest.fixture
def graded(queue: Queue, submissions: Submissions, clock: FakeClock) -> Callable[..., str]:
    """Hands a script in and has it graded; returns its id."""

    def hand_in(
        source: bytes, student: str = "s1", grading: Callable[[GradingJob], GradingResult] = grade
    ) -> str:
        new = NewSubmission(student=student, assignment="square", file_name="square.py", source=source)
        added = submissions.add(new)
        assert grade_next(queue, FakeAssignments(), grading)
        clock.advance(1.0)
        return added.id

    return hand_in


def test_what_lacks_marks_is_explained_once(explanations: Explanations, graded: Callable[..., str]) -> None:
    graded(b"good good")  # full marks
    id_ = graded(b"good")
    claim = explanations.claim()
    assert claim is not None
    assert (claim.submission_id, claim.attempt, claim.tries) == (id_, 1, 1)
    assert (claim.source, claim.assignment.id) == (b"good", "square")
    assert explanations.claim() is None
    assert explanations.of(id_, 1) is None
    assert explanations.finish(claim, Explanation(changes=(CHANGE,), tried=3), 0.5)
    assert explanations.of(id_, 1) == Explanation(changes=(CHANGE,), tried=3)
    assert explanations.claim() is None


def test_a_claim_that_passed_is_void(
    explanations: Explanations, graded: Callable[..., str], clock: FakeClock
) -> None:
    id_ = graded(b"good")
    first = explanations.claim()
    assert first is not None
    assert explanations.renew(first)
    clock.advance(LEASE_S + 1.0)
    second = explanations.claim()
    assert second is not None
    assert second.tries == 2
    assert not explanations.renew(first)
    assert not explanations.finish(first, Explanation(changes=(CHANGE,)), 0.5)
    assert explanations.of(id_, 1) is None


def test_students_take_turns(
    explanations: Explanations, graded: Callable[..., str], clock: FakeClock
) -> None:
    own = [graded(b"good  # %d" % number, "many") for number in range(3)]
    other = graded(b"good", "one")

    def explained() -> str:
        claim = explanations.claim()
        assert claim is not None
        explanations.finish(claim, Explanation(), 20.0)
        return claim.submission_id

    assert [explained() for _ in range(4)] == [own[0], other, own[1], own[2]]
    clock.advance(60.0)
    late, first = graded(b"good  # again", "many"), graded(b"good", "new")
    assert [explained(), explained()] == [first, late]  # an hour of looking puts nobody behind for longer
    clock.advance(timedelta(hours=1).total_seconds())
    again, last = graded(b"good  # later", "many"), graded(b"good  # later", "new")
    assert [explained(), explained()] == [again, last]


def test_what_is_looked_for_counts_as_work_of_the_student(
    explanations: Explanations, graded: Callable[..., str], queue: Queue, submissions: Submissions
) -> None:
    graded(b"good", "many")
    claim = explanations.claim()
    assert claim is not None
    explanations.finish(claim, Explanation(), 2.0)
    for student in ("many", "one"):
        submissions.add(
            NewSubmission(student=student, assignment="square", file_name="square.py", source=b"good  # next")
        )
    order = [queue.claim("w"), queue.claim("w")]
    assert [None if one is None else submissions.get(one.submission_id).student for one in order] == [  # type: ignore[union-attr]
        "one",
        "many",
    ]


def test_one_that_is_asked_for_anew_is_thrown_away(
    explanations: Explanations, graded: Callable[..., str]
) -> None:
    id_ = graded(b"good")
    claim = explanations.claim()
    assert claim is not None
    explanations.ask(id_, 1)  # is looked for already: that goes on
    assert explanations.finish(claim, Explanation(changes=(CHANGE,)), 0.5)
    explanations.ask(id_, 1)
    assert explanations.of(id_, 1) is None
    again = explanations.claim()
    assert again is not None
    assert again.tries == 1


@pytest.mark.parametrize("recognised", [("one_radian",), ()])
def test_the_class_counts_a_change_only_where_the_report_names_no_mistake(
    database: Database, explanations: Explanations, graded: Callable[..., str], recognised: tuple[str, ...]
) -> None:
    """Else forty of one mistake stand in two rows: those that are explained, and those that wait."""

    def grading(job: GradingJob) -> GradingResult:
        result = grade(job)
        return replace(result, report=replace(result.report, mistakes=recognised))

    id_ = graded(b"good", grading=grading)
    for change in (CHANGE, replace(CHANGE, code="count")):  # the second is looked for anew
        claim = explanations.claim()
        assert claim is not None
        assert explanations.finish(claim, Explanation(changes=(change,)), 0.5)
        with database.reading() as session:
            of = col(GradedMistakeRow.submission_id) == id_
            codes = session.execute(select(col(GradedMistakeRow.code)).where(of)).scalars().all()
        assert tuple(codes) == (recognised or (f"change.{change.code}",))
        explanations.ask(id_, 1)


def test_one_that_is_too_long_is_not_kept(explanations: Explanations, graded: Callable[..., str]) -> None:
    id_ = graded(b"good")
    claim = explanations.claim()
    assert claim is not None
    long = replace(CHANGE, lines=(ChangedText(number=1, before="1" * MOST_BYTES, after=None),))
    assert explanations.finish(claim, Explanation(changes=(long,), tried=3, hidden=("closed",)), 0.5)
    assert explanations.of(id_, 1) == Explanation(tried=3, hidden=("closed",))
