"""One slot: what it grades, what counts as a try, what is never stored."""

import threading
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from typing import Any

import pytest

from grader.contracts.assignment import Assignment
from grader.contracts.errors import InfrastructureError, NoRoomError, SandboxUnavailableError
from grader.contracts.grading import GradingJob, GradingResult, SandboxState
from grader.contracts.identity import Role, RosterEntry
from grader.contracts.report import GradeStatus
from grader.contracts.submission import Claim, SubmissionState
from grader.service.worker import SandboxHealth
from grader.store.audit import AuditLog, Signature
from grader.store.courses import Courses
from grader.store.queue import Queue, Retries
from tests.fakes.grading import FakeGrader, assignment, grade
from tests.fakes.waiting import PATIENCE_S
from tests.fakes.worker_bench import Bench


@pytest.fixture
def bench(database_url: str) -> Iterator[Bench]:
    made = Bench(database_url)
    yield made
    made.database.close()


def test_a_step_grades_one_submission(bench: Bench) -> None:
    id_ = bench.upload()
    slot = bench.slot()
    assert slot.step()
    assert not slot.step()
    row = bench.row(id_)
    assert (row.state, row.verdict, row.score) == (SubmissionState.GRADED, GradeStatus.GRADED, 10.0)
    assert bench.submissions.report(id_).cases.keys() == {"default"}


def test_a_step_goes_on_with_what_is_due_next(bench: Bench) -> None:
    ids = [bench.upload() for _ in range(3)]
    assert bench.slot().step()
    assert [bench.row(one).state for one in ids] == [SubmissionState.GRADED] * 3


def test_the_course_chooses_the_release_unless_the_assignment_does(bench: Bench) -> None:
    courses, signed = Courses(bench.database, bench.clock), Signature(bench.clock(), "ros", "wang")
    courses.create("ros", "ROS", "UTC", "wang")
    courses.import_roster("ros", [RosterEntry(id="s1", name="s1", role=Role.STUDENT)], "wang")
    of_their_own = [replace(one, distro="jazzy") for one in bench.parts.assignments.all()]

    def graded(course: str | None) -> Assignment:
        id_ = bench.upload(course=course)
        assert bench.slot().step()
        return bench.submissions.graded_assignment(bench.submissions.report(id_))

    def graded_on(course: str | None) -> str:
        return graded(course).release

    assert (graded_on(None), graded_on("ros")) == ("humble", "humble")
    courses.change(signed, distro="jazzy")
    assert (graded_on(None), graded_on("ros")) == ("humble", "jazzy")
    courses.change(signed, distro="humble")
    bench.parts.assignments.assignments = tuple(of_their_own)
    assert graded_on("ros") == "jazzy"
    changes = [one for one in AuditLog(bench.database).entries("ros", 9) if one.action == "course.change"]
    assert [one.after for one in changes] == [{"distro": "humble"}, {"distro": "jazzy"}]
    courses.change(signed, runs_as="ros2_run")
    assert (graded(None).started_as, graded("ros").started_as) == ("python", "ros2_run")


@pytest.mark.parametrize(
    ("runs", "state"), [(False, SubmissionState.QUEUED), (True, SubmissionState.INFRASTRUCTURE_ERROR)]
)
def test_a_try_that_fails_while_the_script_runs_is_repeated_once(
    bench: Bench, runs: bool, state: SubmissionState
) -> None:
    id_ = bench.upload()
    bench.grader.runs = runs
    bench.grader.faults = [InfrastructureError("no end") for _ in range(2)]
    for _ in range(2):
        assert bench.slot().step()
    assert bench.row(id_).state is state


def test_a_slot_is_kept_for_those_whose_turn_it_is(bench: Bench) -> None:
    ids = [bench.upload(b"good" * (1 + number), "straight", student="s1") for number in range(3)]
    kept = partial(bench.queue.claim, "w/0", in_turn=True)
    first = kept()
    assert first is not None
    assert kept() is None  # beside another upload of the student
    second = bench.queue.claim("w/1")  # any other slot takes it at once
    assert second is not None
    for claim in (first, second):
        assert bench.queue.finish(claim, bench.result(claim), assignment())
    third = kept()  # those took no time
    assert third is not None
    assert {first.submission_id, second.submission_id, third.submission_id} == set(ids)


def test_a_slot_is_kept_from_whose_gradings_take_long(bench: Bench) -> None:
    for number in range(2):
        bench.upload(b"good" * (1 + number), "straight", student="s1")
    kept = partial(bench.queue.claim, "w/0", in_turn=True)
    first = kept()
    assert first is not None
    bench.clock.advance(6.0)
    assert bench.queue.finish(first, bench.result(first), assignment())
    assert kept() is None
    bench.upload(b"good", student="s2")
    other = kept()
    assert other is not None
    assert bench.row(other.submission_id).student == "s2"
    bench.clock.advance(600.0)
    assert kept() is not None  # its turn has come


