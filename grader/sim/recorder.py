"""Records an episode: the car's motion, and the script's output. Bounded, whatever the script does."""

import re
from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np

from grader.contracts.errors import ProtocolError
from grader.contracts.outcome import LOG_LEVELS, LogRecord, Note
from grader.contracts.trajectory import Command, Contact, Trajectory
from grader.sim.car import PlanarPose
from grader.sim.cdr import decode

MAX_CONTACTS: Final = 1_000
LOG: Final = "rcl_interfaces/msg/Log"
MAX_LOGS: Final = 2_000
MAX_NOTES: Final = 100
MAX_TEXT: Final = 1_000  # characters kept of one message
MAX_LOG_TEXT: Final = 500_000  # characters of all records, names included: each is stored with the report

_CODE: Final = re.compile(r"[a-z][a-z0-9_]{0,63}")
_MOST_RECORDED: Final = 1e6
"""Of a command's components, so that what is drawn and printed stays readable; no car obeys more."""


class Recorder:
    """The growing trajectory of one episode, its size bounded by the horizon.

    A jump is two samples: where the car was taken up, and one nanosecond later
    where it was put down, so that times stay strictly increasing and no motion hides in between.
    """

    def __init__(self) -> None:
        self._samples: list[tuple[int, float, float, float, float, float]] = []
        self._t_ns = -1
        self._jumps: list[int] = []
        self._commands: list[Command] = []
        self._command_update = -1
        self._contacts: list[Contact] = []
        self._touching: dict[str, tuple[int, int]] = {}

    def sample(self, t_ns: int, pose: PlanarPose, v_mps: float, w_radps: float) -> None:
        """Add the state at `t_ns`, unless that instant has a sample. The heading may be folded."""
        if t_ns > self._t_ns:
            self._t_ns = t_ns
            self._samples.append((t_ns, *pose, v_mps, w_radps))

    def jump(self, t_ns: int, pose: PlanarPose, v_mps: float, w_radps: float) -> None:
        """Add the pose that the car was put into after `t_ns`. The pose it left must have been sampled."""
        if self._t_ns > t_ns:  # put down twice between two updates: only the last place counts
            self._samples.pop()
        else:
            self._jumps.append(len(self._samples))
        self._t_ns = t_ns + 1
        self._samples.append((self._t_ns, *pose, v_mps, w_radps))

    def command(self, last_ns: Mapping[int, int], v_mps: float, w_radps: float) -> None:
        """Add a command that came once or several times: for each update, in order, when it last came before it.

        Of several between two updates the last is kept: 60 a second are enough to show, and to obey at once.
        """
        if next(iter(last_ns)) == self._command_update:
            self._commands.pop()
        self._command_update = next(reversed(last_ns))
        self._commands += [Command(t_ns, v_mps, w_radps) for t_ns in last_ns.values()]

    def contact(self, start_ns: int, end_ns: int, wall: str) -> None:
        """Note that `wall` held the car from `start_ns` to `end_ns`. Calls come in order of time."""
        start, last = self._touching.get(wall, (start_ns, end_ns))
        if start_ns > last:
            self._close(wall)
            start = start_ns
        self._touching[wall] = (start, end_ns)

    def finish(self, end_ns: int) -> Trajectory:
        """Return everything recorded. At least one sample must have been taken."""
        for wall in tuple(self._touching):
            self._close(wall)
        t_ns, *columns = zip(*self._samples, strict=True)
        x_m, y_m, heading_rad, v_mps, w_radps = (np.array(column, dtype=np.float64) for column in columns)
        return Trajectory(
            t_ns=np.array(t_ns, dtype=np.int64),
            x_m=x_m,
            y_m=y_m,
            # At most 100 rad/s for 16 ms between samples: less than half a turn, so the nearest is right.
            heading_rad=np.unwrap(heading_rad),
            v_mps=v_mps,
            w_radps=w_radps,
            end_ns=max(end_ns, self._t_ns),
            jumps=tuple(self._jumps),
            contacts=tuple(sorted(self._contacts, key=lambda contact: contact.start_ns)),
            commands=tuple(self._commands),
        )

    def _close(self, wall: str) -> None:
        start_ns, end_ns = self._touching.pop(wall)
        if len(self._contacts) < MAX_CONTACTS:
            self._contacts.append(Contact(start_ns=start_ns, end_ns=end_ns, wall=wall))


