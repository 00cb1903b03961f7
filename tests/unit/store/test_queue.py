import gzip
import threading
from collections import Counter
from dataclasses import replace
from itertools import count

import pytest
from sqlalchemy import inspect, text
from sqlalchemy.event import listen
from sqlmodel import select

from grader.contracts.grading import GradingJob
from grader.contracts.submission import Claim, NewSubmission, SubmissionState
from grader.store.costs import Costs
from grader.store.database import Database
from grader.store.queue import Queue, Retries
from grader.store.tables import (
    GradedAssignmentRow,
    GradedItemRow,
    GradedMistakeRow,
    GradingRow,
    SubmissionRow,
    TrajectoryRow,
)
from tests.fakes.clock import FakeClock
from tests.fakes.grading import assignment, grade
from tests.fakes.submissions import Submissions

GOOD = b"good good\n"


def upload(student: str = "s1", source: bytes = GOOD) -> NewSubmission:
    return NewSubmission(student=student, assignment="square", file_name="square.py", source=source)


def claimed(queue: Queue, worker: str = "w") -> Claim:
    claim = queue.claim(worker)
    assert claim is not None
    return claim


def result_of(claim: Claim):
    return grade(GradingJob(file_name=claim.file_name, source=claim.source, assignment=assignment()))


def test_of_quick_uploads_the_newest_goes_first_and_nobody_else_waits_longer(
    queue: Queue, submissions: Submissions, clock: FakeClock
) -> None:
    ids = []
    for student in ("a", "b", "a", "c", "a"):
        ids.append(submissions.add(upload(student)).id)
        clock.advance(0.5)
    first, other, second, third, newest = ids
    assert [queue.position(id_) for id_ in (newest, other, third, second, first)] == [0, 1, 2, 3, 4]
    assert [claimed(queue).submission_id for _ in ids] == [newest, other, third, second, first]


def test_students_take_turns_however_much_one_of_them_hands_in(
    queue: Queue, submissions: Submissions, clock: FakeClock
) -> None:
    assignments = [f"a{number}" for number in range(25)]
    for source in (GOOD, GOOD + b"good"):
        for name in assignments:
            submissions.add(NewSubmission(student="a", assignment=name, file_name="f.py", source=source))
            clock.advance(1)
    others = []
    for student in ("b", "c", "d"):
        others.append(submissions.add(upload(student)).id)
        clock.advance(1)
    claims = [claimed(queue) for _ in range(4)]
    assert [claim.submission_id for claim in claims[1:]] == others
    assert sum(1 for _ in iter(lambda: queue.claim("w"), None)) == 49


def test_whose_gradings_took_long_lately_goes_behind_others(
    queue: Queue, submissions: Submissions, clock: FakeClock
) -> None:
    def hand_in_again() -> list[str]:
        costly = submissions.add(upload("a", GOOD + str(clock()).encode())).id
        clock.advance(5)
        return [costly, submissions.add(upload("b", GOOD + str(clock()).encode())).id]

    submissions.add(upload("a"))
    claim = claimed(queue)
    clock.advance(30)
    queue.finish(claim, result_of(claim), assignment())
    costly, other = hand_in_again()
    claims = [claimed(queue) for _ in range(2)]
    assert [claim.submission_id for claim in claims] == [other, costly]
    for claim in claims:
        queue.finish(claim, result_of(claim), assignment())
    clock.advance(3600)
    ids = hand_in_again()
    assert [claimed(queue).submission_id for _ in ids] == ids


def test_a_slow_host_puts_nobody_back_by_more_than_ten_minutes(
    queue: Queue, submissions: Submissions, clock: FakeClock
) -> None:
    submissions.add(upload("a"))
    claim = claimed(queue)
    clock.advance(400)
    queue.finish(claim, result_of(claim), assignment())
    back = submissions.add(upload("a", GOOD + b"good")).id
    clock.advance(601)
    other = submissions.add(upload("b")).id
    assert [claimed(queue).submission_id for _ in range(2)] == [back, other]


