"""The worker threads of a MultiThreadedExecutor, taking turns in virtual time."""

from __future__ import annotations

from collections import deque

from rclpy._kernel import kernel

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any


class WorkerPool:
    """Runs callables in up to `size` threads, started when they are needed.

    What a callable raises is lost, as in a thread pool nobody asks for results. The end of the program waits for
    what has been submitted, as it does for upstream's thread pool.
    """

    def __init__(self, size: int) -> None:
        if size <= 0:
            raise ValueError("max_workers must be greater than 0")
        self._max_workers = size
        self._work: deque[Callable[[], Any]] = deque()
        self._idle = 0
        self._started = 0
        self._busy = 0

    def submit(self, work: Callable[[], Any]) -> None:
        """Have `work` called in one of the threads."""
        self._work.append(work)
        if self._idle < len(self._work) and self._started < self._max_workers:
            self._start()

    def _start(self) -> None:
        import threading

        if not self._started:
            target: Any = threading
            target._register_atexit(self._finish)
        self._started += 1
        threading.Thread(
            target=self._run, name=f"ThreadPoolExecutor-0_{self._started - 1}", daemon=True
        ).start()

    def _run(self) -> None:
        while True:
            self._idle += 1
            kernel.wait(lambda: bool(self._work), None, "a worker of the executor", idle=True)
            self._idle -= 1
            if self._work:
                work = self._work.popleft()
                self._busy += 1
                try:
                    work()
                except BaseException:  # noqa: S110
                    pass
                finally:
                    self._busy -= 1

    def _finish(self) -> None:
        why = "the end of the program waits for callbacks of the executor's threads"
        kernel.wait(lambda: not self._busy and not self._work, None, why)
