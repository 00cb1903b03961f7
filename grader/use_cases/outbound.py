"""What the service tells others by itself: platforms their scores, groups and people their notices."""

import logging
import threading
from collections.abc import Callable

from grader.use_cases.notice_sending import send_notices
from grader.use_cases.score_sending import send_scores
from grader.use_cases.services import Services

_log = logging.getLogger(__name__)
_EVERY_S = 10.0
_Send = Callable[[Services, Callable[[], bool]], int]


class Sender:
    """Sends while its context is open: scores and notices each in a thread, so that neither waits for the other.

    A failure of it fails no grading and no request.
    """

    def __init__(self, services: Services) -> None:
        self._services = services
        self._stopped = threading.Event()
        what = {"notices": send_notices}
        if services.providers.public_url:  # without it no platform leads here
            what["scores"] = send_scores
        self._threads = [
            threading.Thread(target=self._run, args=(name, send), name=f"{name} sender", daemon=True)
            for name, send in what.items()
        ]

    def __enter__(self) -> None:
        """Begin."""
        for one in self._threads:
            one.start()

    def __exit__(self, *_: object) -> None:
        """End after what is being sent."""
        self._stopped.set()
        for one in self._threads:
            one.join()

    def _run(self, name: str, send: _Send) -> None:
        while not self._stopped.wait(_EVERY_S):
            try:
                send(self._services, self._stopped.is_set)
            except Exception:  # a thread that ended would send nobody's any more
                _log.warning("%s could not be looked at; tried again soon", name, exc_info=True)
