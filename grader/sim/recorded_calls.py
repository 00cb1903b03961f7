"""The PyBullet calls that a script has recorded, as the trusted side takes them: read strictly, kept as they came.

What comes in was written by a hostile process. Each call is read with every length checked, numbers must be
finite and within bounds, and only functions of the table can be named. Any such call is allowed: a second confined
process carries it out (`grader.sim.replay`). This module finds the calls that do what no motor does (`trick_of`);
which of them took place, and when, is known after the replay.
"""

import math
import re
import struct
from array import array
from bisect import bisect_left
from collections.abc import Callable, Container, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Final, NamedTuple

from grader.contracts.errors import ProtocolError
from grader.contracts.replay import TrickKind

_TABLE: Final = Path(__file__).resolve().parents[1] / "shim" / "rclpy" / "_pybullet" / "functions.txt"
_ROWS: Final = [
    line.split(" ", 2) for line in _TABLE.read_text(encoding="ascii").splitlines() if not line.startswith("#")
]
KINDS: Final[Mapping[str, str]] = {name: kind for name, kind, *_ in _ROWS}
PARAMETERS: Final[Mapping[str, Sequence[str]]] = {
    name: details[0].split(",")
    for name, kind, *details in _ROWS
    if kind in ("step", "motor", "world", "trick")
}
FUNCTIONS: Final = tuple(PARAMETERS)
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
_SLACK_NS: Final = 1_000_000_000
_WORLD: Final = -1
_JOINT_GEAR: Final = 6
_NATURE: Final = (
    "mass",
    "localInertiaDiagonal",
    "anisotropicFriction",
    "jointLowerLimit",
    "jointUpperLimit",
    "jointLimitForce",
    "activationState",
)
_BRAKES: Final = ("linearDamping", "angularDamping", "jointDamping")


class Call(NamedTuple):
    """One call: its function and what was passed."""

    name: str
    args: tuple[Value, ...]
    options: Mapping[str, Value]

    def value(self, name: str) -> Value:
        """Return an argument, whether it was passed by its place or by its name; None: it was not passed."""
        if name in self.options:
            return self.options[name]
        names = PARAMETERS[self.name]
        place = names.index(name) if name in names else len(self.args)
        return self.args[place] if place < len(self.args) else None

    def number(self, name: str, default: float = 0.0) -> float:
        """Return a number; `default` if it was not passed or is no number."""
        value = self.value(name)
        return float(value) if isinstance(value, int | float) else default

    @property
    def is_of_first_client(self) -> bool:
        """Whether it addresses the first physics client, whose world alone counts."""
        if self.name == "loadURDF" and len(self.args) > 3 and isinstance(self.args[1], int | float):
            return not self.options.get("physicsClientId", 0)  # seven numbers, as of old
        return not self.value("physicsClientId")


class Suspect(NamedTuple):
    """A call that does what no motor does, if it took place.

    Attributes:
        before: what it does before the first step, or None; after: what it does later.
        body: it matters only if this is what the assignment looks at. loads: only if it loaded that.
        gravity: it matters only if this is not what gravity was at the first step.
    """

    call: int
    name: str
    before: TrickKind | None
    after: TrickKind | None
    body: int | None = None
    loads: bool = False
    gravity: tuple[float, float, float] | None = None

    def concerns(
        self, watched: Iterable[tuple[int, int]], gravity: tuple[float, float, float] | None
    ) -> bool:
        """Return whether it matters, where bodies are `watched`: (number of the call that loaded it, id) each."""
        if self.gravity is not None:
            return self.gravity != gravity
        if self.body is not None:
            return any(body == self.body and call < self.call for call, body in watched)
        return not self.loads or any(call == self.call for call, _ in watched)


