"""Undoing a re-grade: the gradings from before it stand again, with what people judged."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import pytest

from grader.contracts.errors import RefusedError
from grader.contracts.grading import GradingJob
from grader.contracts.identity import Seen
from grader.contracts.regrade import Regrade, Wanted, Which
from grader.contracts.submission import NewSubmission, Submission
from grader.store.audit import Signature
from grader.store.database import Database
from grader.store.judgements import Given, Judgements
from grader.store.queue import Queue
from grader.store.regrades import Regrades
from tests.fakes.clock import FakeClock
from tests.fakes.grading import assignment, grade
from tests.fakes.submissions import Submissions

STRICTER = replace(assignment(), version=4)


@dataclass
class World:
    """A submission that earned 5 of 10 points, and what may happen to it."""

    submissions: Submissions
    queue: Queue
    regrades: Regrades
    judgements: Judgements
    clock: FakeClock
    id: str = ""

    @property
    def signed(self) -> Signature:
        self.clock.advance(1)
        return Signature(self.clock(), None, "wang")

    @property
    def now(self) -> Submission:
        found = self.submissions.get(self.id)
        assert found is not None
        return found

    def work(self, source: bytes) -> None:
        """Grade what waits as if `source` had been handed in."""
        while (claim := self.queue.claim("w")) is not None:
            job = GradingJob(file_name=claim.file_name, source=source, assignment=STRICTER)
            assert self.queue.finish(claim, grade(job), STRICTER)

    def regrade(self, source: bytes, which: Which = "all") -> Regrade:
        opened = self.regrades.open(Wanted(assignment="square", which=which), self.signed)
        self.work(source)
        return self.regrades.apply(opened.id, self.signed, "why")

    def undo(self, regrade: Regrade) -> Regrade:
        return self.regrades.undo(regrade.id, self.signed, "a mistake")

    def correct(self, points: float) -> None:
        given = Given(item="closed", points=points, comment="seen", corrects=True)
        self.judgements.judge_all(self.id, [(given, Seen(None))], self.signed)


@pytest.fixture
def world(database: Database, queue: Queue, submissions: Submissions, clock: FakeClock) -> World:
    made = World(submissions, queue, Regrades(database), Judgements(database), clock)
    new = NewSubmission(student="li", assignment="square", file_name="a.py", source=b"good")
    made.id = submissions.add(new).id
    made.work(b"good")
    return made


def refused(act: Callable[[], object]) -> str:
    with pytest.raises(RefusedError) as error:
        act()
    return error.value.code


def test_the_grading_from_before_stands_again(world: World, database: Database) -> None:
    before = world.now
    applied = world.regrade(b"good good")
    assert world.now.score == 10.0
    undone = world.undo(applied)
    assert (undone.state, undone.undone_by, undone.undone_reason, undone.reason) == (
        "undone", "wang", "a mistake", "why",
    )  # fmt: skip
    after = world.now
    assert (after.score, after.verdict, after.report_sha256) == (5.0, before.verdict, before.report_sha256)
    assert [one.stands for one in world.regrades.history(world.id)] == [True, False]
    apply_told, undo_told = reversed(world.regrades.changes_of(world.id))
    assert (apply_told.undone, apply_told.change.before, apply_told.change.after) == (False, 5.0, 10.0)
    assert (undo_told.undone, undo_told.change.before, undo_told.change.after) == (True, 10.0, 5.0)
    assert [(one.item, one.before, one.after) for one in undo_told.change.items] == [("closed", 5.0, 0.0)]
    assert (undo_told.reason, apply_told.reason) == ("a mistake", "why")
    assert refused(lambda: world.undo(applied)) == "regrade_not_applied"


def test_only_what_stands_can_be_undone(world: World, database: Database) -> None:
    opened = world.regrades.open(Wanted(assignment="square"), world.signed)
    assert refused(lambda: world.undo(opened)) == "regrade_not_applied"
    world.regrades.discard(opened.id, world.signed, "x")
    assert refused(lambda: world.undo(opened)) == "regrade_not_applied"
    first, second = world.regrade(b"good good"), world.regrade(b"bad")
    assert refused(lambda: world.undo(first)) == "regrade_superseded"
    world.undo(second)
    assert world.now.score == 10.0
    third = world.regrade(b"bad")
    before, after = Submissions(database, FakeClock()).around_regrade(third.id, world.id)
    assert before is not None
    assert after is not None
    assert (before.attempt, after.attempt) == (2, 4)
    world.undo(third)
    assert world.now.score == 10.0
    world.undo(first)
    assert world.now.score == 5.0
    other = Signature(world.clock(), "other", "zhao")
    assert refused(lambda: world.regrades.undo(first.id, other, "x")) == "regrade_not_found"


def test_corrections_stay_whenever_they_were_made(world: World) -> None:
    world.correct(1.0)
    applied = world.regrade(b"good good")
    assert world.now.score == 6.0  # corrected, whatever the machine gives now
    world.correct(2.0)
    world.undo(applied)
    assert world.now.score == 7.0
    assert world.regrades.changes_of(world.id) == ()  # nothing changed for the student, either time


def test_what_the_service_failed_to_grade_has_no_grading_again(
    world: World, submissions: Submissions, queue: Queue
) -> None:
    new = NewSubmission(student="han", assignment="square", file_name="a.py", source=b"good")
    failed = submissions.add(new).id
    while (claim := queue.claim("w")) is not None:
        queue.fail(claim, "no room")
        world.clock.advance(60)
    applied = world.regrade(b"good good", which="faults")
    found = submissions.get(failed)
    assert found is not None
    assert found.score == 10.0
    world.undo(applied)
    found = submissions.get(failed)
    assert found is not None
    assert (found.state, found.score, found.report_sha256) == ("infrastructure_error", None, None)
    world.undo(world.regrade(b"good good", which="faults"))
    again = submissions.get(failed)
    assert again is not None
    assert (again.state, again.graded_attempt) == ("infrastructure_error", None)
