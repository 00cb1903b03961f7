"""What holds on PostgreSQL only: permits get lost, doubled or stuck, and rows are graded all the same."""

import threading

import pytest
from sqlalchemy import text

from grader.contracts.errors import InfrastructureError
from grader.contracts.submission import Claim
from grader.store.permits.announcer import defer
from grader.store.permits.loop import PermitLoop
from grader.store.work import Announcement
from tests.fakes.engines import PostgresEngine
from tests.fakes.waiting import PATIENCE_S


def announced_late(permits: PostgresEngine) -> int:
    permits.clock.advance(5.1)
    return permits.queue.reconcile().announced


def test_each_waiting_row_has_one_permit_and_a_graded_one_none(permits: PostgresEngine) -> None:
    for number in range(3):
        permits.upload(f"s{number}")
    assert permits.jobs("status = 'todo'") == 3
    assert announced_late(permits) == 0
    permits.graded_in_order()
    assert permits.jobs() == 0


def test_who_goes_on_without_a_permit_uses_one_up(permits: PostgresEngine) -> None:
    for number in range(3):
        permits.upload(f"s{number}")
    claim: Claim | None = permits.taken()
    permits.clock.advance(0.2)  # the slot gave back the permits that came after
    for left in (1, 0, 0):
        assert claim is not None
        _, claim = permits.finish_and_claim(claim)
        assert permits.jobs("status = 'todo'") == left
    assert claim is None


def test_who_goes_on_with_a_row_takes_its_permit_from_nobody_else(permits: PostgresEngine) -> None:
    permits.upload("a")
    claim = permits.taken()
    waits, first = permits.upload("b"), permits.upload("c")
    permits.change(f"UPDATE submission SET priority = -1 WHERE id = '{first}'")
    _, following = permits.finish_and_claim(claim)
    assert following is not None
    assert following.submission_id == first
    assert permits.jobs(f"queueing_lock = 'sub-{waits}-0'") == permits.jobs("status = 'todo'") == 1


def test_going_on_waits_for_nobody_who_takes_a_permit_at_this_moment(permits: PostgresEngine) -> None:
    permits.upload("a")
    claim = permits.taken()
    permits.upload("b")
    with permits.database.writing() as session:
        session.execute(text("SELECT FROM procrastinate_jobs WHERE status = 'todo' FOR UPDATE"))
        _, following = permits.finish_and_claim(claim)
    assert following is not None
    assert permits.jobs("status = 'todo'") == 1
    permits.work(lambda: permits.queue.claim("another") is not None)
    assert permits.jobs() == 0


def test_losing_the_whole_queue_costs_one_sweep(permits: PostgresEngine) -> None:
    ids = [permits.upload(f"s{number}") for number in range(5)]
    permits.change("TRUNCATE procrastinate_jobs, procrastinate_workers, procrastinate_events CASCADE")
    assert permits.queue.reconcile().announced == 0  # perhaps a worker is about to take them
    assert permits.graded_in_order() == []
    assert announced_late(permits) == 5
    assert announced_late(permits) == 0
    assert permits.graded_in_order() == ids


def test_a_row_in_backoff_is_not_announced_early(permits: PostgresEngine) -> None:
    permits.upload()
    permits.queue.fail(permits.taken(), "trouble")
    permits.change("DELETE FROM procrastinate_jobs")
    assert announced_late(permits) == 0
    assert announced_late(permits) == 1


def test_a_permit_from_when_the_clock_was_ahead_is_made_due(permits: PostgresEngine) -> None:
    id_ = permits.upload()
    permits.queue.fail(permits.taken(), "trouble")
    permits.clock.advance(-8 * 3_600)
    assert permits.queue.sweep().announced == 0
    assert announced_late(permits) == 1
    assert announced_late(permits) == 0
    assert permits.graded_in_order() == [id_]
    assert permits.jobs() == 0


def test_as_long_as_there_are_permits_enough_it_does_not_matter_whose(permits: PostgresEngine) -> None:
    first = permits.upload("a")
    second = permits.upload("b")
    permits.change(f"DELETE FROM procrastinate_jobs WHERE queueing_lock = 'sub-{first}-0'")
    with permits.database.writing() as session:
        gone = Announcement(submission_id="gone", attempt=0, priority=0, due_at=permits.clock())
        defer(session, [gone], permits.clock())
    assert announced_late(permits) == 0
    assert permits.graded_in_order() == [first, second]


def test_a_retry_has_a_permit_although_its_first_one_was_never_taken(permits: PostgresEngine) -> None:
    first, newest = permits.upload("a"), permits.upload("a")
    claim = permits.taken()  # with the permit of the first, which now waits for the one that is left
    assert claim.submission_id == newest
    permits.queue.fail(claim, "trouble")
    assert permits.jobs("status = 'todo'") == 2
    permits.clock.advance(2.1)
    assert permits.graded_in_order() == [newest, first]


def test_surplus_and_orphaned_permits_end_by_themselves(permits: PostgresEngine) -> None:
    id_ = permits.upload()
    with permits.database.writing() as session:
        spare = [
            Announcement(submission_id=name, attempt=0, priority=0, due_at=permits.clock())
            for name in ("x", "y")
        ]
        defer(session, spare, permits.clock())
    assert permits.graded_in_order() == [id_]
    assert (permits.jobs(), permits.graded_rows()) == (0, 1)


