"""A jailed process in the test's own process: frames as the jail writes them, and a link that speaks them.

This encoder is written from docs/design.md, apart from the shim's, so that the two can disagree.
"""

import json
import struct
from collections.abc import Generator, Iterable
from dataclasses import dataclass, field
from typing import Any

from grader.sim.cdr import decode

TWIST = "geometry_msgs/msg/Twist"
SECOND = 1_000_000_000


def text(value: str | bytes, length: str = "<H") -> bytes:
    raw = value.encode() if isinstance(value, str) else value
    return struct.pack(length, len(raw)) + raw


def entity(
    identity: int,
    what: int,
    t_ns: int = 0,
    *,
    node: str = "/student",
    name: str = "",
    type: str = "",
    reliability: int = 1,
    durability: int = 2,
    depth: int = 10,
) -> bytes:
    names = text(node) + text(name) + text(type)
    return (
        struct.pack("<BHBq", 0x10, identity, what, t_ns)
        + names
        + struct.pack("<BBH", reliability, durability, depth)
    )


def gone(identity: int, t_ns: int) -> bytes:
    return struct.pack("<BHq", 0x11, identity, t_ns)


def publish(identity: int, t_ns: int, payload: bytes) -> bytes:
    return struct.pack("<BHq", 0x12, identity, t_ns) + payload


def repeat(identity: int, *times_ns: int) -> bytes:
    return struct.pack(f"<BHH{len(times_ns)}q", 0x16, identity, len(times_ns), *times_ns)


def request(identity: int, sequence: int, t_ns: int, payload: bytes) -> bytes:
    return struct.pack("<BHIq", 0x13, identity, sequence, t_ns) + payload


def response(identity: int, sequence: int, t_ns: int, payload: bytes) -> bytes:
    return struct.pack("<BHIq", 0x14, identity, sequence, t_ns) + payload


def advance(t_ns: int, together_ns: int = 0) -> bytes:
    return struct.pack("<Bqq", 0x15, t_ns, together_ns)


def note(code: str, words: str = "") -> bytes:
    return b"\x20" + text(code) + text(words)


def ended(
    t_ns: int,
    *,
    reason: int = 0,
    after_interrupt: int = 0,
    code: int = 0,
    type: str = "",
    message: str = "",
    line: int = 0,
    detail: str = "",
) -> bytes:
    head = struct.pack("<BqBBi", 0x21, t_ns, reason, after_interrupt, code)
    return head + text(type) + text(message) + struct.pack("<I", line) + text(detail, "<I")


def twist(v: float = 0.0, w: float = 0.0, y: float = 0.0) -> bytes:
    return struct.pack("<4s6d", b"\0\1\0\0", v, y, 0.0, 0.0, 0.0, w)


def node(identity: int = 1, t_ns: int = 0) -> bytes:
    return entity(identity, 1, t_ns)


def driver(identity: int = 2, t_ns: int = 0, **fields: Any) -> bytes:
    """A publisher on the topic that moves the car."""
    return entity(identity, 2, t_ns, **{"name": "/turtle1/cmd_vel", "type": TWIST} | fields)


@dataclass
class Answer:
    """A decoded EVENTS frame."""

    now_ns: int
    quiet_ns: int
    events: list[tuple[int, int, int, int, bytes]]
    car: bytes = b""

    def messages(self, identity: int, type: str) -> list[dict[str, Any]]:
        return [decode(type, event[4]) for event in self.events if event[:2] == (1, identity)]

    def reply(self, identity: int, type: str) -> dict[str, Any]:
        (payload,) = [event[4] for event in self.events if event[:2] == (2, identity)]
        return decode(type, payload)


def read_events(body: bytes) -> Answer:
    kind, now_ns, quiet_ns, count = struct.unpack_from("<BqqH", body)
    assert kind == 0x81
    offset, events = 19, []
    for _ in range(count):
        what, identity, sequence, t_ns, length = struct.unpack_from("<BHIqI", body, offset)
        offset += 19
        events.append((what, identity, sequence, t_ns, body[offset : offset + length]))
        offset += length
    return Answer(now_ns, quiet_ns, events, body[offset:])


Script = Generator[bytes, Answer | None, None]


@dataclass
class FakeLink:
    """Plays `frames`: a list, or a generator that is sent an `Answer` for each ADVANCE it yields."""

    frames: Iterable[bytes] | Script
    start: dict[str, Any] = field(default_factory=dict)
    source: bytes = b""
    _answer: Answer | None = None

    def __post_init__(self) -> None:
        self._script = self.frames if isinstance(self.frames, Generator) else (frame for frame in self.frames)
        self._begun = False

    def send(self, body: bytes) -> None:
        if body[0] == 0x80:
            (length,) = struct.unpack_from("<I", body, 1)
            self.start = json.loads(body[5 : 5 + length])
            self.source = body[5 + length :]
        else:
            self._answer = read_events(body)

    def receive(self) -> bytes | None:
        answer, self._answer = self._answer, None
        try:
            return self._script.send(answer)
        except StopIteration:
            return None


def holding(
    segments: Iterable[tuple[float, float, float]], *, start_s: float = 0.0, every_s: float = 0.02
) -> list[bytes]:
    """Frames of a script that publishes (v, w) for each (seconds, v, w), and a stop at the end."""
    frames = [node(), driver()]
    t = start_s
    for seconds, v, w in segments:
        for tick in range(max(round(seconds / every_s), 1)):
            frames.append(publish(2, round((t + tick * every_s) * SECOND), twist(v, w)))
        t += seconds
    end = round(t * SECOND)
    return [*frames, publish(2, end, twist()), ended(end + SECOND // 10)]
