"""The PyBullet calls that a script has recorded, as the trusted side takes them: read strictly, kept as they came.

What comes in was written by a hostile process. Each call is read with every length checked, numbers must be
finite and within bounds, and only functions of the table can be named. Any such call is allowed: a second confined
process carries it out (`grader.sim.replay`). This module finds the calls that do what no motor does: `tricks`.
"""

import math
import re
import struct
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Final, NamedTuple

from grader.contracts.errors import ProtocolError
from grader.contracts.replay import Trick, TrickKind

_RECORDED: Final = Path(__file__).resolve().parents[1] / "shim" / "rclpy" / "_pybullet" / "recorded.txt"
FUNCTIONS: Final = tuple(_RECORDED.read_text(encoding="ascii").split())
"""By their numbers on the wire; the shim reads the same file."""

MOST_CALLS: Final = 150_000
MOST_BYTES: Final = 16 * 1024 * 1024
MOST_VALUES: Final = 20_000
"""Of one call."""

STEP_S: Final = 1.0 / 240.0
LEAST_STEP_S, MOST_STEP_S = 1.0 / 1000.0, 1.0 / 30.0

_NONE, _FALSE, _TRUE, _INTEGER, _NUMBER, _TEXT, _LIST, _NUMBERS = range(8)
_MOST_DEPTH: Final = 4
_MOST_TEXT_BYTES: Final = 1_024
_MOST_ARGUMENTS: Final = 32
_NAME: Final = re.compile(r"[A-Za-z][A-Za-z0-9_]{0,39}")
_COUNT: Final = struct.Struct("<H")
_INT: Final = struct.Struct("<q")
_FLOAT: Final = struct.Struct("<d")

Value = None | bool | int | float | str | list["Value"]
_MOST_TRICKS: Final = 100
_SLACK_NS: Final = 1_000_000_000
_WORLD: Final = -1
_NATURE: Final = (
    "mass",
    "localInertiaDiagonal",
    "anisotropicFriction",
    "jointLowerLimit",
    "jointUpperLimit",
    "jointLimitForce",
)


class Call(NamedTuple):
    """One call: its function and what was passed."""

    name: str
    args: tuple[Value, ...]
    options: Mapping[str, Value]

    def value(self, place: int, name: str) -> Value:
        """Return an argument by its place or its name; None: it was not passed."""
        if name in self.options:
            return self.options[name]
        return self.args[place] if place < len(self.args) else None

    def number(self, place: int, name: str, default: float = 0.0) -> float:
        """Return a number by its place or its name; `default` if it was not passed or is no number."""
        value = self.value(place, name)
        return float(value) if isinstance(value, int | float) else default

    @property
    def client(self) -> int:
        """The physics client that it addresses; only the calls of the first one count."""
        place = 0 if self.name in ("stepSimulation", "disconnect") else len(self.args)
        return int(self.number(place, "physicsClientId"))


