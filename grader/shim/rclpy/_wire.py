"""Frames of the channel to the episode; the format is described in docs/design.md, "Wire".

The world is trusted, so decoding only refuses what it cannot read. The episode's end shares no code with
this one; `tests/golden/wire/` holds frames both agree on.
"""

from __future__ import annotations

import struct

TYPE_CHECKING = False
if TYPE_CHECKING:
    Pair = tuple[float, float]
    Car = tuple[
        tuple[int, ...],
        tuple[int, ...],
        int,
        tuple[float, float, float],
        Pair,
        Pair,
        tuple[Pair, ...],
        int,
        bool,
        float,
    ]
    """What `Reckoning` is made of, in order."""

ENTITY, GONE, PUBLISH, REQUEST, RESPONSE, ADVANCE, NOTE, EXIT = 0x10, 0x11, 0x12, 0x13, 0x14, 0x15, 0x20, 0x21
REPEAT = 0x16
CALLS = 0x30
START, EVENTS = 0x80, 0x81

NODE, PUBLISHER, SUBSCRIPTION, SERVICE, CLIENT = 1, 2, 3, 4, 5
"""What an entity is."""

TO_SUBSCRIPTION, TO_CLIENT, TO_SERVICE, TO_GRAPH = 1, 2, 3, 4
"""What an event is for. One to the graph tells what the world has got or lost, as START's ``world`` does."""

FINISHED, RAISED, STALLED, BAD_SYNTAX, PRINTED_TOO_MUCH, TOO_MANY_STEPS = 0, 1, 2, 3, 4, 5
"""Reasons of EXIT."""

MAX_STR_BYTES = 1_024
MAX_TEXT_BYTES = 4_096
MAX_TRACEBACK_BYTES = 16_384

_PUBLISH = struct.Struct("<IBHq")
_ADVANCE = struct.Struct("<IBqq")
_EVENTS = struct.Struct("<BqqH")
_SERVICE = struct.Struct("<IBHIq")
_EVENT = struct.Struct("<BHIqI")
_COUNT = struct.Struct("<H")
_CAR = struct.Struct("<q7dqBd")


class Event:
    """Something that happened in the world, addressed to one entity of the script."""

    __slots__ = ("cdr", "id", "sequence", "t_ns", "what")

    def __init__(self, what: int, ident: int, sequence: int, t_ns: int, cdr: bytes) -> None:
        self.what = what
        self.id = ident
        self.sequence = sequence
        self.t_ns = t_ns
        self.cdr = cdr


def bounded(text: str, most_bytes: int) -> bytes:
    """Return `text` as UTF-8, cut at a character so that it fits; lone surrogates become ``?``."""
    data = text[:most_bytes].encode("utf-8", "replace")  # a script's text may be as long as its memory
    if len(data) > most_bytes:
        data = data[:most_bytes].decode("utf-8", "ignore").encode()
    return data


def _str(text: str, most_bytes: int = MAX_STR_BYTES) -> bytes:
    data = bounded(text, most_bytes)
    return struct.pack("<H", len(data)) + data


def _frame(body: bytes) -> bytes:
    return struct.pack("<I", len(body)) + body


def entity(
    ident: int,
    what: int,
    t_ns: int,
    names: tuple[str, str, str],
    quality: tuple[int, int, int],
) -> bytes:
    """Return ENTITY; `names` are node, name and type, `quality` reliability, durability and depth."""
    head = struct.pack("<BHBq", ENTITY, ident, what, t_ns)
    reliability, durability, depth = quality
    depth = min(max(depth, 0), 0xFFFF)
    return _frame(head + b"".join(map(_str, names)) + struct.pack("<BBH", reliability, durability, depth))


def gone(ident: int, t_ns: int) -> bytes:
    """Return GONE."""
    return _frame(struct.pack("<BHq", GONE, ident, t_ns))


def publish(ident: int, t_ns: int, cdr: bytes) -> bytes:
    """Return PUBLISH."""
    return _PUBLISH.pack(11 + len(cdr), PUBLISH, ident, t_ns) + cdr


def repeat(ident: int, times_ns: list[int]) -> bytes:
    """Return REPEAT: the message of the PUBLISH before, again at these times."""
    count = len(times_ns)
    return struct.pack(f"<IBHH{count}q", 5 + 8 * count, REPEAT, ident, count, *times_ns)


