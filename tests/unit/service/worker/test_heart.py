"""The heart of a worker: what it renews, lets go of, mends and reports."""

import threading
from collections.abc import Iterator, Sequence
from typing import NoReturn

import pytest

from grader.contracts.errors import InfrastructureError
from grader.contracts.grading import SandboxState
from grader.contracts.submission import SubmissionState
from grader.service.worker import SandboxHealth
from grader.service.worker.heart import Heart
from grader.service.worker.slots import WorkerSlot
from tests.fakes.grading import assignment
from tests.fakes.waiting import PATIENCE_S
from tests.fakes.worker_bench import READY, Bench

BEAT_S = 3.0  # a fifth of the bench's lease


@pytest.fixture
def bench(database_url: str) -> Iterator[Bench]:
    made = Bench(database_url)
    yield made
    made.grader.release()
    made.database.close()


def heart(bench: Bench, slot: WorkerSlot | None = None) -> Heart:
    """A heart that only beats when the test says so."""
    sandbox = SandboxHealth(lambda: bench.probed[-1])
    return Heart("w", [slot or bench.slot()], bench.parts, sandbox, heartbeat_s=BEAT_S)


def stolen(bench: Bench) -> None:
    """Let another worker have what is graded now."""
    bench.clock.advance(16)
    bench.queue.reconcile()
    assert bench.queue.claim("other") is not None


def live(bench: Bench, *hearts: Heart, beats: int) -> None:
    for _ in range(beats):
        bench.clock.advance(BEAT_S)
        for made in hearts:
            made.beat()


def test_a_beat_renews_mends_and_reports(bench: Bench) -> None:
    lost = bench.upload()
    bench.queue.claim("dead worker")
    mine = bench.upload()
    slot = bench.slot()
    made = heart(bench, slot)
    made.beat()
    slot.claim = bench.queue.claim("w")
    assert slot.claim.submission_id == mine
    live(bench, made, beats=6)
    assert bench.row(lost).state is SubmissionState.QUEUED
    assert bench.row(mine).state is SubmissionState.RUNNING
    (state,) = bench.workers.alive(60)
    assert (state.busy, state.slots, state.sandbox_ready, state.isolation) == (1, 1, True, "strict")


def test_a_beat_tries_the_sandbox_until_it_is_ready(bench: Bench) -> None:
    bench.probed = [SandboxState(ready=False, detail="no seccomp")]
    made = heart(bench)
    made.beat()
    assert not bench.workers.alive(60)[0].sandbox_ready
    bench.probed.append(READY)
    made.beat()
    assert bench.workers.alive(60)[0].sandbox_ready


def test_giving_a_submission_up_is_an_alarm_in_the_log(
    bench: Bench, caplog: pytest.LogCaptureFixture
) -> None:
    id_ = bench.upload()
    made = heart(bench)
    for _ in range(3):
        assert not caplog.records or caplog.records[-1].levelname == "WARNING"
        bench.queue.claim("dead worker")
        live(bench, made, beats=6)
    assert caplog.records[-1].levelname == "ERROR"
    assert "1 given up" in caplog.text
    assert bench.row(id_).state is SubmissionState.INFRASTRUCTURE_ERROR


class Grading:
    """A slot that grades in a thread of its own until the test lets it."""

    def __init__(self, bench: Bench, slot: WorkerSlot | None = None) -> None:
        bench.grader.hold()
        self.slot = slot or bench.slot()
        self._thread = threading.Thread(target=self.slot.step)
        self._thread.start()
        assert bench.grader.busy.wait(PATIENCE_S)

    def join(self) -> None:
        self._thread.join(PATIENCE_S)
        assert not self._thread.is_alive()


def test_a_grading_whose_claim_was_lost_is_given_up_and_the_slot_goes_on(bench: Bench) -> None:
    lost = bench.upload()
    grading = Grading(bench)
    made = heart(bench, grading.slot)
    stolen(bench)
    made.beat()
    assert bench.grader.aborts == 0  # one answer may only mean that the result has just been stored
    made.beat()
    grading.join()
    row = bench.row(lost)
    assert (row.state, row.attempt) == (SubmissionState.RUNNING, 2)
    following = bench.upload()
    assert grading.slot.step()
    assert bench.row(following).state is SubmissionState.GRADED


def test_a_claim_that_was_lost_is_not_taken_for_the_next_of_the_same_submission(bench: Bench) -> None:
    """Both are of this worker: the first was frozen, say, and a second slot took the submission again."""
    bench.upload()
    first, second = bench.slot(), bench.slot()
    first.claim = bench.queue.claim("w/0")
    bench.clock.advance(16)
    bench.queue.reconcile()
    second.claim = bench.queue.claim("w/1")
    made = Heart("w", [first, second], bench.parts, SandboxHealth(lambda: READY), heartbeat_s=BEAT_S)
    made.beat()
    made.beat()
    assert bench.grader.aborts == 1


