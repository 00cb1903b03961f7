"""The threads that run scripts for practice."""

import gc
import threading
import weakref

import pytest

from grader.contracts.errors import InfrastructureError, RefusedError
from grader.contracts.grading import GradingJob, RunProgress
from grader.grading.practice import PracticeRun, PracticeRuns
from tests.fakes.grading import FakeGrader, assignment
from tests.fakes.waiting import PATIENCE_S, wait_until


def job(name: str = "a.py") -> GradingJob:
    return GradingJob(file_name=name, source=b"good\n", assignment=assignment("square", 1))


def test_one_process_serves_run_after_run_and_ends_when_nobody_comes() -> None:
    made: list[FakeGrader] = []

    def make() -> FakeGrader:
        made.append(FakeGrader())
        return made[-1]

    runs = PracticeRuns(1, make, lambda: False, idle_s=0.01)
    for name in ("a.py", "b.py"):
        assert runs.run(job(name)).answer.result(PATIENCE_S)
    wait_until(lambda: made[-1].closed == 1)
    runs.warm_up()
    wait_until(lambda: made[-1].starts > 0 and made[-1].closed == 1)
    runs.close()
    assert {one.closed for one in made} == {1}


def test_no_more_wait_than_may() -> None:
    grader = FakeGrader()
    grader.hold()
    runs = PracticeRuns(1, lambda: grader, lambda: False)
    answers = [runs.run(job()).answer for _ in range(5)]
    with pytest.raises(RefusedError) as refused:
        runs.run(job())
    assert refused.value.code == "practice_full"
    grader.release()
    assert all(one.result(PATIENCE_S) for one in answers)
    assert runs.run(job()).answer.result(PATIENCE_S)
    runs.close()


def test_who_went_away_is_left_out() -> None:
    grader = FakeGrader()
    grader.hold()
    runs = PracticeRuns(1, lambda: grader, lambda: False)
    first, second, third = (runs.run(job(name)).answer for name in ("a.py", "b.py", "c.py"))
    assert grader.busy.wait(PATIENCE_S)
    assert second.cancel()
    grader.release()
    assert first.result(PATIENCE_S)
    assert third.result(PATIENCE_S)
    assert grader.graded == ["a.py", "c.py"]
    runs.close()


def test_a_run_waits_until_no_submission_does() -> None:
    waiting = threading.Event()
    waiting.set()
    looked = threading.Event()

    def submissions_wait() -> bool:
        looked.set()
        return waiting.is_set()

    grader = FakeGrader()
    runs = PracticeRuns(1, lambda: grader, submissions_wait, patience_s=PATIENCE_S)
    answer = runs.run(job()).answer
    assert looked.wait(PATIENCE_S)
    assert not grader.busy.is_set()
    waiting.clear()
    assert answer.result(PATIENCE_S)
    runs.close()


def test_a_process_that_fails_is_replaced() -> None:
    grader = FakeGrader()
    grader.faults.append(InfrastructureError("gone"))
    runs = PracticeRuns(1, lambda: grader, lambda: False)
    with pytest.raises(InfrastructureError, match="gone"):
        runs.run(job()).answer.result(PATIENCE_S)
    assert grader.closed == 1
    assert runs.run(job()).answer.result(PATIENCE_S)
    runs.close()


def test_stopping_ends_what_runs_and_what_waits() -> None:
    grader = FakeGrader()
    grader.hold()
    runs = PracticeRuns(1, lambda: grader, lambda: False)
    running, waiting = runs.run(job()).answer, runs.run(job()).answer
    assert grader.busy.wait(PATIENCE_S)
    runs.close()
    with pytest.raises(InfrastructureError):
        running.result(PATIENCE_S)
    with pytest.raises(RefusedError, match="practice_off"):
        waiting.result(PATIENCE_S)
    with pytest.raises(RefusedError, match="practice_off"):
        runs.run(job())
    assert grader.aborts == 1


def test_it_says_how_many_are_before_a_run_and_how_far_it_is() -> None:
    grader = FakeGrader()
    grader.progress.append(RunProgress(t_ns=3, stdout="a\n"))
    grader.hold()
    runs = PracticeRuns(1, lambda: grader, lambda: False)
    first, second, third = (runs.run(job(name)) for name in ("a.py", "b.py", "c.py"))
    assert grader.busy.wait(PATIENCE_S)
    assert [runs.where(one) for one in (first, second, third)] == [grader.progress[0], 1, 2]
    second.answer.cancel()
    assert runs.where(third) == 1
    grader.release()
    assert third.answer.result(PATIENCE_S)
    runs.close()


def test_nothing_of_a_run_that_ended_is_kept() -> None:
    runs = PracticeRuns(1, FakeGrader, lambda: False)
    run = runs.run(job())
    assert run.answer.result(PATIENCE_S)
    answer = weakref.ref(run.answer)  # which holds its result
    gc.disable()  # nor is it left to the collector
    try:
        del run
        wait_until(lambda: answer() is None)
    finally:
        gc.enable()
    runs.close()


def test_none_are_offered() -> None:
    runs = PracticeRuns(0, FakeGrader, lambda: False)
    runs.warm_up()
    with pytest.raises(RefusedError, match="practice_off"):
        runs.run(job())
    runs.close()


def test_a_run_that_comes_while_it_stops_keeps_nobody_waiting() -> None:
    class Stopping(PracticeRuns):
        def _put(self, run: PracticeRun) -> None:
            if run.job is not None and run.job.file_name == "late.py":
                self.close()
            super()._put(run)

    runs = Stopping(1, FakeGrader, lambda: False)
    assert runs.run(job()).answer.result(PATIENCE_S)
    with pytest.raises(RefusedError) as refused:
        runs.run(job("late.py")).answer.result(PATIENCE_S)
    assert refused.value.code == "practice_off"
    runs.close()