def service(kind: int, ident: int, sequence: int, t_ns: int, cdr: bytes) -> bytes:
    """Return REQUEST or RESPONSE."""
    return _SERVICE.pack(15 + len(cdr), kind, ident, sequence, t_ns) + cdr


def advance(t_ns: int, together_ns: int) -> bytes:
    """Return ADVANCE."""
    return _ADVANCE.pack(17, ADVANCE, t_ns, together_ns)


def calls(t_ns: int, recorded: bytes) -> bytes:
    """Return CALLS; `recorded` are calls of PyBullet as `rclpy._pybullet.calls` writes them."""
    return _frame(struct.pack("<Bq", CALLS, t_ns) + recorded)


def note(code: str, text: str) -> bytes:
    """Return NOTE."""
    return _frame(struct.pack("<B", NOTE) + _str(code) + _str(text, MAX_TEXT_BYTES))


class Exit:
    """How the run ended; the fields of EXIT."""

    def __init__(
        self,
        t_ns: int,
        reason: int,
        after_interrupt: bool,
        code: int,
        type: str = "",
        message: str = "",
        line: int = 0,
        text: str = "",
    ) -> None:
        self.t_ns = t_ns
        self.reason = reason
        self.after_interrupt = after_interrupt
        self.code = code
        self.type = type
        self.message = message
        self.line = line
        self.text = text

    def frame(self) -> bytes:
        """Return EXIT."""
        text = bounded(self.text, MAX_TRACEBACK_BYTES)
        code = max(-(1 << 31), min(self.code, (1 << 31) - 1))
        return _frame(
            struct.pack("<BqBBi", EXIT, self.t_ns, self.reason, self.after_interrupt, code)
            + _str(self.type)
            + _str(self.message, MAX_TEXT_BYTES)
            + struct.pack("<II", min(self.line, 0xFFFF_FFFF), len(text))
            + text
        )


def read_start(body: bytes) -> tuple[str, bytes]:
    """Return START's JSON text and the source.

    Raises:
        ValueError, struct.error: `body` is not START.
    """
    kind, length = struct.unpack_from("<BI", body)
    if kind != START or 5 + length > len(body):
        raise ValueError("not a START frame")
    return body[5 : 5 + length].decode(), body[5 + length :]


def read_events(body: bytes) -> tuple[int, int, list[Event], Car | None]:
    """Return the instant reached, the one before which nothing more becomes due, what is due now, and the car.

    The car comes with the answer when nothing but its poses can become due until the script does more than drive.

    Raises:
        ValueError, struct.error: `body` is not EVENTS.
    """
    kind, now_ns, quiet_ns, count = _EVENTS.unpack_from(body)
    if kind != EVENTS:
        raise ValueError("not an EVENTS frame")
    events = []
    offset = _EVENTS.size
    for _ in range(count):
        what, ident, sequence, t_ns, length = _EVENT.unpack_from(body, offset)
        offset += _EVENT.size
        if offset + length > len(body):
            raise ValueError("EVENTS ends inside an event")
        events.append(Event(what, ident, sequence, t_ns, body[offset : offset + length]))
        offset += length
    return now_ns, quiet_ns, events, _read_car(body, offset) if offset < len(body) else None


def _read_car(body: bytes, offset: int) -> Car:
    subscriptions, offset = _read_ids(body, offset)
    publishers, offset = _read_ids(body, offset)
    t_ns, x, y, heading, v, w, v_asked, w_asked, drop_ns, resting, window_m = _CAR.unpack_from(body, offset)
    offset += _CAR.size
    (count,) = struct.unpack_from("<B", body, offset)
    speeds = struct.unpack_from(f"<{2 * count}d", body, offset + 1)
    waiting = tuple(zip(speeds[::2], speeds[1::2], strict=True))
    pose, velocity, commanded = (x, y, heading), (v, w), (v_asked, w_asked)
    resting = resting == 1
    return subscriptions, publishers, t_ns, pose, velocity, commanded, waiting, drop_ns, resting, window_m


def _read_ids(body: bytes, offset: int) -> tuple[tuple[int, ...], int]:
    (count,) = _COUNT.unpack_from(body, offset)
    offset += _COUNT.size
    return struct.unpack_from(f"<{count}H", body, offset), offset + 2 * count