def test_what_takes_long_frees_the_slot_that_is_kept_once_somebody_waits(bench: Bench) -> None:
    long = bench.upload()
    kept = WorkerSlot("w/0", bench.parts, SandboxHealth(lambda: READY), reserved=True)
    kept._sandbox.try_out()
    grading, made = Grading(bench, kept), heart(bench, kept)
    live(bench, made, beats=11)
    assert bench.grader.aborts == 0  # nobody waits
    other = bench.upload(student="other")
    made.beat()
    grading.join()
    assert (bench.row(long).state, bench.row(long).tries) == (SubmissionState.QUEUED, 1)
    assert kept.step()
    assert not kept.step()  # its turn comes later; any other slot takes it at once, for as long as it takes
    assert bench.row(other).state is SubmissionState.GRADED
    kept.claim = bench.queue.claim("w/1")
    assert (kept.claim.submission_id, kept.claim.tries) == (long, 2)
    bench.upload(student="third")
    live(bench, made, beats=20)
    assert bench.grader.aborts == 1


def test_what_takes_no_longer_than_others_lately_goes_on_in_the_slot_that_is_kept(bench: Bench) -> None:
    """On a slow host, say: an end would only have it run twice."""
    for beats in (4, 4, 400):  # one that takes minutes is not what is ordinary
        bench.upload(b"good" * beats, student="earlier")
        earlier = bench.queue.claim("w/1")
        assert earlier is not None
        bench.clock.advance(beats * BEAT_S)
        assert bench.queue.finish(earlier, bench.result(earlier), assignment())
    bench.upload()
    kept = WorkerSlot("w/0", bench.parts, SandboxHealth(lambda: READY), reserved=True)
    kept._sandbox.try_out()
    grading, made = Grading(bench, kept), heart(bench, kept)
    bench.upload(student="other")
    live(bench, made, beats=16)
    assert bench.grader.aborts == 0
    live(bench, made, beats=1)
    assert bench.grader.aborts == 1
    grading.join()


def test_a_first_try_may_take_four_seconds_in_the_slot_that_is_kept(bench: Bench) -> None:
    bench.upload()
    kept = WorkerSlot("w/0", bench.parts, SandboxHealth(lambda: READY), reserved=True)
    kept._sandbox.try_out()
    grading, made = Grading(bench, kept), heart(bench, kept)
    bench.upload(student="other")
    bench.clock.advance(4)
    made.beat()
    assert bench.grader.aborts == 0
    bench.clock.advance(1)
    made.beat()
    assert bench.grader.aborts == 1
    grading.join()


def test_a_slot_is_asked_to_give_way_between_two_beats(bench: Bench, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("grader.service.worker.heart._LOOK_S", 0.01)
    asked = threading.Semaphore(0)

    class Asked(WorkerSlot):
        def give_way(self) -> None:
            asked.release()

    slot = Asked("w/0", bench.parts, SandboxHealth(lambda: READY), reserved=True)
    made = Heart("w", [slot], bench.parts, SandboxHealth(lambda: READY), heartbeat_s=1_000.0)
    made.start()
    try:
        assert all(asked.acquire(timeout=60.0) for _ in range(2))  # at the first beat, and before the second
    finally:
        made.stop(60.0)


def test_abandoning_a_claim_spares_the_next(bench: Bench) -> None:
    bench.upload()
    slot = bench.slot()
    old = bench.queue.claim("w/0")
    assert old is not None
    slot.claim = bench.queue.claim("w/0")
    slot.abandon(old)
    assert bench.grader.aborts == 0


def outage(bench: Bench, hearts: Sequence[Heart], seconds: float) -> None:
    """Let the database be away while `hearts` go on beating."""

    def refuse(*, lasting: bool = True) -> NoReturn:
        raise InfrastructureError("the database does not answer")

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(bench.database, "writing", refuse)
        for _ in range(round(seconds / BEAT_S)):
            bench.clock.advance(BEAT_S)
            for made in hearts:
                with pytest.raises(InfrastructureError):
                    made.beat()


def test_after_an_outage_whoever_comes_back_first_takes_nothing_from_the_others(bench: Bench) -> None:
    for _ in range(2):
        bench.upload()
    slot = bench.slot()
    first, other = heart(bench), heart(bench, slot)
    live(bench, first, other, beats=6)
    theirs = slot.claim = bench.queue.claim("other")
    dead = bench.queue.claim("dead worker")
    assert theirs is not None
    assert dead is not None
    outage(bench, (first, other), seconds=30)
    live(bench, first, other, beats=5)
    assert bench.row(dead.submission_id).state is SubmissionState.RUNNING
    live(bench, first, other, beats=1)
    assert bench.row(dead.submission_id).state is SubmissionState.QUEUED
    row = bench.row(theirs.submission_id)
    assert (row.state, row.tries) == (SubmissionState.RUNNING, 1)
