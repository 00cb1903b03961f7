from datetime import timedelta

from grader.contracts.identity import Role, RosterEntry
from grader.contracts.submission import NewSubmission, SubmissionState
from grader.store.courses import Courses
from grader.store.database import Database
from grader.store.queue import Queue
from grader.store.standings import Measures, Standings
from grader.store.workers import Workers
from tests.fakes.clock import FakeClock
from tests.fakes.grading import FakeAssignments, grade_next
from tests.fakes.submissions import Submissions


def upload(submissions: Submissions, clock: FakeClock, student: str, course: str | None = None) -> str:
    clock.advance(1)
    new = NewSubmission(
        student=student, assignment="square", file_name="a.py", source=student.encode(), course=course
    )
    return submissions.add(new).id


def test_positions_are_those_of_the_queue(
    database: Database, submissions: Submissions, queue: Queue, clock: FakeClock
) -> None:
    ids = [upload(submissions, clock, f"s{number % 3}") for number in range(6)]  # quick ones change turns
    graded = grade_next(queue, FakeAssignments()).submission_id
    claim = queue.claim("w")
    assert claim is not None
    found = Standings(database).of([*ids, "nobody"])
    assert {id_: one.position for id_, one in found.items()} == {id_: queue.position(id_) for id_ in ids}
    assert found[graded].is_final
    assert found[claim.submission_id].state is SubmissionState.RUNNING
    assert found[claim.submission_id].started_at == clock()
    assert len({one.mark for one in found.values()}) == len(ids)


def test_a_class_stands_elsewhere_after_every_change(
    database: Database, submissions: Submissions, queue: Queue, clock: FakeClock
) -> None:
    courses, standings = Courses(database, clock), Standings(database)
    for course in ("ros", "other"):
        courses.create(course, course, "UTC", "test")
    marks = []

    def look() -> tuple[int, int, int]:
        one = standings.of_classes(["ros", None])["ros"]
        marks.append(one.mark)
        return one.queued, one.running, one.graded

    member = RosterEntry(id="s1", name="s1", role=Role.STUDENT)
    courses.import_roster("ros", [member], "test")
    assert look() == (0, 0, 0)
    upload(submissions, clock, "s1", "ros")
    assert look() == (1, 0, 0)
    claim = queue.claim("w")
    assert claim is not None
    assert look() == (0, 1, 0)
    queue.hand_back(claim)
    assert look() == (1, 0, 0)
    grade_next(queue, FakeAssignments())
    assert look() == (0, 0, 1)
    courses.import_roster("ros", [RosterEntry(id="s2", name="s2", role=Role.STUDENT)], "test")
    look()
    assert len(set(marks)) == len(marks)
    courses.import_roster("other", [member], "test")
    upload(submissions, clock, "s1", "other")
    upload(submissions, clock, "s1")
    look()
    assert marks[-1] == marks[-2]
    assert standings.of_classes([None])[None].queued == 1


def test_what_operators_measure(
    database: Database, submissions: Submissions, queue: Queue, clock: FakeClock
) -> None:
    measures = Measures(database, Workers(database, clock), clock, silent_s=12)
    assert (measures.state().depths, measures.state().oldest_queued_at) == ((), None)
    for student in ("s1", "s2", "s3"):
        upload(submissions, clock, student)
    grade_next(queue, FakeAssignments())
    state = measures.state()
    assert [(one.state, one.priority, one.count) for one in state.depths] == [
        ("graded", 0, 1),
        ("queued", 0, 2),
    ]
    assert state.oldest_queued_at == clock() - timedelta(seconds=1)
    assert state.workers == ()
