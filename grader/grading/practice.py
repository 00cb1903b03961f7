"""Practice runs: scripts that are run for their author's eyes, behind all submissions, and kept nowhere.

A service has some threads for it, each with a grading process of its own that lives while it is used. What runs is
in this process's memory alone, so practice works in every process that serves, whoever grades submissions.
"""

import queue
import threading
import time
from collections.abc import Callable
from concurrent.futures import Future
from dataclasses import dataclass, field

from grader.contracts.errors import RefusedError
from grader.contracts.grading import GradingJob, GradingResult, SupervisedGrader

_GLANCE_S = 0.05
_PATIENCE_S = 2.0  # an idle slot takes what is due within milliseconds
_IDLE_S = 600.0
_WAITING_EACH = 4
_RETRY_AFTER_S = 5


@dataclass(slots=True)
class _Task:
    """A run that somebody waits for; without a job the process is only started."""

    job: GradingJob | None
    answer: Future[GradingResult] = field(default_factory=Future)


class PracticeRuns:
    """Runs scripts for practice, at most `most` at once; thread-safe.

    Args:
        most: threads, and grading processes; 0: practice is not offered.
        make_grader: returns a new grader, which belongs to the thread that calls it.
        submissions_wait: whether a submission is due; then no run begins.
        idle_s: after how long a grading process that nobody uses ends.
        patience_s: how long a run waits for submissions.
    """

    def __init__(
        self,
        most: int,
        make_grader: Callable[[], SupervisedGrader],
        submissions_wait: Callable[[], bool],
        *,
        idle_s: float = _IDLE_S,
        patience_s: float = _PATIENCE_S,
    ) -> None:
        self._most = most
        self._make_grader = make_grader
        self._submissions_wait = submissions_wait
        self._idle_s = idle_s
        self._patience_s = patience_s
        self._tasks: queue.SimpleQueue[_Task | None] = queue.SimpleQueue()
        self._lock = threading.Lock()
        self._under_way = 0
        self._warm = 0
        self._threads: list[threading.Thread] = []
        self._graders: set[SupervisedGrader] = set()
        self._stopping = threading.Event()

    @property
    def offered(self) -> bool:
        """Whether there is practice at all."""
        return self._most > 0

    def warm_up(self) -> None:
        """Start a grading process unless one is there: somebody is about to run a script."""
        with self._lock:
            if not self.offered or self._stopping.is_set() or self._under_way or self._warm:
                return
        self._put(_Task(None))

    def run(self, job: GradingJob) -> "Future[GradingResult]":
        """Run a script as soon as a thread is free and no submission waits.

        The answer fails with a `RefusedError` when submissions wait for longer than the run does, and with what a
        grader raises.

        Raises:
            RefusedError: practice is not offered, or as many runs wait as may.
        """
        if not self.offered or self._stopping.is_set():
            raise RefusedError("practice_off")
        with self._lock:
            if self._under_way >= self._most * (1 + _WAITING_EACH):
                raise RefusedError("practice_full", retry_after_s=_RETRY_AFTER_S)
            self._under_way += 1
        task = _Task(job)
        task.answer.add_done_callback(self._ended)
        self._put(task)
        return task.answer

    def stop(self) -> None:
        """End what runs and start nothing more; from any thread, more than once."""
        self._stopping.set()
        with self._lock:
            graders, threads = set(self._graders), list(self._threads)
        for grader in graders:
            grader.abort()
        for _ in threads:
            self._tasks.put(None)

    def close(self) -> None:
        """Do what `stop` does, and wait until the grading processes have ended."""
        self.stop()
        for thread in self._threads:
            thread.join()

    def _put(self, task: _Task) -> None:
        with self._lock:
            if len(self._threads) < self._most:
                number = len(self._threads)
                thread = threading.Thread(target=self._work, name=f"grader-practice-{number}", daemon=True)
                self._threads.append(thread)
                thread.start()
        self._tasks.put(task)

    def _ended(self, _: object) -> None:
        with self._lock:
            self._under_way -= 1

    def _work(self) -> None:
        """Own one grader: it is started for the first task and ends when nothing came for a while."""
        grader: SupervisedGrader | None = None
        while True:
            try:
                task = self._tasks.get(timeout=None if grader is None else self._idle_s)
            except queue.Empty:
                task = None
            if task is not None and not self._stopping.is_set():
                grader = grader or self._opened()
                self._do(task, grader)
                continue
            if grader is not None:
                self._closed(grader)
                grader = None
            if task is not None and task.answer.set_running_or_notify_cancel():
                task.answer.set_exception(RefusedError("practice_off"))
            elif self._stopping.is_set():
                return

    def _opened(self) -> SupervisedGrader:
        grader = self._make_grader()
        with self._lock:
            self._graders.add(grader)
            self._warm += 1
        return grader

    def _closed(self, grader: SupervisedGrader) -> None:
        with self._lock:
            self._graders.discard(grader)
            self._warm -= 1
        grader.close()

    def _do(self, task: _Task, grader: SupervisedGrader) -> None:
        try:
            grader.start()
            if task.job is None or not task.answer.set_running_or_notify_cancel():
                return
            self._let_submissions_go_first()
            task.answer.set_result(grader.grade(task.job))
        except Exception as error:  # whoever waits is told, whatever it is
            if not isinstance(error, RefusedError):
                grader.close()
            if task.answer.running() or task.answer.set_running_or_notify_cancel():
                task.answer.set_exception(error)

    def _let_submissions_go_first(self) -> None:
        until_s = time.monotonic() + self._patience_s
        while self._submissions_wait():
            if time.monotonic() >= until_s:
                raise RefusedError("practice_waits", retry_after_s=_RETRY_AFTER_S)
            self._stopping.wait(_GLANCE_S)
            if self._stopping.is_set():
                raise RefusedError("practice_off")
