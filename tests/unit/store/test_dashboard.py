import random
from contextlib import suppress
from dataclasses import asdict

import pytest

from grader.contracts.errors import RefusedError
from grader.contracts.identity import Role, RosterEntry
from grader.contracts.regrade import Wanted
from grader.contracts.rules import Counts, Rules
from grader.contracts.submission import NewSubmission, SubmissionState
from grader.store import dashboard
from grader.store.audit import Signature
from grader.store.courses import Courses
from grader.store.dashboard import Dashboard
from grader.store.database import Database
from grader.store.queue import Queue
from grader.store.regrades import Regrades
from grader.store.rules import StoredRules
from tests.fakes.clock import FakeClock
from tests.fakes.grading import FakeAssignments, finish, grade_next
from tests.fakes.submissions import Submissions


class Class:
    def __init__(self, database: Database, queue: Queue, submissions: Submissions, clock: FakeClock) -> None:
        self.dashboard = Dashboard(database, clock)
        self.queue = queue
        self.submissions = submissions
        self.clock = clock

    def submits(
        self, student: str, source: bytes, assignment_id: str = "square", course: str | None = None
    ) -> str:
        self.clock.advance(1)
        new = NewSubmission(
            course=course, student=student, assignment=assignment_id, file_name="f.py", source=source
        )
        return self.submissions.add(new).id

    def graded(
        self, student: str, source: bytes, assignment_id: str = "square", course: str | None = None
    ) -> str:
        id_ = self.submits(student, source, assignment_id, course)
        claim = grade_next(self.queue, FakeAssignments())
        assert claim is not None
        assert claim.submission_id == id_
        return id_


@pytest.fixture
def school(database: Database, queue: Queue, submissions: Submissions, clock: FakeClock) -> Class:
    return Class(database, queue, submissions, clock)


def test_an_empty_class_is_empty(school: Class) -> None:
    state = school.dashboard.state()
    assert (state.progress, state.students, state.assignments) == ((), {}, {})


def test_the_best_submission_counts_and_the_latest_shows(school: Class) -> None:
    school.graded("ann", b"x")
    best = school.graded("ann", b"good good")
    school.graded("ann", b"good good # again")
    latest = school.graded("ann", b"raise good")
    (ann,) = school.dashboard.state().progress
    assert (ann.attempts, ann.best_score, ann.max_score) == (4, 10.0, 10.0)
    assert (ann.best_submission, ann.latest_submission) == (best, latest)
    assert ann.verdict == "crashed"
    assert ann.last_activity_at == school.clock()


def test_a_waiting_submission_has_no_score_yet(school: Class) -> None:
    school.submits("bob", b"x")
    (bob,) = school.dashboard.state().progress
    assert (bob.best_score, bob.best_submission, bob.state) == (None, None, SubmissionState.QUEUED)


def test_infrastructure_faults_cost_no_attempt(school: Class) -> None:
    school.graded("cyd", b"good")
    school.submits("cyd", b"good good")
    for _ in range(3):
        claim = school.queue.claim("w")
        school.queue.fail(claim, "no")
        school.clock.advance(60)
    (cyd,) = school.dashboard.state().progress
    assert (cyd.attempts, cyd.best_score) == (1, 5.0)
    assert cyd.state is SubmissionState.INFRASTRUCTURE_ERROR


def test_failures_count_students_not_submissions(school: Class) -> None:
    for _ in range(3):
        school.graded("ann", b"x")
    school.graded("ann", b"good good")
    school.graded("bob", b"good")
    school.graded("cyd", b"good good", "straight")
    assignments = school.dashboard.state().assignments
    failures = {one.item: (one.ever, one.still) for one in assignments["square"].failures}
    assert failures == {"closed": (2, 1), "sides": (1, 0)}
    assert assignments["straight"].failures == ()


def test_most_failed_comes_first(school: Class) -> None:
    school.graded("ann", b"good")
    school.graded("bob", b"x")
    failures = school.dashboard.state().assignments["square"].failures
    assert [failure.item for failure in failures] == ["closed", "sides"]


def test_mistakes_count_students(school: Class) -> None:
    school.graded("ann", b"x")
    school.graded("ann", b"xx")
    school.graded("bob", b"good good")
    mistakes = [(m.code, m.students) for m in school.dashboard.state().assignments["square"].mistakes]
    assert mistakes == [("interior_angle", 1), ("wall_hit", 1)]