class _Reader:
    """Reads the calls of one frame; every error names the call."""

    def __init__(self, data: bytes, first: int) -> None:
        self._data = data
        self._at = 0
        self._number = first
        self._values = 0

    def calls(self) -> list[Call]:
        calls = []
        while self._at < len(self._data):
            self._values = 0
            calls.append(self._call())
            self._number += 1
        return calls

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

    Raises ProtocolError: the bytes are not exactly calls of known functions.
    """
    return _Reader(data, first).calls()


class RecordedCalls:
    """All calls of one run, and what is to be known of them before they are carried out.

    Attributes:
        frames: the calls as they came, a frame each.
        count: calls so far. steps: of the simulation, since it last began anew. simulated_s: what they last.
        suspects: calls that do what no motor does.
        files: by the number of the call, what a body was loaded from.
        not_finite: number of the first call with a value that is not finite; it and later ones are left out.
    """

    def __init__(self) -> None:
        self.frames: list[bytes] = []
        self.count = self.steps = 0
        self.simulated_s = 0.0
        self.suspects: list[Suspect] = []
        self.files: dict[int, str] = {}
        self.not_finite: int | None = None
        self._bytes = 0
        self._step_s = STEP_S
        self._step_calls = array("I")
        self._is_over = False  # by a reset or disconnection that no step has followed

    def take(self, data: bytes, horizon_ns: int) -> None:
        """Take the calls of one frame. Raises ProtocolError: they are not calls, or too many."""
        self._bytes += len(data)
        if self._bytes > MOST_BYTES:
            raise ProtocolError(f"CALLS: more than {MOST_BYTES} bytes were recorded")
        calls = read_calls(data, self.count)
        if self.count + len(calls) > MOST_CALLS:
            raise ProtocolError(f"CALLS: more than {MOST_CALLS} calls were recorded")
        if self.not_finite is not None or self.simulated_s * 1e9 > horizon_ns + _SLACK_NS:
            return
        finite = (is_finite((*call.args, *call.options.values())) for call in calls)
        bad = next((i for i, fits in enumerate(finite) if not fits), None)
        if bad is not None:
            self.not_finite = self.count + bad
            return
        for call in calls:
            self._note(call)
            self.count += 1
        self.frames.append(data)

    def first_step(self, world: int, refused: Container[int]) -> int:
        """Return the number of the first step from call `world` on; of the end, if there is none."""
        first = bisect_left(self._step_calls, world)
        return next((call for call in self._step_calls[first:] if call not in refused), self.count)

    def _note(self, call: Call) -> None:
        if not call.is_of_first_client:
            return
        if call.name == "stepSimulation":
            self._step()
        elif call.name in ("resetSimulation", "disconnect"):
            self._is_over = True
        elif call.name in ("setTimeStep", "setPhysicsEngineParameter"):
            seconds = _step_of(call)
            self._step_s = seconds if seconds > 0.0 else self._step_s
        elif (place := _file_of(call)) is not None:
            self.files[self.count] = place
        if KINDS[call.name] == "trick" and (suspect := suspect_of(call, self.count)) is not None:
            self.suspects.append(suspect)

    def _step(self) -> None:
        if self._is_over:
            self._is_over = False
            self.steps, self.simulated_s = 0, 0.0
        self.steps += 1
        self.simulated_s += self._step_s
        self._step_calls.append(self.count)


def _file_of(call: Call) -> str | None:
    """Return what bodies a call loads; None: it loads none."""
    if call.name not in ("loadURDF", "loadSDF", "loadMJCF"):
        return None
    file = call.value(PARAMETERS[call.name][0])
    return file if isinstance(file, str) else ""


def _step_of(call: Call) -> float:
    return call.number("timeStep" if call.name == "setTimeStep" else "fixedTimeStep", -1.0)


def is_usual_step(seconds: float) -> bool:
    """Return whether a simulation with steps of this length is to be trusted."""
    return LEAST_STEP_S * (1.0 - 1e-9) <= seconds <= MOST_STEP_S * (1.0 + 1e-9)


def is_finite(values: Sequence[Value]) -> bool:
    """Return whether no number among `values`, or in their lists, is NaN or infinite."""
    for value in values:
        if isinstance(value, float) and not math.isfinite(value):
            return False
        if isinstance(value, list) and not is_finite(value):
            return False
    return True


def suspect_of(call: Call, number: int) -> Suspect | None:
    """Return a call that does what no motor does, under its number, or None."""
    before, after = (trick_of(call, started=started) for started in (False, True))
    if before is None and after is None:
        return None
    suspect = Suspect(number, call.name, before, after)
    if call.name == "setGravity":
        x, y, z = (call.number(name) for name in ("gravX", "gravY", "gravZ"))
        return suspect._replace(gravity=(x, y, z))
    if call.name == "removeBody":
        return suspect._replace(body=int(call.number("bodyUniqueId", -1)))
    return suspect._replace(loads=_file_of(call) is not None)


def trick_of(call: Call, *, started: bool) -> TrickKind | None:
    """Return what a call does that no motor does, or None. Before the first step a body may be put anywhere.

    Raises KeyError: the table has a trick for which there is no rule.
    """
    return TRICK_RULES[call.name](call, started)


def _places(call: Call, started: bool) -> TrickKind | None:
    moves = ("targetVelocity", "targetVelocities", "linearVelocity", "angularVelocity")
    return "jump" if started or any(_nonzero(call.value(name)) for name in moves) else None


def _ties(call: Call, _: bool) -> TrickKind | None:
    """Allow the gears of one body; any other constraint holds or pulls."""
    parent, child = (call.number(f"{side}BodyUniqueId", _WORLD) for side in ("parent", "child"))
    return None if parent == child and call.number("jointType") == _JOINT_GEAR else "constraint"


def _ties_otherwise(call: Call, _: bool) -> TrickKind | None:
    moves = ("jointChildPivot", "jointChildFrameOrientation", "relativePositionTarget")
    return "constraint" if any(call.value(name) is not None for name in moves) else None


def _changes_nature(call: Call, started: bool) -> TrickKind | None:
    """Allow what changes how a body rubs and bounces, not what it is; nor may a brake begin later."""
    names = (*_NATURE, *_BRAKES) if started else _NATURE
    changed = (call.value(name) for name in names)
    return "dynamics" if any(isinstance(value, list) or not _is_default(value) for value in changed) else None


def _is_default(value: Value) -> bool:
    """Return whether PyBullet takes a number for "as it was"."""
    return value is None or (isinstance(value, int | float) and value == -1)


def _lets_through(call: Call, _: bool) -> TrickKind | None:
    same = call.value("bodyUniqueIdA") is not None and call.value("bodyUniqueIdA") == call.value(
        "bodyUniqueIdB"
    )
    return None if same or call.number("enableCollision") else "collision"


def _changes_step(call: Call, _: bool) -> TrickKind | None:
    seconds = _step_of(call)
    return "time_step" if seconds > 0.0 and not is_usual_step(seconds) else None


def _scales(call: Call, _: bool) -> TrickKind | None:
    return "dynamics" if call.number("globalScaling", 1.0) != 1.0 else None


TRICK_RULES: Final[Mapping[str, Callable[[Call, bool], TrickKind | None]]] = {
    **dict.fromkeys(
        (
            "resetBasePositionAndOrientation",
            "resetBaseVelocity",
            "resetJointState",
            "resetJointStateMultiDof",
            "resetJointStatesMultiDof",
        ),
        _places,
    ),
    **dict.fromkeys(("applyExternalForce", "applyExternalTorque"), lambda *_: "push"),
    "createConstraint": _ties,
    "changeConstraint": _ties_otherwise,
    "changeDynamics": _changes_nature,
    "setCollisionFilterPair": _lets_through,
    "setCollisionFilterGroupMask": lambda *_: "collision",
    **dict.fromkeys(("setTimeStep", "setPhysicsEngineParameter"), _changes_step),
    "setGravity": lambda _, started: "gravity" if started else None,
    "removeBody": lambda _, started: "removed" if started else None,
    **dict.fromkeys(("loadURDF", "loadSDF", "loadMJCF"), _scales),
}
"""For each function of the kind `trick`, when it is one."""


def _nonzero(value: Value) -> bool:
    if isinstance(value, list):
        return any(map(_nonzero, value))
    return isinstance(value, int | float) and value != 0
