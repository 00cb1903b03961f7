"""What the service sends unasked: scores to platforms, notices to groups and people."""

import logging
import threading
from collections.abc import Callable

from grader.use_cases.notice_sending import send_notices
from grader.use_cases.score_sending import send_scores
from grader.use_cases.services import Services

_log = logging.getLogger(__name__)
_SCORES_EVERY_S = 10.0
_NOTICES_EVERY_S = 60.0  # each looks at whole classes, and nobody waits for one
_END_S = 5.0
_Send = Callable[[Services, Callable[[], bool]], int]


class Sender:
    """Sends while its context is open: scores and notices each in a thread, so that neither waits for the other.

    A failure of it fails no grading and no request.
    """

    def __init__(self, services: Services) -> None:
        self._services = services
        self._stopped = threading.Event()
        what: list[tuple[str, _Send, float]] = [("notices", send_notices, _NOTICES_EVERY_S)]
        if services.providers.public_url:  # without it no platform leads here
            what.append(("scores", send_scores, _SCORES_EVERY_S))
        self._threads = [
            threading.Thread(target=self._run, args=work, name=f"{work[0]} sender", daemon=True)
            for work in what
        ]

    def __enter__(self) -> None:
        """Begin."""
        for thread in self._threads:
            thread.start()

    def __exit__(self, *_: object) -> None:
        """End after what is being sent; what takes too long is sent again by the next process."""
        self._stopped.set()
        for thread in self._threads:
            thread.join(_END_S)

    def _run(self, name: str, send: _Send, every_s: float) -> None:
        while not self._stopped.wait(every_s):
            try:
                send(self._services, self._stopped.is_set)
            except Exception:  # a thread that ended would send nobody's any more
                _log.warning("%s could not be looked at; tried again soon", name, exc_info=True)