def test_what_has_not_changed_stays_the_same_object(school: Class) -> None:
    school.graded("ann", b"good")
    school.graded("bob", b"good", "straight")
    before = school.dashboard.state()
    assert school.dashboard.state() is before
    school.graded("cyd", b"x", "straight")
    after = school.dashboard.state()
    assert after.students["ann"] is before.students["ann"]
    assert after.assignments["square"] is before.assignments["square"]
    assert len(after.assignments["straight"].progress) == 2


def test_one_upload_makes_one_cell_be_counted(school: Class, monkeypatch: pytest.MonkeyPatch) -> None:
    for student in ("ann", "bob"):
        school.graded(student, b"good")
    school.dashboard.state()
    read: list[object] = []
    original = dashboard._among
    monkeypatch.setattr(dashboard, "_among", lambda places: read.append(set(places)) or original(places))
    school.submits("bob", b"x")
    school.dashboard.state()
    school.clock.advance(600)
    assert school.dashboard.state().students["bob"].progress[0].state is SubmissionState.QUEUED
    assert read == [{("bob", "square")}] * 2  # its mark, its rows


def test_a_clock_that_is_set_back_hides_nothing(school: Class) -> None:
    school.graded("ann", b"good")
    school.dashboard.state()
    school.clock.advance(-86_400)
    school.graded("bob", b"good good")
    waiting = school.submits("cyd", b"x")
    assert [one.best_score for one in school.dashboard.state().progress] == [5.0, 10.0, None]
    school.clock.advance(-86_400)
    school.queue.bring_forward()
    claim = grade_next(school.queue, FakeAssignments())
    assert claim is not None
    assert claim.submission_id == waiting
    assert [one.best_score for one in school.dashboard.state().progress] == [5.0, 10.0, 0.0]


def test_counting_only_what_changed_counts_the_same(school: Class, database: Database) -> None:
    """A dashboard that looks after every step says what one says that has never looked before."""
    chance = random.Random(1)
    regrades = Regrades(database)
    signed = Signature(school.clock(), None, "test")

    def grade_one() -> None:
        claim = school.queue.claim("w")
        if claim is not None and chance.random() < 0.2:
            school.queue.fail(claim, "no")
        elif claim is not None:
            finish(school.queue, FakeAssignments(), claim)

    def hand_in() -> None:
        source = chance.choice([b"x", b"good", b"good good", b"raise good"])
        school.submits(chance.choice(["ann", "bob", "cyd"]), source, chance.choice(["square", "straight"]))

    def grade_again() -> None:
        with suppress(RefusedError):
            opened = regrades.open(Wanted(assignment="square", which="latest"), signed)
            for _ in range(20):
                school.clock.advance(60)
                grade_one()
            regrades.apply(opened.id, signed, "trial")

    seen = set()
    for _ in range(60):
        school.clock.advance(60)
        chance.choice([hand_in, hand_in, grade_one, grade_one, school.queue.reconcile, grade_again])()
        state = school.dashboard.state()
        assert asdict(state) == asdict(Dashboard(database, school.clock).state())
        seen.add(state.mark)
    assert len(seen) > 30


def test_changed_rules_count_at_once_and_only_where_they_hold(
    school: Class, database: Database, monkeypatch: pytest.MonkeyPatch
) -> None:
    courses = Courses(database, school.clock)
    courses.create("ros", "ROS", "UTC", "test")
    people = [RosterEntry(id=one, name=one, role=Role.STUDENT) for one in ("ann", "bob")]
    courses.import_roster("ros", people, "test")
    for student in ("ann", "bob"):
        for assignment_id in ("square", "straight"):
            school.graded(student, b"good good", assignment_id, course="ros")
            school.graded(student, b"x", assignment_id, course="ros")
    before = school.dashboard.state("ros").progress
    read: list[object] = []
    original = dashboard._among
    monkeypatch.setattr(dashboard, "_among", lambda places: read.append(places) or original(places))
    last = Rules(counts=Counts.LAST)
    StoredRules(database).set("square", last, Signature(school.clock(), "ros", "test"))
    after = school.dashboard.state("ros").progress
    assert [one.counted_score for one in before] == [10.0] * 4
    assert [one.counted_score for one in after] == [0.0, 10.0, 0.0, 10.0]
    assert read == [{("ann", "square"), ("bob", "square")}]