class Unrecorded(Recorder):
    """Keeps nothing of what nobody looks at afterwards."""

    def sample(self, t_ns: int, pose: PlanarPose, v_mps: float, w_radps: float) -> None:
        """Drop it."""

    def jump(self, t_ns: int, pose: PlanarPose, v_mps: float, w_radps: float) -> None:
        """Drop it."""

    def command(self, last_ns: object, v_mps: float, w_radps: float) -> None:
        """Drop it."""

    def contact(self, start_ns: int, end_ns: int, wall: str) -> None:
        """Drop it."""


class Journal:
    """Collects log records and notes; what does not fit is counted or left out."""

    def __init__(self) -> None:
        self._logs: list[LogRecord] = []
        self._notes: dict[Note, None] = {}
        self._log_characters = 0
        self.logs_dropped = 0

    @property
    def logs(self) -> tuple[LogRecord, ...]:
        """Records in order of time."""
        return tuple(self._logs)

    @property
    def notes(self) -> tuple[Note, ...]:
        """Notes in the order in which they were first made."""
        return tuple(self._notes)

    def log(self, t_ns: int, payload: bytes) -> None:
        """Take a message on /rosout. Raises ProtocolError: it is not a readable log message."""
        if len(self._logs) >= MAX_LOGS or self._log_characters >= MAX_LOG_TEXT:
            self.logs_dropped += 1
            return
        values = decode(LOG, payload)
        level = values["level"]
        if level not in LOG_LEVELS:
            raise ProtocolError(f"log record of level {level}")
        name, message = values["name"][:MAX_TEXT], values["msg"][:MAX_TEXT]
        self._log_characters += len(name) + len(message)
        self._logs.append(LogRecord(t_ns=t_ns, level=level, name=name, message=message))

    def note(self, code: str, text: str = "") -> None:
        """Make a note; the same one twice is made once. Raises ProtocolError: `code` is not a plain word."""
        if not _CODE.fullmatch(code):
            raise ProtocolError("NOTE.code is not a plain word")
        if len(self._notes) < MAX_NOTES:
            self._notes[Note(code=code, text=text[:MAX_TEXT])] = None


class ReceivedCommands:
    """Counts commands and hands them to the recorder.

    Attributes:
        count, nonfinite, lateral, clamped: commands received, and how many of them had a NaN or infinite
            component, a sideways one, or one beyond the car's bounds.
        motions: how many were no stop.
        contested: how many drives came in one update with a turn on the spot, or the reverse.
        first_ns, last_ns: when the first and the last one came.
        longest_wait: for how many updates one waited beyond the first that could take it.
    """

    def __init__(self, recorder: Recorder) -> None:
        self._recorder = recorder
        self.count = self.nonfinite = self.lateral = self.clamped = self.motions = 0
        self.contested = self.longest_wait = 0
        self._last: tuple[int, bool] | None = None  # the last motion's update, and whether it was a drive
        self.first_ns: int | None = None
        self.last_ns: int | None = None

    def take(
        self,
        times_ns: Sequence[int],
        updates: Sequence[int],
        asked: tuple[float, float, float],
        obeyed: tuple[float, float, bool],
    ) -> None:
        """Take a command that came once or several times in a row.

        Args:
            times_ns: when it came, in order.
            updates: for each time, which update of the car is the first after it.
            asked: its speeds ahead and to the left, and its yaw rate.
            obeyed: speed and yaw rate as the car takes them, and whether the command was finite.
        """
        v, w, finite = obeyed
        ahead, left, turn = asked
        times = len(times_ns)
        if not finite:
            self.nonfinite += times
        elif v != ahead or w != turn:
            self.clamped += times
        if v or w:
            self.motions += times
        if bool(v) != bool(w):
            self.contested += self._last == (updates[0], not v)  # only the first follows one of another kind
            self._last = (updates[-1], bool(v))
        if left:
            self.lateral += times
        self.count += times
        if self.first_ns is None:
            self.first_ns = times_ns[0]
        self.last_ns = times_ns[-1]
        command = (_recorded(ahead), _recorded(turn)) if finite else (v, w)
        self._recorder.command(dict(zip(updates, times_ns, strict=True)), *command)


def _recorded(asked: float) -> float:
    if -_MOST_RECORDED <= asked <= _MOST_RECORDED:
        return asked
    return min(max(asked, -_MOST_RECORDED), _MOST_RECORDED)