class _Reader:
    """Reads the calls of one frame; every error names the call."""

    def __init__(self, data: bytes, first: int) -> None:
        self._data = data
        self._at = 0
        self._number = first
        self._values = 0

    def calls(self) -> list[Call]:
        found = []
        while self._at < len(self._data):
            self._values = 0
            found.append(self._call())
            self._number += 1
        return found

    def _call(self) -> Call:
        function = self._byte()
        if function >= len(FUNCTIONS):
            raise self._error(f"names the unknown function {function}")
        args = tuple(self._value(0) for _ in range(self._counted(self._byte(), _MOST_ARGUMENTS)))
        options: dict[str, Value] = {}
        for _ in range(self._counted(self._byte(), _MOST_ARGUMENTS)):
            try:
                name = self._bytes(self._byte()).decode("ascii")
            except UnicodeDecodeError:
                raise self._error("has an argument whose name is not ASCII") from None
            if not _NAME.fullmatch(name) or name in options:
                raise self._error("has an impossible name of an argument")
            options[name] = self._value(0)
        return Call(FUNCTIONS[function], args, options)

    def _value(self, depth: int) -> Value:
        self._values += 1
        if self._values > MOST_VALUES:
            raise self._error(f"has more than {MOST_VALUES} values")
        kind = self._byte()
        if kind in (_NONE, _FALSE, _TRUE):
            return (None, False, True)[kind]
        if kind == _INTEGER:
            return int(_INT.unpack(self._bytes(8))[0])
        if kind == _NUMBER:
            return float(_FLOAT.unpack(self._bytes(8))[0])
        if kind not in (_TEXT, _LIST, _NUMBERS):
            raise self._error(f"has a value of the unknown kind {kind}")
        (count,) = _COUNT.unpack(self._bytes(2))
        if kind == _TEXT:
            return self._text(count)
        if depth == _MOST_DEPTH:
            raise self._error("has lists in lists, too deep")
        if kind == _NUMBERS:
            self._values += count
            if self._values > MOST_VALUES:
                raise self._error(f"has more than {MOST_VALUES} values")
            return [*struct.unpack(f"<{count}d", self._bytes(8 * count))]
        return [self._value(depth + 1) for _ in range(count)]

    def _text(self, size: int) -> str:
        raw = self._bytes(self._counted(size, _MOST_TEXT_BYTES))
        try:
            text = raw.decode("utf-8")
        except UnicodeDecodeError:
            raise self._error("has a text that is not UTF-8") from None
        if "\0" in text:
            raise self._error("has a text with a zero in it")
        return text

    def _counted(self, count: int, most: int) -> int:
        if count > most:
            raise self._error(f"has {count} of what may be {most}")
        return count

    def _byte(self) -> int:
        return self._bytes(1)[0]

    def _bytes(self, size: int) -> bytes:
        raw = self._data[self._at : self._at + size]
        if len(raw) != size:
            raise self._error("is cut off")
        self._at += size
        return raw

    def _error(self, what: str) -> ProtocolError:
        return ProtocolError(f"CALLS: call {self._number} {what}")


def read_calls(data: bytes, first: int = 0) -> list[Call]:
    """Read the calls of one frame; `first` is the number of the first one, for errors.

    Raises:
        ProtocolError: the bytes are not exactly calls of known functions.
    """
    return _Reader(data, first).calls()


