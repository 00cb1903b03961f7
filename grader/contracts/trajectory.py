"""What the car did: a time-stamped planar trajectory, recorded on the trusted side, and its JSON."""

import json
from base64 import b64decode, b64encode
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field, replace
from typing import Any, Final, NamedTuple

import msgspec
import numpy as np
from numpy.typing import NDArray

from grader.contracts.conversation import Saying
from grader.contracts.record import Record, to_plain

COMMAND_LIFE_NS: Final = 1_000_000_000
"""turtlesim drops a command once more than this has passed since it was taken."""

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


class Contact(Record):
    """The car touched a wall during [start_ns, end_ns]. `wall` is left, right, top or bottom.

    In a robot's room it may also be wall, box, cylinder or ramp.
    """

    start_ns: int
    end_ns: int
    wall: str


class Command(NamedTuple):
    """A velocity command as the script sent it. Of several between two updates of 16 ms, the last is kept.

    The car obeys 100 m/s and 100 rad/s at most; one with NaN or infinity in it is a stop.
    """

    t_ns: int
    v_mps: float
    w_radps: float


class Picture(Record):
    """What the camera of a PyBullet world saw at one instant, as a PNG file."""

    t_ns: int
    png: bytes


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Trajectory:
    """Poses of the car over virtual time, in turtlesim's frame (origin bottom left, x right, y up).

    All arrays have the same length n >= 1 (the start pose). Samples are 16 ms apart while the car moves
    (those of a robot in a room 16.7 ms) and sparser while it rests: between two samples further apart the car
    stood still.

    Attributes:
        t_ns: (n,) strictly increasing virtual time.
        x_m, y_m: (n,) position.
        heading_rad: (n,) heading, counter-clockwise positive, unwrapped (continuous, not folded to ±π).
        v_mps: (n,) signed speed along the heading on the way to the sample, measured, not commanded.
        w_radps: (n,) yaw rate, measured.
        jumps: indices i (1 <= i < n) whose pose was reached by teleport or reset, not by driving; the
            heading is not continuous there.
        contacts: wall contacts in order of time.
        commands: commands in order of time, bounded by one per update.
        end_ns: virtual time at which the episode ended (>= t_ns[-1]; the car rested since).
        pictures: of a PyBullet world, in order of time; of others none.
        sayings: lines of a conversation; none where the assignment asks for none.
        commanded: the motion that the same commands would have made, each obeyed at once, where turtlesim let some
            of them wait. None: none waited.
    """

    t_ns: Ints
    x_m: Floats
    y_m: Floats
    heading_rad: Floats
    v_mps: Floats
    w_radps: Floats
    end_ns: int
    jumps: tuple[int, ...] = ()
    contacts: tuple[Contact, ...] = ()
    commands: tuple[Command, ...] = field(default=())
    pictures: tuple[Picture, ...] = ()
    sayings: tuple[Saying, ...] = ()
    commanded: "Trajectory | None" = None

    def __len__(self) -> int:
        return len(self.t_ns)

    def at_once(self) -> "Trajectory":
        """Return the motion of a turtle that obeys each command at once."""
        return self if self.commanded is None else self.commanded


# --------------------------------------------------------------------------------------------------- JSON

DECIMALS: Final = 6
"""Decimals of lengths, angles and speeds, as turtlesim's own poses resolve them: what is scored is what is stored.

A last bit in which two processors or builds of a simulator differ does not get beyond a recording.
"""

_COMMANDS = b'"commands":'
_FLOAT_COLUMNS = ("x_m", "y_m", "heading_rad", "v_mps", "w_radps")


def recorded(trajectory: Trajectory) -> Trajectory:
    """Return a trajectory as it is stored and scored: lengths, angles and speeds rounded to 1e-6."""
    commands = _rounded_commands(trajectory.commands)
    driven = _recorded_motion(trajectory, commands)
    if trajectory.commanded is None:
        return driven
    return replace(driven, commanded=_recorded_motion(trajectory.commanded, commands))


def _recorded_motion(trajectory: Trajectory, commands: tuple[Command, ...]) -> Trajectory:
    return replace(
        trajectory,
        x_m=on_grid(trajectory.x_m),
        y_m=on_grid(trajectory.y_m),
        heading_rad=on_grid(trajectory.heading_rad),
        v_mps=on_grid(trajectory.v_mps),
        w_radps=on_grid(trajectory.w_radps),
        commands=commands,
    )


