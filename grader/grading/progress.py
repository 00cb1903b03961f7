"""How far a run has come, told while it goes on: to whoever waits for a practice run, not for a grading."""

import time
from collections.abc import Callable
from typing import Final

from grader.contracts.assignment import Distro
from grader.contracts.grading import RunProgress
from grader.grading.outcome import masked_stream
from grader.sandbox import Jail
from grader.sim.episode import Episode

_EVERY_S: Final = 0.25
_MOST_CHARACTERS: Final = 2_000


class ProgressLink:
    """A link to a run's process that tells how far the run is, four times a second at most.

    It tells between two frames of the script, so that nothing runs beside the episode; of a script that sends none
    for a while nothing is told meanwhile. The run itself is the same as without it.
    """

    def __init__(
        self,
        jail: Jail,
        episode: Episode,
        tell: Callable[[RunProgress], None],
        distro: Distro,
        clock_s: Callable[[], float] = time.monotonic,
    ) -> None:
        self._jail = jail
        self._episode = episode
        self._tell = tell
        self._distro = distro
        self._clock_s = clock_s
        self._next_s = clock_s() + _EVERY_S

    def send(self, body: bytes) -> None:
        """Send one frame, as the jail does."""
        self._jail.send(body)

    def receive(self) -> bytes | None:
        """Return the next frame, as the jail does."""
        body = self._jail.receive()
        now_s = self._clock_s()
        if now_s >= self._next_s:
            self._next_s = now_s + _EVERY_S
            stdout, stderr = (masked_stream(stream, self._distro).text for stream in self._jail.printed())
            now_ns = self._episode.now_ns
            self._tell(RunProgress(t_ns=now_ns, stdout=last_lines(stdout), stderr=last_lines(stderr)))
        return body


def last_lines(text: str, most_characters: int = _MOST_CHARACTERS) -> str:
    """Return the last whole lines of a text; of a line that is still being written, nothing."""
    whole = text[: text.rfind("\n") + 1]
    if len(whole) <= most_characters:
        return whole
    return whole[-most_characters:].partition("\n")[2]
