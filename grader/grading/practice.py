"""Practice runs: scripts that run for their author's eyes. Submissions go first, and nothing is stored.

Each thread for practice has a grading process of its own, which ends when it has been idle for a while. A practice
run exists only in the memory of the serving process, so practice needs no worker.
"""

import queue
import threading
import time
from collections.abc import Callable
from concurrent.futures import Future
from contextlib import suppress
from dataclasses import dataclass, field

from grader.contracts.errors import RefusedError
from grader.contracts.grading import GradingJob, GradingResult, RunProgress
from grader.grading.slot import Slot

_GLANCE_S = 0.05  # between two looks at whether a submission still waits
_PATIENCE_S = 2.0  # an idle slot claims a submission within milliseconds
_IDLE_S = 600.0
_WAITING_EACH = 4
_RETRY_AFTER_S = 5


@dataclass(slots=True, eq=False)
class PracticeRun:
    """A run that somebody waits for.

    Attributes:
        job: what to run; None: only start a grading process.
        answer: fails with a `RefusedError` if submissions waited for longer than `patience_s`, else with the
            grader's exception. Cancelling it prevents a run that has not begun, and ends none.
        progress: how far the run is; None before it has begun.
    """

    job: GradingJob | None
    answer: Future[GradingResult] = field(default_factory=Future)
    progress: RunProgress | None = None


class PracticeRuns:
    """Runs scripts for practice, at most `most` at once; thread-safe.

    Args:
        most: threads, and grading processes; 0: practice is not offered.
        make_grader: returns a new grader, which belongs to the thread that calls it.
        submissions_wait: returns whether a submission is due; while one is, no run begins.
        idle_s: how long a grading process is kept without a run.
        patience_s: how long a run waits for submissions to be claimed before it is refused.
    """

    def __init__(
        self,
        most: int,
        make_grader: Callable[[], Slot],
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
        self._tasks: queue.SimpleQueue[PracticeRun | None] = queue.SimpleQueue()
        self._lock = threading.Lock()
        self._under_way: list[PracticeRun] = []  # in the order in which they came
        self._threads: list[threading.Thread] = []
        self._graders: set[Slot] = set()
        self._stopping = threading.Event()

    @property
    def offered(self) -> bool:
        """Whether there is practice at all."""
        return self._most > 0

    def warm_up(self) -> None:
        """Start a grading process unless one runs already, because somebody will probably run a script soon."""
        with self._lock:
            if not self.offered or self._stopping.is_set() or self._under_way or self._graders:
                return
        self._put(PracticeRun(None))

    def run(self, job: GradingJob) -> PracticeRun:
        """Run a script as soon as a thread is free and no submission waits.

        Raises RefusedError: practice is not offered, or too many runs wait.
        """
        if not self.offered or self._stopping.is_set():
            raise RefusedError("practice_off")
        with self._lock:
            if len(self._under_way) >= self._most * (1 + _WAITING_EACH):
                raise RefusedError("practice_full", retry_after_s=_RETRY_AFTER_S)
            run = PracticeRun(job)
            self._under_way.append(run)
        run.answer.add_done_callback(self._ended)
        self._put(run)
        return run

    def where(self, run: PracticeRun) -> RunProgress | int:
        """Return the progress of a run that has begun; of any other, how many runs must end before it begins."""
        with self._lock:
            if run.progress is not None or run not in self._under_way:
                return run.progress or RunProgress()
            return max(self._under_way.index(run) - self._most + 1, 0)

    def stop(self) -> None:
        """Abort what runs and start nothing more. Thread-safe and idempotent."""
        with self._lock:
            self._stopping.set()
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

    def _put(self, run: PracticeRun) -> None:
        with self._lock:
            stopped = self._stopping.is_set()
            if not stopped and len(self._threads) < self._most:
                number = len(self._threads)
                thread = threading.Thread(target=self._work, name=f"grader-practice-{number}", daemon=True)
                self._threads.append(thread)
                thread.start()
            if not stopped:
                self._tasks.put(run)
        if stopped:  # no thread would ever take it
            run.answer.set_exception(RefusedError("practice_off"))

    def _ended(self, answer: "Future[GradingResult]") -> None:
        with self._lock:
            self._under_way = [run for run in self._under_way if run.answer is not answer]

    def _work(self) -> None:
        """Take runs one by one, with a grader that is made for the first and closed after `idle_s` without any."""
        grader: Slot | None = None
        while True:
            run = None  # do not keep the last run alive while waiting for the next one
            with suppress(queue.Empty):
                run = self._tasks.get(timeout=None if grader is None else self._idle_s)
            if run is not None and not self._stopping.is_set():
                grader = grader or self._opened()
                self._do(run, grader)
                continue
            if grader is not None:
                self._closed(grader)
                grader = None
            if run is not None and run.answer.set_running_or_notify_cancel():
                run.answer.set_exception(RefusedError("practice_off"))
            elif self._stopping.is_set():
                return

    def _opened(self) -> Slot:
        grader = self._make_grader()
        with self._lock:
            self._graders.add(grader)
        return grader

    def _closed(self, grader: Slot) -> None:
        with self._lock:
            self._graders.discard(grader)
        grader.close()

    def _do(self, run: PracticeRun, grader: Slot) -> None:
        def tell(progress: RunProgress) -> None:
            run.progress = progress

        try:
            grader.start()
            if run.job is None or not run.answer.set_running_or_notify_cancel():
                return
            self._let_submissions_go_first()
            run.answer.set_result(grader.grade(run.job, lambda: tell(RunProgress()), tell))
        except Exception as error:  # of any kind: whoever waits for the answer gets it
            if not isinstance(error, RefusedError):
                grader.close()
            if run.answer.running() or run.answer.set_running_or_notify_cancel():
                run.answer.set_exception(error)

    def _let_submissions_go_first(self) -> None:
        until_s = time.monotonic() + self._patience_s
        while not self._stopping.is_set():
            if not self._submissions_wait():
                return
            if time.monotonic() >= until_s:
                raise RefusedError("practice_waits", retry_after_s=_RETRY_AFTER_S)
            self._stopping.wait(_GLANCE_S)
        raise RefusedError("practice_off")
