"""Have recorded PyBullet calls carried out in a second confined process, and read its account of them.

That process runs no code of the student's, but it passes a stranger's arguments to PyBullet, which is written in
C++. So it is confined like a script's process, and its frames are read as strictly.
"""

import json
import math
import struct
from bisect import bisect_left
from dataclasses import replace
from itertools import islice
from typing import Any, Final

import numpy as np

from grader.contracts.assignment import Watch
from grader.contracts.errors import ProtocolError
from grader.contracts.replay import Replayed, ReplayedBody, ReplayEnd, Trick
from grader.contracts.trajectory import Floats, Picture, Trajectory, on_grid
from grader.formats.png import png_of
from grader.geometry import exact
from grader.sim.frames import Link
from grader.sim.recorded_calls import RecordedCalls, is_usual_step
from grader.sim.wire import CALLS, START

FINISH: Final = 0x31
BODY, SAMPLE, PICTURE, APPLIED, ENDED, REFUSED = 0x40, 0x41, 0x42, 0x43, 0x44, 0x45

MOST_BODIES: Final = 10_000
"""Most bodies of a replay, in all its worlds together. A world has 64 at most (`rclpy._pybullet.replay`)."""
MOST_SAMPLES: Final = 60_000  # 1,000 simulated seconds; a horizon is 600 s at most
PICTURES: Final = 12
MOST_PICTURES: Final = PICTURES + 2  # two more when the script disconnects (`rclpy._pybullet.replay`)
_MOST_SIDE: Final = 480
_MOST_JOINTS: Final = 64
_MOST_CONTACTS: Final = 32
_ROLES: Final = ("", "object", "robot")
_MOST_TRICKS: Final = 100
_ENDS: Final[tuple[ReplayEnd, ...]] = ("complete", "too_many_bodies")
_PUSH: Final = struct.Struct("<Hhd")
_BODY_HEAD, _SAMPLE_HEAD = struct.Struct("<IHBH2d"), struct.Struct("<qIII4d")
_REFUSED_HEAD: Final = struct.Struct("<H")
_PICTURE_HEAD, _APPLIED_HEAD, _ENDED_HEAD = (
    struct.Struct("<qHHH"),
    struct.Struct("<I"),
    struct.Struct("<BII32s"),
)
_BYTE: Final = struct.Struct("<B")


class _Sample:
    """One sample as it was received; its numbers may be NaN."""

    __slots__ = (
        "calls",
        "gravity",
        "joints",
        "link",
        "object",
        "pushes",
        "robot_joints",
        "step_s",
        "steps",
        "t_ns",
        "world",
    )

    def __init__(self, head: tuple[Any, ...]) -> None:
        self.t_ns, self.steps, self.calls, self.world, self.step_s, *gravity = head
        self.gravity = (float(gravity[0]), float(gravity[1]), float(gravity[2]))
        self.object: tuple[float, ...] = ()
        self.joints: tuple[float, ...] = ()
        self.link: tuple[float, ...] = ()
        self.robot_joints: tuple[float, ...] = ()
        self.pushes: tuple[tuple[int, int, float], ...] = ()

    @property
    def is_finite(self) -> bool:
        """Whether no number is NaN or infinite."""
        numbers = (self.step_s, *self.gravity, *self.object, *self.joints, *self.link, *self.robot_joints)
        return all(map(math.isfinite, numbers)) and all(math.isfinite(force) for _, _, force in self.pushes)


class _Fields:
    """Reads the fields of one frame in order; an error names the frame."""

    def __init__(self, name: str, body: bytes) -> None:
        self._name, self._body, self._at = name, body, 1

    def take(self, form: struct.Struct) -> tuple[Any, ...]:
        try:
            values = form.unpack_from(self._body, self._at)
        except struct.error:
            raise ProtocolError(f"replay: {self._name} is cut off") from None
        self._at += form.size
        return values

    def count(self, most: int) -> int:
        (count,) = self.take(_BYTE)
        if count > most:
            raise ProtocolError(f"replay: {self._name} has {count} of what may be {most}")
        return int(count)

    def numbers(self, count: int) -> tuple[float, ...]:
        return self.take(struct.Struct(f"<{count}d"))

    def rest(self) -> bytes:
        rest = self._body[self._at :]
        self._at = len(self._body)
        return rest

    def end(self) -> None:
        if self._at != len(self._body):
            raise ProtocolError(f"replay: {self._name} is followed by {len(self._body) - self._at} bytes")


