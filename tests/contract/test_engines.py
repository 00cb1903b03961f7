"""What the queue promises, asked of both engines through what brings work to slots."""

import threading
from collections import Counter

import pytest

from grader.contracts.errors import InfrastructureError
from grader.contracts.regrade import Wanted
from grader.contracts.submission import Claim, SubmissionState
from grader.store.audit import Signature
from tests.fakes.engines import Engine


def test_first_come_first_graded(engine: Engine) -> None:
    ids = [engine.upload(f"s{number}") for number in range(4)]
    assert engine.graded_in_order() == ids
    assert engine.graded_in_order() == []


def test_of_one_students_uploads_the_newest_is_graded_first(engine: Engine) -> None:
    first, other, newest = (engine.upload(student) for student in ("a", "b", "a"))
    assert engine.graded_in_order() == [newest, other, first]


def test_a_slot_that_goes_on_keeps_the_order_and_leaves_no_work_to_others(engine: Engine) -> None:
    first, other, newest = (engine.upload(student) for student in ("a", "b", "a"))
    order: list[str] = []

    def step() -> bool:
        claim = engine.queue.claim("slot")
        going = claim is not None
        while claim is not None:
            order.append(claim.submission_id)
            stored, claim = engine.finish_and_claim(claim)
            assert stored
        return going

    engine.work(step)
    assert order == [newest, other, first]
    assert engine.graded_in_order() == []
    assert engine.graded_rows() == 3


def test_a_slot_whose_claim_was_lost_stores_nothing_and_goes_on(engine: Engine) -> None:
    lost, following = engine.upload("a"), engine.upload("b")
    late = engine.taken()
    engine.clock.advance(15.1)
    assert engine.queue.reconcile().requeued == 1
    second = engine.taken("another")
    stored, claim = engine.finish_and_claim(late)
    assert not stored
    assert claim is not None
    assert (second.submission_id, claim.submission_id) == (lost, following)
    assert engine.graded_rows() == 0


def test_a_claim_whose_answer_was_lost_is_taken_up_again_with_the_result_before_it(engine: Engine) -> None:
    for student in ("a", "b", "c"):
        engine.upload(student)
    first = engine.taken()
    _, unheard = engine.finish_and_claim(first)
    engine.clock.advance(14)
    stored, claim = engine.finish_and_claim(first)
    assert stored
    assert unheard is not None
    assert claim == unheard
    engine.clock.advance(14)
    assert engine.queue.renew([unheard]) == {unheard}
    assert engine.queue.state().queued == len(engine.graded_in_order()) == 1


def test_regrades_wait_behind_fresh_uploads_that_came_later(engine: Engine) -> None:
    original = engine.upload("a")
    assert engine.graded_in_order() == [original]
    signed = Signature(course=None, actor="wang", at=engine.clock())
    regrade = engine.regrades.open(Wanted(assignment="square", which="all"), signed)
    fresh = [engine.upload("b"), engine.upload("c")]
    order = engine.graded_in_order()
    assert order[:2] == fresh
    assert len(order) == 3
    found = engine.regrades.get(regrade.id, None)
    assert found is not None
    assert (found.waiting, found.same) == (0, 1)


def test_every_row_is_graded_once_by_several_slots(engine: Engine) -> None:
    ids = {engine.upload(f"s{number}") for number in range(12)}
    taken: list[str] = []

    def step() -> bool:
        claim = engine.queue.claim(threading.current_thread().name)
        if claim is None:
            return False
        taken.append(claim.submission_id)
        return engine.finish(claim)

    engine.work(step, slots=3)
    assert Counter(taken) == Counter(ids)
    assert engine.graded_rows() == len(ids)


def test_a_failed_try_comes_back_after_its_pause_and_not_before(engine: Engine) -> None:
    id_ = engine.upload()
    assert engine.queue.fail(engine.taken(), "the car fell over") is SubmissionState.QUEUED
    engine.clock.advance(1.9)
    assert engine.graded_in_order() == []
    engine.clock.advance(0.1)
    assert engine.graded_in_order() == [id_]


def test_what_fails_every_time_is_given_up_and_brings_no_more_work(engine: Engine) -> None:
    id_ = engine.upload()
    for expected in (SubmissionState.QUEUED, SubmissionState.QUEUED, SubmissionState.INFRASTRUCTURE_ERROR):
        assert engine.queue.fail(engine.taken(), "the car fell over") is expected
        engine.clock.advance(60)
    assert engine.graded_in_order() == []
    assert engine.state(id_) is SubmissionState.INFRASTRUCTURE_ERROR


def test_a_killed_workers_grading_is_graded_by_another_after_its_lease(engine: Engine) -> None:
    id_ = engine.upload()
    late = engine.taken()
    assert engine.queue.reconcile().requeued == 0
    engine.clock.advance(15.1)
    assert engine.queue.reconcile().requeued == 1
    assert engine.graded_in_order() == [id_]
    assert not engine.finish(late)
    assert engine.graded_rows() == 1


def test_what_kills_its_workers_is_given_up(engine: Engine) -> None:
    id_ = engine.upload()
    for requeued in (1, 1, 0):
        engine.taken()
        engine.clock.advance(16)
        assert engine.queue.reconcile().requeued == requeued
    assert engine.state(id_) is SubmissionState.INFRASTRUCTURE_ERROR


def test_what_is_handed_back_is_graded_without_delay_and_costs_no_try(engine: Engine) -> None:
    id_ = engine.upload()
    assert engine.queue.hand_back(engine.taken())
    assert engine.graded_in_order() == [id_]
    row = engine.submissions.get(id_)
    assert row is not None
    assert (row.tries, row.attempt) == (1, 2)


def test_a_result_that_cannot_be_stored_costs_one_try(engine: Engine) -> None:
    id_ = engine.upload()

    def step() -> bool:
        if engine.queue.claim("slot") is None:
            return False
        raise InfrastructureError("the database does not answer")

    engine.work(step)
    assert engine.state(id_) is SubmissionState.RUNNING
    engine.clock.advance(15.1)
    assert engine.queue.reconcile().requeued == 1
    assert engine.graded_in_order() == [id_]


def test_an_upload_that_is_rolled_back_brings_no_work(
    engine: Engine, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object) -> None:
        raise InfrastructureError("power cut")

    monkeypatch.setattr("grader.store.intake.submission_of", fail)
    with pytest.raises(InfrastructureError):
        engine.upload()
    assert engine.graded_in_order() == []
    assert engine.queue.state().queued == 0


def test_a_claim_made_twice_counts_once(engine: Engine) -> None:
    engine.upload()
    claims: list[Claim] = []

    def step() -> bool:
        claim = engine.queue.claim("slot")
        claims.extend([claim] if claim else [])
        return claim is not None

    engine.work(step)
    engine.work(step)
    (claim,) = claims
    assert engine.finish(claim)
    assert engine.finish(claim)  # it is there
    assert engine.graded_rows() == 1