def test_who_costs_the_service_most_is_told(
    queue: Queue, submissions: Submissions, database: Database, clock: FakeClock
) -> None:
    for student, seconds in (("a", 5.0), ("b", 30.0), ("c", 7.0)):
        submissions.add(upload(student))
        claim = claimed(queue)
        clock.advance(seconds)
        queue.finish(claim, result_of(claim), assignment())
    clock.advance(3_590)  # the first was graded more than an hour ago
    for source in (b"1", b"2"):
        submissions.add(upload("a", GOOD + source))
    claimed(queue)
    clock.advance(2)
    costs = Costs(database, clock).lately(None)
    told = [(one.student, one.slot_s, one.gradings, one.waiting, one.tries) for one in costs]
    assert told == [("b", 30.0, 1, 0, 1), ("c", 7.0, 1, 0, 1), ("a", 2.0, 1, 1, 1)]
    assert Costs(database, clock).lately("ros") == ()
    assert Costs(database, clock).lately("ros", everywhere=True) == costs


def test_quick_uploads_at_one_instant_keep_their_order(queue: Queue, submissions: Submissions) -> None:
    ids = [submissions.add(upload("a")).id for _ in range(3)]
    taken = [claimed(queue).submission_id for _ in ids]
    assert taken[0] == ids[2]
    assert set(taken) == set(ids)


def test_uploads_to_other_assignments_wait_for_their_turn(
    queue: Queue, submissions: Submissions, clock: FakeClock
) -> None:
    first = submissions.add(upload("a")).id
    clock.advance(1)
    submissions.add(NewSubmission(student="a", assignment="straight", file_name="f.py", source=GOOD))
    assert claimed(queue).submission_id == first


def test_the_pace_is_measured(queue: Queue, submissions: Submissions, clock: FakeClock) -> None:
    assert queue.mean_duration_s() is None
    for seconds in (1.0, 3.0):
        submissions.add(upload())
        claim = claimed(queue)
        clock.advance(seconds)
        queue.finish(claim, result_of(claim), assignment())
    assert queue.mean_duration_s() == 2.0


def test_a_claim_carries_the_uploaded_bytes(queue: Queue, submissions: Submissions) -> None:
    source = b"\xef\xbb\xbf# \xe4\xbd\xa0\r\n"
    added = submissions.add(upload(source=source))
    claim = claimed(queue)
    assert (claim.submission_id, claim.source, claim.attempt, claim.tries) == (added.id, source, 1, 1)
    assert submissions.get(added.id).state is SubmissionState.RUNNING


def test_an_empty_queue_gives_nothing(queue: Queue) -> None:
    assert queue.claim("w") is None


def test_first_come_first_graded(queue: Queue, submissions: Submissions, clock: FakeClock) -> None:
    ids = []
    for number in range(4):
        ids.append(submissions.add(upload(f"s{number}")).id)
        clock.advance(0.001)
    assert [queue.position(id_) for id_ in ids] == [0, 1, 2, 3]
    assert [claimed(queue).submission_id for _ in ids] == ids
    assert queue.position(ids[0]) is None