class Replay:
    """One replay of `recorded`. `run` needs a link to a process that waits for START."""

    def __init__(self, recorded: RecordedCalls, watch: Watch, pictures: int = PICTURES) -> None:
        self._recorded = recorded
        self._watch = watch
        # One picture less than wanted: the process takes the last one by itself, at the end.
        self._pictured = (
            [recorded.steps * i // (pictures - 1) for i in range(pictures - 1)] if pictures else []
        )
        self._bodies: list[tuple[int, ReplayedBody]] = []
        self._refused: set[int] = set()
        self._samples: list[_Sample] = []
        self._pictures: list[tuple[int, int, int, bytearray]] = []  # time, width, height, rows so far
        self._applied = 0
        self._end: ReplayEnd | None = None
        self._state = ""

    def run(self, link: Link) -> bool:
        """Have all calls carried out; return False if the process ended before that.

        Raises ProtocolError: one of its frames cannot be read.
        """
        fields = {
            "replay": {
                "object": self._watch.object,
                "robot": self._watch.robot,
                "link": self._watch.link,
                "pictures": [max(step, 1) for step in self._pictured],
            }
        }
        text = json.dumps(fields).encode()
        link.send(bytes((START,)) + struct.pack("<I", len(text)) + text)
        for frame in self._recorded.frames:
            link.send(struct.pack("<Bq", CALLS, 0) + frame)
            if not self._take_until(link, until=APPLIED):
                return self._end is not None
        link.send(bytes((FINISH,)))
        self._take_until(link, until=ENDED)
        return self._end is not None

    def _take_until(self, link: Link, until: int) -> bool:
        """Take frames up to one of the kind `until`; return False when ENDED came or the process is gone."""
        while (body := link.receive()) is not None:
            self._take(body)
            if body[0] == ENDED:
                return False
            if body[0] == until:
                return True
        return False

    def _take(self, body: bytes) -> None:
        kind = body[0]
        if kind == BODY:
            self._take_body(_Fields("BODY", body))
        elif kind == SAMPLE:
            self._take_sample(_Fields("SAMPLE", body))
        elif kind == PICTURE:
            self._take_picture(_Fields("PICTURE", body))
        elif kind == REFUSED:
            self._take_refused(_Fields("REFUSED", body))
        elif kind == APPLIED:
            fields = _Fields("APPLIED", body)
            (applied,) = fields.take(_APPLIED_HEAD)
            fields.end()
            self._applied = min(applied, self._recorded.count)
        elif kind == ENDED:
            self._take_end(_Fields("ENDED", body))
        else:
            raise ProtocolError(f"replay: unknown frame kind 0x{kind:02x}")

    def _take_body(self, fields: _Fields) -> None:
        call, identity, role, joints, mass, total = fields.take(_BODY_HEAD)
        fields.end()
        if role >= len(_ROLES) or len(self._bodies) == MOST_BODIES:
            raise ProtocolError("replay: BODY.role is unknown, or there are too many bodies")
        body = ReplayedBody(
            id=identity,
            role=_ROLES[role],
            file=self._recorded.files.get(call, ""),
            joints=joints,
            mass_kg=mass if math.isfinite(mass) else 0.0,
            total_kg=total if math.isfinite(total) else 0.0,
        )
        self._bodies.append((call, body))

    def _take_refused(self, fields: _Fields) -> None:
        (count,) = fields.take(_REFUSED_HEAD)
        self._refused.update(fields.take(struct.Struct(f"<{count}I")))
        fields.end()
        if len(self._refused) > self._recorded.count:
            raise ProtocolError("replay: more calls were refused than were made")

    def _take_sample(self, fields: _Fields) -> None:
        sample = _Sample(fields.take(_SAMPLE_HEAD))
        if fields.count(1):
            sample.object = fields.numbers(14)
            sample.joints = fields.numbers(fields.count(_MOST_JOINTS))
        if fields.count(1):
            sample.link = fields.numbers(10)
            sample.robot_joints = fields.numbers(fields.count(_MOST_JOINTS))
        touching = range(fields.count(_MOST_CONTACTS))
        sample.pushes = tuple(
            (body, link, force) for body, link, force in (fields.take(_PUSH) for _ in touching)
        )
        fields.end()
        if len(self._samples) == MOST_SAMPLES or sample.t_ns < 0:
            raise ProtocolError("replay: too many samples, or one before the start")
        self._samples.append(sample)

    def _take_picture(self, fields: _Fields) -> None:
        t_ns, width, height, row = fields.take(_PICTURE_HEAD)
        rows = fields.rest()
        if not (0 < width <= _MOST_SIDE and 0 < height <= _MOST_SIDE):
            raise ProtocolError(f"replay: PICTURE is {width} by {height} pixels")
        if row == 0:
            if len(self._pictures) == MOST_PICTURES:
                raise ProtocolError("replay: too many pictures")
            self._pictures.append((t_ns, width, height, bytearray()))
        if not self._pictures or len(self._pictures[-1][3]) + len(rows) > 3 * width * height:
            raise ProtocolError("replay: PICTURE has rows of no picture")
        self._pictures[-1][3].extend(rows)

    def _take_end(self, fields: _Fields) -> None:
        reason, _, _, state = fields.take(_ENDED_HEAD)
        fields.end()
        if reason >= len(_ENDS):
            raise ProtocolError("replay: ENDED.reason is unknown")
        self._end = _ENDS[reason]
        self._state = state.hex() if any(state) else ""

    # ------------------------------------------------------------------------------------------- account

    @property
    def applied(self) -> int:
        """How many calls were carried out for certain."""
        return self._applied

    def account(self, end: ReplayEnd | None = None) -> Replayed:
        """Return the account, up to the first sample that is not finite.

        `end` says how a replay ended whose process could not say so itself.
        """
        world = _world_that_counts(self._samples)
        samples = _in_order([sample for sample in self._samples if sample.world == world])
        finite = next((i for i, one in enumerate(samples) if not one.is_finite), len(samples))
        ended = end or self._end or "crashed"
        if finite < len(samples) or (ended == "complete" and self._recorded.not_finite is not None):
            ended = "not_finite"
        samples = samples[:finite]
        bodies, tricks = self._bodies_and_tricks(world, samples)
        places, links = (
            _rows([sample.object for sample in samples], 14),
            _rows([sample.link for sample in samples], 10),
        )
        return Replayed(
            end=ended,
            steps=samples[-1].steps if samples else 0,
            calls=self._recorded.count,
            gravity=samples[0].gravity if samples else (0.0, 0.0, 0.0),
            t_ns=np.array([sample.t_ns for sample in samples], dtype=np.int64),
            calls_at=np.array([sample.calls for sample in samples], dtype=np.int64),
            object=places[:, :13],
            object_joints=_rows([sample.joints for sample in samples]),
            power_w=places[:, 13],
            link=links[:, :7],
            base=links[:, 7:],
            robot_joints=_rows([sample.robot_joints for sample in samples]),
            pushes=tuple(sample.pushes for sample in samples),
            bodies=bodies,
            tricks=tricks,
            pictures=tuple(
                _finished(*picture)
                for picture in self._pictures
                if len(picture[3]) == 3 * picture[1] * picture[2]
            ),
            state=self._state,
        )

    def _bodies_and_tricks(
        self, world: int, samples: list[_Sample]
    ) -> tuple[tuple[ReplayedBody, ...], tuple[Trick, ...]]:
        """Return the bodies of the world that counts, and what no motor does there, up to the last sample."""
        start = self._recorded.first_step(world, self._refused)
        last = samples[-1].calls if samples else world
        born = [(call, replace(body, is_late=call > start)) for call, body in self._bodies if call >= world]
        watched = {body.role: (call, body.id) for call, body in born if body.role}
        gravity = samples[0].gravity if samples else None
        suspects = (
            (suspect, kind)
            for suspect in self._recorded.suspects
            if world <= suspect.call < last and suspect.call not in self._refused
            if (kind := suspect.before if suspect.call < start else suspect.after) is not None
            if suspect.concerns(watched.values(), gravity)
        )
        calls = [sample.calls for sample in samples]
        tricks = [
            Trick(
                kind=kind,
                name=suspect.name,
                call=suspect.call,
                t_ns=samples[max(bisect_left(calls, suspect.call) - 1, 0)].t_ns,
                before_start=suspect.call < start,
            )
            for suspect, kind in islice(suspects, _MOST_TRICKS)
        ]
        unsteady = next(
            (sample for sample in samples if sample.steps and not is_usual_step(sample.step_s)), None
        )
        if unsteady is not None and not any(trick.kind == "time_step" for trick in tricks):
            name = "setTimeStep"  # in a world before this one: a reset keeps it
            tricks.insert(0, Trick(kind="time_step", name=name, call=world, t_ns=0, before_start=True))
        return tuple(body for _, body in born), tuple(tricks)


def _world_that_counts(samples: list[_Sample]) -> int:
    """Return the first call of the last world in which a step was taken."""
    stepped = [sample.world for sample in samples if sample.steps]
    return stepped[-1] if stepped else samples[-1].world if samples else 0


def _in_order(samples: list[_Sample]) -> list[_Sample]:
    """Leave out each sample that is not later than the one before it."""
    kept: list[_Sample] = []
    for sample in samples:
        if not kept or sample.t_ns > kept[-1].t_ns:
            kept.append(sample)
    return kept


def _rows(rows: list[tuple[float, ...]], width: int | None = None) -> Floats:
    """Return a table as wide as its longest row; missing numbers are NaN."""
    wide = max(map(len, rows), default=0) if width is None else width
    table = np.full((len(rows), wide), np.nan)
    for i, row in enumerate(rows):
        table[i, : len(row)] = row
    return on_grid(table)


def _finished(t_ns: int, width: int, height: int, rows: bytearray) -> Picture:
    return Picture(t_ns=t_ns, png=png_of(width, height, bytes(rows)))


def planar(replayed: Replayed) -> Trajectory:
    """Return the path of the object from above; without one that of the robot's link, else a point at rest."""
    place = replayed.object if np.isfinite(replayed.object).any() else replayed.link
    there = np.isfinite(place).all(axis=1) if len(place) else np.zeros(0, dtype=bool)
    if not there.any():
        zero = np.zeros(1)
        return Trajectory(
            t_ns=np.zeros(1, dtype=np.int64),
            x_m=zero,
            y_m=zero,
            heading_rad=zero,
            v_mps=zero,
            w_radps=zero,
            end_ns=int(replayed.t_ns[-1]) if len(replayed.t_ns) else 0,
            pictures=replayed.pictures,
        )
    rows, t_ns = place[there], replayed.t_ns[there]
    x, y, z, w = rows[:, 3], rows[:, 4], rows[:, 5], rows[:, 6]
    heading = np.unwrap(exact.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z)))
    seconds = np.maximum(np.diff(t_ns), 1) * 1e-9
    cos, sin = exact.cos_sin(heading[1:])
    ahead = np.diff(rows[:, 0]) * cos + np.diff(rows[:, 1]) * sin
    return Trajectory(
        t_ns=t_ns,
        x_m=rows[:, 0].copy(),
        y_m=rows[:, 1].copy(),
        heading_rad=on_grid(heading),
        v_mps=on_grid(np.concatenate(([0.0], ahead / seconds))),
        w_radps=on_grid(np.concatenate(([0.0], np.diff(heading) / seconds))),
        end_ns=int(t_ns[-1]),
        pictures=replayed.pictures,
    )