class RecordedCalls:
    """All calls of one run, and what is to be known of them before they are carried out.

    Attributes:
        frames: the calls as they came, a frame each.
        count: calls so far. steps: of the simulation, in the world that counts. simulated_s: what they last.
        tricks: what no motor does, in the world that counts.
        files: by the number of the call, what a body was loaded from.
        gravity: as it was at the first step; before that, as it is.
        first_call: where the world that counts begins: after the last reset or disconnection that was followed by
            a step.
        not_finite: number of the first call with a value that is not finite; it and later ones are left out.
    """

    def __init__(self) -> None:
        self.frames: list[bytes] = []
        self.count = self.steps = self.first_call = 0
        self.simulated_s = 0.0
        self.tricks: list[Trick] = []
        self.files: dict[int, str] = {}
        self.gravity = (0.0, 0.0, 0.0)
        self.not_finite: int | None = None
        self._bytes = 0
        self._step_s = STEP_S
        self._pending: list[int] = []  # numbers of resets and disconnections that no step has followed

    def take(self, data: bytes, horizon_ns: int) -> None:
        """Take the calls of one frame.

        Raises:
            ProtocolError: they are not calls, or too many.
        """
        self._bytes += len(data)
        if self._bytes > MOST_BYTES:
            raise ProtocolError(f"CALLS: more than {MOST_BYTES} bytes were recorded")
        found = read_calls(data, self.count)
        if self.count + len(found) > MOST_CALLS:
            raise ProtocolError(f"CALLS: more than {MOST_CALLS} calls were recorded")
        if self.not_finite is not None or self.simulated_s * 1e9 > horizon_ns + _SLACK_NS:
            return
        finite = (is_finite((*call.args, *call.options.values())) for call in found)
        bad = next((i for i, fits in enumerate(finite) if not fits), None)
        if bad is not None:
            self.not_finite = self.count + bad
            return
        for call in found:
            self._note(call)
            self.count += 1
        self.frames.append(data)

    def _note(self, call: Call) -> None:
        if call.client != 0:
            return
        if call.name == "stepSimulation":
            self._step()
        elif call.name.startswith("load") and call.name != "loadTexture":
            file = call.value(0, "fileName")
            self.files[self.count] = file if isinstance(file, str) else ""
        elif call.name in ("resetSimulation", "disconnect"):
            self._pending.append(self.count)
        elif call.name in ("setTimeStep", "setPhysicsEngineParameter"):
            self._set_step(call)
        elif call.name == "setGravity":
            self._set_gravity(call)
        elif (kind := trick_of(call, started=self.steps > 0 and not self._pending)) is not None:
            self._trick(kind, call.name)

    def _step(self) -> None:
        if self._pending:
            self._begin_anew(self._pending[-1])
        self.steps += 1
        self.simulated_s += self._step_s

    def _begin_anew(self, number: int) -> None:
        """Begin a new world after the call `number`: what came before it does not count."""
        self.first_call, self._pending = number, []
        self.tricks = [trick for trick in self.tricks if trick.before_start and trick.kind == "time_step"]
        self.steps, self.simulated_s = 0, 0.0

    def _set_step(self, call: Call) -> None:
        seconds = call.number(0, "timeStep" if call.name == "setTimeStep" else "fixedTimeStep", -1.0)
        if seconds <= 0.0:
            return
        self._step_s = seconds
        if not LEAST_STEP_S * (1.0 - 1e-9) <= seconds <= MOST_STEP_S * (1.0 + 1e-9):
            self._trick("time_step", call.name)

    def _set_gravity(self, call: Call) -> None:
        names = ("gravX", "gravY", "gravZ")
        x, y, z = (call.number(place, name) for place, name in enumerate(names))
        if self.steps and not self._pending and (x, y, z) != self.gravity:
            self._trick("gravity", call.name)
        else:
            self.gravity = (x, y, z)

    def _trick(self, kind: TrickKind, name: str) -> None:
        if len(self.tricks) < _MOST_TRICKS:
            t_ns = round(self.simulated_s * 1e9)
            self.tricks.append(Trick(kind=kind, name=name, t_ns=t_ns, before_start=self.steps == 0))


def is_finite(values: Sequence[Value]) -> bool:
    """Return whether no number among `values`, or in their lists, is NaN or infinite."""
    for value in values:
        if isinstance(value, float) and not math.isfinite(value):
            return False
        if isinstance(value, list) and not is_finite(value):
            return False
    return True


def trick_of(call: Call, *, started: bool) -> TrickKind | None:
    """Return what a call does that no motor does, or None. Before the first step a body may be put anywhere."""
    match call.name:
        case "resetBasePositionAndOrientation" | "resetJointState":
            return "jump" if started or _nonzero(call.value(3, "targetVelocity")) else None
        case "resetJointStateMultiDof" | "resetJointStatesMultiDof":
            return "jump" if started else None
        case "resetBaseVelocity":
            given = [call.value(1, "linearVelocity"), call.value(2, "angularVelocity")]
            return "jump" if started or _nonzero(given) else None
        case "applyExternalForce" | "applyExternalTorque":
            return "push"
        case "createConstraint":
            parent = call.number(0, "parentBodyUniqueId", _WORLD)
            child = call.number(2, "childBodyUniqueId", _WORLD)
            return None if parent == child else "constraint"
        case "changeDynamics":
            return "dynamics" if _changes_nature(call) else None
        case "setCollisionFilterPair" | "setCollisionFilterGroupMask":
            return "collision"
    return None


def _changes_nature(call: Call) -> bool:
    """Return whether `changeDynamics` changes what a body is, not how it rubs and bounces."""
    return len(call.args) > 2 or any(name in call.options for name in _NATURE)


def _nonzero(value: Value) -> bool:
    if isinstance(value, list):
        return any(map(_nonzero, value))
    return isinstance(value, int | float) and value != 0
