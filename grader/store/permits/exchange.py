"""Where a permit, which comes by an event loop, meets the thread of a slot, which uses it."""

import threading
from collections import deque
from collections.abc import Callable
from concurrent.futures import Future


class Exchange:
    """Hands permits to slots. Each permit is answered exactly once: whether it was used.

    Procrastinate cancels a job that somebody asked it to abort; no slot may end by that.
    """

    def __init__(self) -> None:
        self._changed = threading.Condition()
        self._offered: deque[Future[bool]] = deque()
        self._closed = False

    def offer(self) -> Future[bool]:
        """Offer a permit; the result says whether a slot found something to grade with it."""
        answer: Future[bool] = Future()
        with self._changed:
            if self._closed:
                answer.set_result(False)
            else:
                self._offered.append(answer)
                self._changed.notify()
        return answer

    def serve(self, step: Callable[[], bool]) -> None:
        """Call `step` once for each permit, in the calling thread, until the exchange closes."""
        while (answer := self._next()) is not None:
            used = False
            try:
                used = step()
            finally:
                answer.set_result(used)

    def close(self) -> None:
        """Take no more permits and return those that no slot has yet. What slots do is not disturbed."""
        with self._changed:
            self._closed = True
            for answer in self._offered:
                if answer.set_running_or_notify_cancel():
                    answer.set_result(False)
            self._offered.clear()
            self._changed.notify_all()

    def _next(self) -> Future[bool] | None:
        """Wait for a permit that is still wanted; from then on it cannot be withdrawn. None: there are no more."""
        with self._changed:
            while True:
                self._changed.wait_for(lambda: self._closed or self._offered)
                if self._closed:
                    return None
                answer = self._offered.popleft()
                if answer.set_running_or_notify_cancel():
                    return answer