def test_two_workers_never_hold_the_same_submission(queue: Queue, submissions: Submissions) -> None:
    ids = {submissions.add(upload(f"s{number}")).id for number in range(40)}
    taken: list[str] = []
    start = threading.Barrier(4)

    def work(name: str) -> None:
        start.wait()
        while (claim := queue.claim(name)) is not None:
            taken.append(claim.submission_id)

    threads = [threading.Thread(target=work, args=(f"w{number}",)) for number in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    # a worker may find the queue empty while the last rows are being claimed, but none is claimed twice
    assert max(Counter(taken).values()) == 1
    assert set(taken) == ids


def test_a_result_is_stored_with_the_row(queue: Queue, submissions: Submissions, database: Database) -> None:
    added = submissions.add(upload())
    claim = claimed(queue)
    result = result_of(claim)
    assert queue.finish(claim, result, assignment())
    row = submissions.get(added.id)
    assert (row.state, row.score, row.max_score) == (SubmissionState.GRADED, 10.0, 10.0)
    report = submissions.report(added.id)
    assert report.content == result.report.canonical_bytes()
    assert report.sha256 == result.report.sha256() == row.report_sha256
    with database.reading() as session:
        assert {item.item for item in session.exec(select(GradedItemRow))} == {"sides", "closed"}
        assert len(session.exec(select(TrajectoryRow)).all()) == 1
        kept = session.connection().execute(text("SELECT report FROM grading")).scalar_one()
        assert gzip.decompress(bytes(kept)) == report.content
    with database.writing() as session:  # as rows from before were stored
        session.connection().execute(text("UPDATE grading SET report = :plain"), {"plain": report.content})
    assert submissions.report(added.id).content == report.content


def test_pauses_grow_to_an_hour_and_not_for_ever(
    database: Database, submissions: Submissions, clock: FakeClock
) -> None:
    patient = Queue(database, clock, Retries(max_tries=100_000))
    submissions.add(upload())
    claim = replace(claimed(patient), tries=2_000)
    assert patient.fail(claim, "trouble") is SubmissionState.QUEUED
    clock.advance(3_599)
    assert patient.claim("w") is None
    clock.advance(1)
    assert patient.claim("w") is not None


def test_a_late_worker_is_fenced_off(queue: Queue, submissions: Submissions, clock: FakeClock) -> None:
    added = submissions.add(upload())
    late = claimed(queue, "late")
    clock.advance(15.5)
    assert queue.reconcile().requeued == 1
    second = claimed(queue, "second")
    assert second.attempt == late.attempt + 1
    assert not queue.finish(late, result_of(late), assignment())
    assert queue.fail(late, "too late") is None
    assert not queue.hand_back(late)
    assert queue.renew([late, second]) == {second}
    assert queue.renew([late]) == set()
    assert submissions.get(added.id).state is SubmissionState.RUNNING
    assert queue.finish(second, result_of(second), assignment())
    assert submissions.get(added.id).graded_attempt == 2


def test_a_result_whose_commit_was_not_answered_is_known_when_it_comes_again(
    queue: Queue, submissions: Submissions, database: Database, clock: FakeClock
) -> None:
    submissions.add(upload())
    claim = claimed(queue)
    assert queue.finish(claim, result_of(claim), assignment())
    clock.advance(1)
    assert queue.finish(claim, result_of(claim), assignment())
    with database.reading() as session:
        assert len(session.exec(select(GradingRow)).all()) == 1
    another = replace(result_of(claim).report, grader_version="another")
    assert not queue.finish(claim, replace(result_of(claim), report=another), assignment())
    assert not queue.finish(replace(claim, worker="another"), result_of(claim), assignment())
    assert not queue.finish(replace(claim, attempt=2), result_of(claim), assignment())


def test_a_result_keeps_every_row_and_brings_the_next_claim(
    queue: Queue, submissions: Submissions, database: Database, clock: FakeClock
) -> None:
    """The second time the connection knows that the assignment is stored; the third time nothing waits."""
    for student in ("a", "b", "c"):
        submissions.add(upload(student, b"good\n"))
        clock.advance(1)
    claim: Claim | None = claimed(queue)
    while claim is not None:
        result = result_of(claim)
        two = {"first": result.trajectories["default"], "second": b"{}"}
        result = replace(result, report=replace(result.report, score=None), trajectories=two)
        submission = claim.submission_id
        stored, claim = queue.finish_and_claim(claim, result, assignment(), "w", in_turn=True)
        assert stored
        with database.reading() as session:
            grading = session.get_one(GradingRow, (submission, 1))
            of_it = [
                session.exec(select(kind).where(kind.submission_id == submission).order_by(key)).all()
                for kind, key in (
                    (GradedItemRow, "item"),
                    (GradedMistakeRow, "rank"),
                    (TrajectoryRow, "position"),
                )
            ]
        assert (grading.score, grading.max_score, grading.worker) == (None, 10.0, "w")
        assert (grading.finished_at, grading.report) == (clock(), result.report.canonical_bytes())
        assert [(one.item, one.status, one.earned) for one in of_it[0]] == [
            ("closed", "failed", 0.0),
            ("sides", "passed", 5.0),
        ]
        assert [(one.code, one.rank) for one in of_it[1]] == [("interior_angle", 0), ("wall_hit", 1)]
        assert [(one.case_id, gzip.decompress(one.content)) for one in of_it[2]] == list(two.items())
    with database.reading() as session:
        assert len(session.exec(select(GradedAssignmentRow)).all()) == 1


def test_a_claim_is_its_workers_alone(queue: Queue, submissions: Submissions, database: Database) -> None:
    """A server that crashed may have lost a claim whose worker lives: the next claim has the same number."""
    added = submissions.add(upload())
    lost = claimed(queue, "lost")
    with database.writing() as session:
        session.execute(text("UPDATE submission SET state = 'queued', attempt = 0, tries = 0, worker = ''"))
    claim = claimed(queue, "another")
    assert (claim.submission_id, claim.attempt) == (lost.submission_id, lost.attempt)
    assert not queue.finish(lost, result_of(lost), assignment())
    assert not queue.hand_back(lost)
    assert queue.renew([lost, claim]) == {claim}
    assert queue.finish(claim, result_of(claim), assignment())
    assert submissions.get(added.id).state is SubmissionState.GRADED


def test_on_postgresql_only_the_commit_of_what_would_be_made_again_does_not_wait(
    postgres_database: Database, clock: FakeClock
) -> None:
    submissions, queue = Submissions(postgres_database, clock), Queue(postgres_database, clock, Retries())
    for student in ("a", "b"):
        submissions.add(upload(student))
    claim = claimed(queue)
    asked: list[str] = []
    listen(postgres_database.engine, "before_cursor_execute", lambda *about: asked.append(about[2]))
    _, following = queue.finish_and_claim(claim, result_of(claim), assignment(), "w")
    assert following is not None
    assert asked[0] == "SET LOCAL synchronous_commit = off"
    with postgres_database.reading() as session:
        assert session.execute(text("SHOW synchronous_commit")).scalar_one() == "on"
    asked.clear()
    assert queue.renew([following]) == {following}
    assert "synchronous_commit" not in "".join(asked)


def test_a_renewed_lease_lives_on(queue: Queue, submissions: Submissions, clock: FakeClock) -> None:
    submissions.add(upload())
    claim = claimed(queue)
    for _ in range(5):
        clock.advance(10)
        assert queue.renew([claim]) == {claim}
        assert queue.reconcile().requeued == 0
    clock.advance(15.1)
    assert queue.reconcile().requeued == 1


def test_what_was_queued_and_claimed_while_the_clock_was_ahead_waits_no_longer_for_it(
    queue: Queue, submissions: Submissions, clock: FakeClock
) -> None:
    """A machine whose hardware clock has local time is eight hours ahead until somebody asks for the time."""
    ids = [submissions.add(upload(f"s{number}")).id for number in range(2)]
    abandoned = claimed(queue)
    clock.advance(-8 * 3_600)
    assert queue.claim("w") is None
    queue.bring_forward()
    assert claimed(queue).submission_id in set(ids) - {abandoned.submission_id}
    assert queue.reconcile().requeued == 1
    assert claimed(queue).submission_id == abandoned.submission_id


def test_failed_tries_wait_longer_each_time_and_then_end(
    queue: Queue, submissions: Submissions, clock: FakeClock
) -> None:
    added = submissions.add(upload())
    for pause_s in (2.0, 4.0):
        assert queue.fail(claimed(queue), "the car fell over") is SubmissionState.QUEUED
        clock.advance(pause_s - 0.001)
        queue.bring_forward()
        assert queue.claim("w") is None
        clock.advance(0.001)
    assert queue.fail(claimed(queue), "the car fell over") is SubmissionState.INFRASTRUCTURE_ERROR
    row = submissions.get(added.id)
    assert (row.state, row.score, row.trouble) == (
        SubmissionState.INFRASTRUCTURE_ERROR,
        None,
        "the car fell over",
    )
    clock.advance(3600)
    assert queue.claim("w") is None
    assert submissions.source(added.id) == GOOD


def test_a_try_that_failed_while_the_script_ran_is_repeated_once(
    queue: Queue, submissions: Submissions, clock: FakeClock
) -> None:
    submissions.add(upload())
    assert queue.fail(claimed(queue), "no end", had_run=True) is SubmissionState.QUEUED
    clock.advance(3600)
    assert queue.fail(claimed(queue), "no end", had_run=True) is SubmissionState.INFRASTRUCTURE_ERROR


def test_a_failed_try_goes_behind_what_waits_when_it_is_due(
    queue: Queue, submissions: Submissions, clock: FakeClock
) -> None:
    failed = submissions.add(upload())
    assert queue.fail(claimed(queue), "no end") is SubmissionState.QUEUED
    clock.advance(0.5)
    fresh = submissions.add(upload(student="somebody-else"))
    clock.advance(3600)
    assert [claimed(queue).submission_id for _ in range(2)] == [fresh.id, failed.id]


def test_a_submission_that_kills_its_workers_ends(
    queue: Queue, submissions: Submissions, clock: FakeClock
) -> None:
    added = submissions.add(upload())
    for _ in range(2):
        claimed(queue)
        clock.advance(16)
        assert queue.reconcile().requeued == 1
    claimed(queue)
    clock.advance(16)
    mended = queue.reconcile()
    assert (mended.requeued, mended.given_up) == (0, 1)
    assert submissions.get(added.id).state is SubmissionState.INFRASTRUCTURE_ERROR


def test_handing_back_costs_no_try(queue: Queue, submissions: Submissions) -> None:
    submissions.add(upload())
    for _ in range(10):
        claim = claimed(queue)
        assert claim.tries == 1
        assert queue.hand_back(claim)
    assert claim.attempt == 10


def test_after_a_crash_of_everything_nothing_waits_for_its_lease(
    queue: Queue, submissions: Submissions
) -> None:
    submissions.add(upload())
    first = claimed(queue)
    assert queue.reconcile().requeued == 0
    assert queue.reconcile(all_running=True).requeued == 1
    assert claimed(queue).attempt == first.attempt + 1


def test_a_second_grading_keeps_the_first(queue: Queue, submissions: Submissions, database: Database) -> None:
    added = submissions.add(upload())
    first = claimed(queue)
    assert queue.finish(first, result_of(first), assignment())
    with database.writing() as session:
        session.connection().exec_driver_sql("UPDATE submission SET state = 'queued', tries = 0")
    second = claimed(queue)
    assert queue.finish(second, result_of(second), assignment())
    assert submissions.report(added.id).attempt == 2
    with database.reading() as session:
        assert len({row.report_sha256 for row in session.exec(select(GradingRow))}) == 1
        assert len(session.exec(select(GradingRow)).all()) == 2


def test_a_result_that_cannot_be_stored_leaves_the_claim(
    queue: Queue, submissions: Submissions, database: Database
) -> None:
    added = submissions.add(upload())
    claim = claimed(queue)
    with database.writing() as session:
        session.connection().exec_driver_sql("ALTER TABLE trajectory RENAME TO elsewhere")
    with pytest.raises(Exception, match="trajectory"):
        queue.finish(claim, result_of(claim), assignment())
    assert submissions.get(added.id).state is SubmissionState.RUNNING
    assert submissions.report(added.id) is None


def test_queue_state_counts(queue: Queue, submissions: Submissions, clock: FakeClock) -> None:
    submissions.add(upload())
    clock.advance(1)
    second = submissions.add(upload("s2"))
    submissions.add(upload("s3"))
    claimed(queue)
    state = queue.state()
    assert (state.queued, state.running, state.infrastructure_errors) == (2, 1, 0)
    assert state.oldest_queued_at == second.queued_at


def test_an_upload_costs_the_same_however_many_came_before(
    sqlite_database: Database, clock: FakeClock
) -> None:
    """Counted in steps of the database, which do not depend on the machine."""
    submissions, steps = Submissions(sqlite_database, clock), count()
    listen(
        sqlite_database.engine,
        "before_cursor_execute",
        lambda connection, *_: connection.connection.driver_connection.set_progress_handler(
            lambda: next(steps) < 0, 1
        ),
    )
    submissions.add(upload())
    columns = [column.name for column in inspect(SubmissionRow).columns]
    copied = ", ".join("hex(randomblob(18))" if name == "id" else name for name in columns)
    taken = []
    for source in (b"second", b"third"):
        with sqlite_database.writing() as session:
            session.execute(text("UPDATE submission SET state = 'graded', finished_at = received_at"))
        clock.advance(3600)
        before = next(steps)
        submissions.add(upload(source=source))
        taken.append(next(steps) - before)
        with sqlite_database.writing() as session:
            numbers = "WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n WHERE i < 1000)"
            first = "(SELECT * FROM submission ORDER BY received_at LIMIT 1)"
            session.execute(text(f"INSERT INTO submission {numbers} SELECT {copied} FROM n, {first}"))
    assert taken[1] < 1.5 * taken[0]
