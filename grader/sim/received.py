"""The velocity commands that came, for the trajectory and for the account of the run."""

from collections.abc import Sequence
from typing import Final

from grader.contracts.trajectory import Command
from grader.sim.recorder import Recorder

_MOST_RECORDED: Final = 1e6
"""Of a command's components, so that what is drawn and printed stays readable; no car obeys more."""


class ReceivedCommands:
    """Counts commands and hands them to the recorder.

    Attributes:
        count, nonfinite, lateral, clamped: commands received, and how many of them had a NaN or infinite
            component, a sideways one, or one beyond the car's bounds.
        motions: how many were no stop.
        contested: how many drives came in one update with a turn on the spot, or the reverse.
        first_ns, last_ns: when the first and the last one came.
    """

    def __init__(self, recorder: Recorder) -> None:
        self._recorder = recorder
        self.count = self.nonfinite = self.lateral = self.clamped = self.motions = 0
        self.contested = 0
        self._last: tuple[int, bool] | None = None  # the last motion's update, and whether it was a drive
        self.first_ns: int | None = None
        self.last_ns: int | None = None

    def take(
        self,
        came: Sequence[tuple[int, int]],
        asked: tuple[float, float, float],
        obeyed: tuple[float, float, bool],
    ) -> None:
        """Take a command that came once or several times in a row.

        Args:
            came: for each time, which update of the car acts on it (of several commands the last counts), and when
                it was; in order.
            asked: its speeds ahead and to the left, and its yaw rate.
            obeyed: speed and yaw rate as the car takes them, and whether the command was finite.
        """
        v, w, finite = obeyed
        ahead, left, turn = asked
        times = len(came)
        if not finite:
            self.nonfinite += times
        elif v != ahead or w != turn:
            self.clamped += times
        if v or w:
            self.motions += times
        if bool(v) != bool(w):
            self.contested += self._last == (came[0][0], not v)  # only the first follows one of another kind
            self._last = (came[-1][0], bool(v))
        if left:
            self.lateral += times
        self.count += times
        if self.first_ns is None:
            self.first_ns = came[0][1]
        self.last_ns = came[-1][1]
        told = (_recorded(ahead), _recorded(turn)) if finite else (v, w)
        for update, t_ns in came:
            self._recorder.command(update, Command(t_ns, *told))


def _recorded(asked: float) -> float:
    if -_MOST_RECORDED <= asked <= _MOST_RECORDED:
        return asked
    return min(max(asked, -_MOST_RECORDED), _MOST_RECORDED)