def test_a_permit_that_waits_already_does_not_undo_the_transaction(permits: PostgresEngine) -> None:
    id_ = permits.upload()
    other = permits.upload("b")
    permits.change(f"DELETE FROM procrastinate_jobs WHERE queueing_lock = 'sub-{other}-0'")
    both = [
        Announcement(submission_id=one, attempt=0, priority=0, due_at=permits.clock()) for one in (id_, other)
    ]
    with permits.database.writing() as session:
        session.execute(text("UPDATE submission SET trouble = 'kept'"))
        defer(session, both, permits.clock())
        defer(session, both[:1], permits.clock())
    assert permits.jobs("status = 'todo'") == 2
    row = permits.submissions.get(id_)
    assert row is not None
    assert row.trouble == "kept"


def test_a_database_that_fails_while_a_permit_is_deferred_is_said_to_be_away(permits: PostgresEngine) -> None:
    """So the upload is answered like every other one that the database cannot take now."""
    now = permits.clock()
    row = Announcement(submission_id="one", attempt=0, priority=0, due_at=now)

    def defer_behind_another() -> None:
        with permits.database.writing() as second:
            second.execute(text("SET LOCAL lock_timeout = 20"))
            defer(second, [row], now)

    with permits.database.writing() as first:
        defer(first, [row], now)
        with pytest.raises(InfrastructureError):
            defer_behind_another()
    assert permits.jobs() == 1


def test_the_job_of_a_dead_worker_is_put_away_and_its_row_announced_again(permits: PostgresEngine) -> None:
    id_ = permits.upload()
    permits.change("INSERT INTO procrastinate_workers (last_heartbeat) VALUES (now() - interval '11 s')")
    # killed between taking the permit and claiming the row
    permits.change(
        "UPDATE procrastinate_jobs SET status = 'doing', worker_id = (SELECT max(id) FROM procrastinate_workers)"
    )
    assert announced_late(permits) == 1
    assert permits.graded_in_order() == [id_]


@pytest.mark.parametrize(
    ("silent", "started", "left"),
    [("2 s", "20 s", 1), ("11 s", "20 s", 0), ("2 s", "601 s", 0)],
    ids=["at work", "worker dead", "could not be ended"],
)
def test_jobs_that_nobody_runs_do_not_stay(
    permits: PostgresEngine, silent: str, started: str, left: int
) -> None:
    permits.upload()
    permits.queue.claim("w")
    permits.change(f"INSERT INTO procrastinate_workers (last_heartbeat) VALUES (now() - interval '{silent}')")
    permits.change(
        "UPDATE procrastinate_jobs SET status = 'doing', worker_id = (SELECT max(id) FROM procrastinate_workers)"
    )
    permits.change(f"UPDATE procrastinate_events SET at = now() - interval '{started}'")
    permits.queue.reconcile()
    assert permits.jobs() == left


def test_a_sweep_waits_for_no_job_that_somebody_else_puts_away(permits: PostgresEngine) -> None:
    """Two that wait for each other's jobs would be a deadlock."""
    permits.upload("a")
    permits.upload("b")
    permits.change("UPDATE procrastinate_jobs SET status = 'doing', worker_id = NULL")
    with permits.database.writing() as other:
        other.execute(text("SELECT FROM procrastinate_jobs ORDER BY id LIMIT 1 FOR UPDATE"))
        permits.queue.reconcile()
        assert permits.jobs() == 1
    permits.queue.reconcile()
    assert permits.jobs() == 0


def test_one_worker_sweeps_at_a_time(permits: PostgresEngine) -> None:
    permits.upload()
    permits.change("DELETE FROM procrastinate_jobs")
    permits.clock.advance(5.1)
    with permits.database.writing() as session:
        assert permits.database.announcer.mend(session, permits.clock()) == 1
        assert permits.queue.reconcile().announced == 0


def test_no_permit_is_taken_while_the_sandbox_is_not_ready(permits: PostgresEngine) -> None:
    permits.upload()
    asked = threading.Event()

    def ready() -> bool:
        asked.set()
        return False

    loop = PermitLoop(permits.database, permits.clock, poll_s=0.01)
    loop.start(1, ready)
    assert asked.wait(PATIENCE_S)
    loop.drain()
    loop.close()
    assert permits.jobs("status = 'todo' AND attempts = 0") == 1


def test_a_permit_that_could_not_be_used_is_given_back(permits: PostgresEngine) -> None:
    id_ = permits.upload()
    permits.work(lambda: False)  # say, the sandbox broke just now
    assert permits.jobs("status = 'todo' AND scheduled_at IS NOT NULL") == 1
    permits.clock.advance(0.2)
    assert permits.graded_in_order() == [id_]


def test_a_permit_given_back_serves_whatever_else_waits(permits: PostgresEngine) -> None:
    held = permits.upload("a")
    other = permits.upload("b")
    permits.change(f"DELETE FROM procrastinate_jobs WHERE queueing_lock = 'sub-{held}-0'")
    permits.change(f"UPDATE submission SET state = 'graded' WHERE id = '{other}'")
    permits.work(lambda: False)  # say, another transaction held the row
    permits.clock.advance(0.2)
    assert permits.graded_in_order() == [held]