def encode_trajectory(trajectory: Trajectory) -> bytes:
    """Return canonical JSON of a trajectory that is `recorded` (times in whole nanoseconds)."""
    commanded = {} if trajectory.commanded is None else {"commanded": _motion(trajectory.commanded)}
    commands = _written(trajectory.commands)
    return msgspec.json.encode({**_motion(trajectory), **commanded, "commands": commands})


def _motion(trajectory: Trajectory) -> dict[str, object]:
    columns = {name: _written(getattr(trajectory, name).tolist()) for name in _FLOAT_COLUMNS}
    return {
        "t_ns": trajectory.t_ns.tolist(),
        **columns,
        "end_ns": trajectory.end_ns,
        "jumps": list(trajectory.jumps),
        "contacts": [asdict(contact) for contact in trajectory.contacts],
        **_pictures(trajectory),
        **({"sayings": [to_plain(saying) for saying in trajectory.sayings]} if trajectory.sayings else {}),
    }


def decode_trajectory(data: bytes) -> Trajectory:
    """Return the trajectory that `encode_trajectory` wrote. Only for bytes written by the grader itself."""
    document = json.loads(data)
    driven = _read(document)
    if "commanded" not in document:
        return driven
    return replace(driven, commanded=replace(_read(document["commanded"]), commands=driven.commands))


def _read(document: dict[str, Any]) -> Trajectory:
    floats = {name: np.array(document[name], dtype=np.float64) for name in _FLOAT_COLUMNS}
    return Trajectory(
        t_ns=np.array(document["t_ns"], dtype=np.int64),
        end_ns=document["end_ns"],
        jumps=tuple(document["jumps"]),
        contacts=tuple(Contact(**contact) for contact in document["contacts"]),
        commands=tuple(Command(*command) for command in document.get("commands", ())),
        pictures=tuple(
            Picture(t_ns=t_ns, png=b64decode(png, validate=True))
            for t_ns, png in document.get("pictures", ())
        ),
        sayings=tuple(Saying(**saying) for saying in document.get("sayings", ())),
        commanded=None,
        **floats,
    )


def decode_commands(data: bytes) -> tuple[Command, ...]:
    """Return the commands alone of what `encode_trajectory` wrote: they stand last, and the rest is not read."""
    commands = json.loads(data[data.rindex(_COMMANDS) + len(_COMMANDS) : -1])
    return tuple(Command(*command) for command in commands)


def _written(numbers: Sequence[object]) -> msgspec.Raw:
    """Return numbers, or rows of them, as `json` writes them.

    msgspec is six times as fast, and writes the same but for numbers with an exponent, tiny or huge, and NaN.
    """
    written = msgspec.json.encode(numbers)
    if b"0.0000" in written or b"e" in written or b"null" in written:
        written = json.dumps(numbers, separators=(",", ":"), allow_nan=False).encode()
    return msgspec.Raw(written)


def _pictures(trajectory: Trajectory) -> dict[str, object]:
    pictures = [[picture.t_ns, b64encode(picture.png).decode("ascii")] for picture in trajectory.pictures]
    return {"pictures": pictures} if pictures else {}


def _rounded_commands(commands: tuple[Command, ...]) -> tuple[Command, ...]:
    """Return the commands, their speeds rounded. Those of a command and its repetitions are the same objects."""
    rows = []
    v_before = w_before = None
    v = w = 0.0
    for t_ns, v_mps, w_radps in commands:
        if v_mps is not v_before or w_radps is not w_before:
            v_before, w_before = v_mps, w_radps
            v, w = round(v_mps, DECIMALS) + 0.0, round(w_radps, DECIMALS) + 0.0
        rows.append(Command(t_ns, v, w))
    return tuple(rows)


def on_grid(column: Floats) -> Floats:
    """Return lengths, angles or speeds as they are recorded."""
    # adding 0.0 turns -0.0 into 0.0, which would otherwise make two digests of one motion
    rounded: Floats = np.round(column, DECIMALS) + 0.0
    return rounded