def test_a_slot_is_kept_from_whose_other_upload_gave_way(bench: Bench) -> None:
    for number in range(2):
        bench.upload(b"good" * (1 + number), "straight", student="s1")
    kept = partial(bench.queue.claim, "w/0", in_turn=True)
    first = kept()
    assert first is not None
    assert bench.queue.put_behind(first, "it took long")
    assert kept() is None  # what the same student handed in beside it may take as long
    bench.upload(b"good", student="s2")
    other = kept()
    assert other is not None
    assert bench.row(other.submission_id).student == "s2"


def test_what_cannot_be_started_for_lack_of_room_waits_and_uses_no_try(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("grader.service.worker.slots._ROOM_PAUSE_S", 0.001)
    id_ = bench.upload()
    bench.grader.faults = [NoRoomError("[Errno 11]") for _ in range(10)]
    slot = bench.slot()
    for _ in range(10):
        assert slot.step()
        assert (bench.row(id_).state, bench.row(id_).tries) == (SubmissionState.QUEUED, 0)
        assert not slot.step()  # for a moment it is not due
        bench.clock.advance(1.0)
    assert slot.step()
    assert (bench.row(id_).state, bench.row(id_).tries) == (SubmissionState.GRADED, 1)


def test_a_claim_abandoned_while_its_result_is_stored_costs_the_next_no_try(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    ids = [bench.upload() for _ in range(2)]
    slot, finish = bench.slot(), bench.queue.finish_and_claim

    def slow_finish(claim: Claim, *others: Any) -> tuple[bool, Claim | None]:
        if not bench.grader.aborts:
            slot.abandon(claim)
        return finish(claim, *others)

    monkeypatch.setattr(bench.queue, "finish_and_claim", slow_finish)
    assert slot.step()
    assert [(bench.row(one).state, bench.row(one).tries) for one in ids] == [(SubmissionState.GRADED, 1)] * 2


def test_a_slot_that_is_told_to_stop_takes_nothing_more(bench: Bench) -> None:
    older, newer = bench.upload(), bench.upload()
    slot = bench.slot()
    slot.stop()
    assert slot.step()
    assert bench.row(newer).state is SubmissionState.GRADED
    assert bench.row(older).state is SubmissionState.QUEUED


def test_a_slot_told_to_stop_while_it_stores_a_result_gives_back_what_it_took_with_that(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    older, newer = bench.upload(), bench.upload()
    slot, finish = bench.slot(), bench.queue.finish_and_claim

    def finish_late(*others: Any) -> tuple[bool, Claim | None]:
        slot.stop()
        return finish(*others)

    monkeypatch.setattr(bench.queue, "finish_and_claim", finish_late)
    assert slot.step()
    assert bench.row(newer).state is SubmissionState.GRADED
    assert (bench.row(older).state, bench.row(older).tries) == (SubmissionState.QUEUED, 0)


def test_the_same_bytes_graded_twice_give_the_same_report(bench: Bench) -> None:
    first, second = bench.upload(), bench.upload()
    slot = bench.slot()
    while slot.step():
        bench.clock.advance(1)
    one, two = bench.submissions.report(first), bench.submissions.report(second)
    assert one.content == two.content
    assert one.sha256 == two.sha256


def test_a_crashed_grading_process_is_one_retry(bench: Bench) -> None:
    id_ = bench.upload()
    bench.grader.faults = [InfrastructureError("the grading process ended unexpectedly")]
    slot = bench.slot()
    assert slot.step()
    assert bench.row(id_).state is SubmissionState.QUEUED
    assert "ended unexpectedly" in bench.row(id_).trouble
    assert bench.grader.closed == 1
    assert slot.step()
    row = bench.row(id_)
    assert (row.state, row.tries, row.trouble) == (SubmissionState.GRADED, 2, "")


class Told:
    """Writes down what is counted."""

    def __init__(self) -> None:
        self.gradings: list[tuple[GradeStatus, float | None]] = []
        self.retries = self.lost = 0

    def graded(self, verdict: GradeStatus, grading_s: float, waited_s: float | None) -> None:
        assert grading_s >= 0
        self.gradings.append((verdict, waited_s))

    def retried(self, tries: int = 1) -> None:
        self.retries += tries

    def given_up(self, submissions: int = 1) -> None:
        self.lost += submissions


def test_how_gradings_went_is_counted(bench: Bench) -> None:
    told = Told()
    bench.parts = replace(bench.parts, metrics=told)
    bench.grader.faults = [InfrastructureError("died")] * 3
    slot = bench.slot()
    bench.upload(assignment="straight")
    for _ in range(3):
        assert slot.step()
    bench.grader.faults = []
    bench.upload()
    bench.clock.advance(7)
    assert slot.step()
    assert (told.gradings, told.retries, told.lost) == ([(GradeStatus.GRADED, 7.0)], 2, 1)


@pytest.mark.parametrize(
    "fault", [InfrastructureError("died"), ValueError("nonsense"), MemoryError(), RecursionError()]
)
def test_a_lasting_fault_never_becomes_a_zero(bench: Bench, fault: Exception) -> None:
    id_ = bench.upload()
    bench.grader.faults = [fault] * 10
    slot = bench.slot()
    assert [slot.step() for _ in range(4)] == [True, True, True, False]
    row = bench.row(id_)
    assert (row.state, row.score, row.verdict) == (SubmissionState.INFRASTRUCTURE_ERROR, None, None)


def test_a_vanished_assignment_is_no_fault_of_the_student(bench: Bench) -> None:
    id_ = bench.upload(assignment="withdrawn")
    slot = bench.slot()
    while slot.step():
        pass
    assert bench.row(id_).state is SubmissionState.INFRASTRUCTURE_ERROR
    assert "withdrawn" in bench.row(id_).trouble


def _with_report(**changes: object) -> Callable[[GradingJob], GradingResult]:
    def grading(job: GradingJob) -> GradingResult:
        result = grade(job)
        return replace(result, report=replace(result.report, **changes))

    return grading


@pytest.mark.parametrize("changes", [{"submission_sha256": "0" * 64}, {"assignment": "straight"}])
def test_a_report_of_something_else_is_not_stored(bench: Bench, changes: dict[str, object]) -> None:
    id_ = bench.upload()
    bench.grader = FakeGrader(_with_report(**changes))
    slot = bench.slot()
    while slot.step():
        pass
    assert bench.row(id_).state is SubmissionState.INFRASTRUCTURE_ERROR
    assert bench.submissions.report(id_) is None


def test_no_work_is_taken_without_a_sandbox(bench: Bench) -> None:
    id_ = bench.upload()
    bench.probed = [SandboxState(ready=False, detail="no seccomp")]
    assert not bench.slot().step()
    assert (bench.row(id_).state, bench.row(id_).attempt) == (SubmissionState.QUEUED, 0)


def test_a_sandbox_lost_on_the_way_costs_no_try(bench: Bench) -> None:
    id_ = bench.upload()
    bench.grader.faults = [SandboxUnavailableError("Landlock is gone")]
    slot = bench.slot()
    assert slot.step()
    assert not slot.step()
    assert (bench.row(id_).state, bench.row(id_).tries) == (SubmissionState.QUEUED, 0)


def test_a_probe_that_raises_means_no_sandbox() -> None:
    def probe() -> SandboxState:
        raise OSError("no such file")

    sandbox = SandboxHealth(probe)
    assert not sandbox.try_out()
    assert not sandbox.state.ready
    assert "no such file" in sandbox.state.detail


def test_a_report_is_stored_although_the_database_was_away_for_minutes(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    id_ = bench.upload()
    begun, pauses = bench.clock(), []

    class Reluctant(Queue):
        def finish_and_claim(self, claim, result, assignment, worker, in_turn=False):
            if (bench.clock() - begun).total_seconds() < 300:
                raise InfrastructureError("database is locked")
            return super().finish_and_claim(claim, result, assignment, worker, in_turn)

    def sleep(seconds: float) -> None:
        pauses.append(seconds)
        bench.clock.advance(seconds)

    monkeypatch.setattr("grader.service.worker.slots.time.sleep", sleep)
    queue = Reluctant(bench.database, bench.clock, Retries())
    bench.parts = replace(bench.parts, queue=queue)
    assert bench.slot().step()
    assert bench.row(id_).state is SubmissionState.GRADED
    assert sum(pauses[:4]) < 2  # mostly it was away for a moment only


def test_a_report_whose_storing_was_not_answered_is_counted_once(bench: Bench) -> None:
    told = Told()

    class Unanswered(Queue):
        answers = 0

        def finish_and_claim(self, claim, result, assignment, worker, in_turn=False):
            stored = super().finish_and_claim(claim, result, assignment, worker, in_turn)
            self.answers += 1
            if self.answers == 1:
                raise InfrastructureError("the connection broke during the commit")
            return stored

    queue = Unanswered(bench.database, bench.clock, Retries())
    bench.parts = replace(bench.parts, queue=queue, metrics=told)
    bench.upload()
    assert bench.slot().step()
    assert (len(told.gradings), told.retries) == (1, 0)


def test_a_slot_fenced_off_while_grading_changes_nothing(bench: Bench) -> None:
    id_ = bench.upload()
    slot = bench.slot()
    bench.grader.hold()
    thread = threading.Thread(target=slot.step)
    thread.start()
    assert bench.grader.busy.wait(PATIENCE_S)
    bench.clock.advance(16)
    bench.queue.reconcile()
    other = bench.queue.claim("other")
    assert other is not None
    bench.grader.release()
    thread.join()
    row = bench.row(id_)
    assert (row.state, row.attempt, row.verdict) == (SubmissionState.RUNNING, 2, None)
