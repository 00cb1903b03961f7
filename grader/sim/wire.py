"""The episode's end of the channel: frames in, frames out, as `docs/design.md` ("Wire") has them.

What comes in was written by a hostile process. A frame is read field by field with every length checked
against the bytes that are left, text must be strict UTF-8 within its bound, numbers within their range, and
nothing may follow the last field; anything else is a `ProtocolError` that names the field. References between
frames (which id is a publisher, whether time goes on) are the episode's to check.
"""

import json
import re
import struct
from collections.abc import Callable, Iterable, Mapping
from typing import Any, Final

from grader.contracts.assignment import TOPIC_PATTERN
from grader.contracts.errors import ProtocolError
from grader.sim import frames

PROTOCOL: Final = 6
MAX_NAME_BYTES: Final = 1_024
MAX_ENTITY_NAME_BYTES: Final = 255  # as in rmw, the middleware's interface
MAX_NODE_NAME_BYTES: Final = 501  # a namespace of 245, a slash and a name of 255, as in rmw
MAX_MESSAGE_BYTES: Final = 4_096
MAX_DETAIL_BYTES: Final = 16_384

ENTITY, GONE, PUBLISH, REQUEST, RESPONSE, ADVANCE, NOTE, EXIT = 0x10, 0x11, 0x12, 0x13, 0x14, 0x15, 0x20, 0x21
REPEAT: Final = 0x16
CALLS: Final = 0x30
FACTS: Final = 0x32
START, EVENTS = 0x80, 0x81

_NAME: Final = re.compile(TOPIC_PATTERN, re.ASCII)
_TYPE: Final = re.compile(r"[A-Za-z]\w*(/[A-Za-z]\w*){1,2}", re.ASCII)

_U8, _U16, _U32, _I32, _I64 = (struct.Struct("<" + code) for code in "BHIiq")
_PUBLISH_HEAD: Final = struct.Struct("<BHq")
_REPEAT_HEAD: Final = struct.Struct("<BHH")
_CALL_HEAD: Final = struct.Struct("<BHIq")
_ADVANCE: Final = struct.Struct("<Bqq")
_CALLS_HEAD: Final = struct.Struct("<Bq")
_EVENTS_HEAD: Final = struct.Struct("<BqqH")
_EVENT_HEAD: Final = struct.Struct("<BHIqI")
_CAR: Final = struct.Struct("<q7dqBd")


def decode(body: bytes) -> frames.Frame:
    """Read one frame of the jail.

    Raises ProtocolError: the bytes are not exactly one frame of a known kind.
    """
    if not body:
        raise ProtocolError("empty frame")
    read = _READERS.get(body[0])
    if read is None:
        raise ProtocolError(f"unknown frame kind 0x{body[0]:02x}")
    return read(body)


def encode_start(fields: Mapping[str, Any], source: bytes) -> bytes:
    """Build START: what the jailed process needs to know, and the student's source."""
    text = json.dumps(fields, ensure_ascii=False, allow_nan=False, separators=(",", ":")).encode()
    return _U8.pack(START) + _U32.pack(len(text)) + text + source


def encode_events(
    now_ns: int, quiet_ns: int, events: Iterable[frames.Event], car: frames.CarState | None = None
) -> bytes:
    """Build EVENTS, the answer to ADVANCE; before `quiet_ns` nothing more becomes due by itself.

    With `car`, nothing but its poses does until the script does more than drive.
    """
    chunks: list[bytes] = []
    for what, identity, sequence, t_ns, payload in events:
        chunks += (_EVENT_HEAD.pack(what, identity, sequence, t_ns, len(payload)), payload)
    head = _EVENTS_HEAD.pack(EVENTS, now_ns, quiet_ns, len(chunks) // 2)
    return head + b"".join(chunks) + (b"" if car is None else _car(car))


def _car(car: frames.CarState) -> bytes:
    ids = b"".join(
        struct.pack(f"<{1 + len(those)}H", len(those), *those)
        for those in (car.subscriptions, car.publishers)
    )
    numbers = (car.t_ns, *car.pose, *car.velocity, *car.commanded, car.drop_ns, car.resting, car.window_m)
    speeds = [speed for command in car.waiting for speed in command]
    return ids + _CAR.pack(*numbers) + struct.pack(f"<B{len(speeds)}d", len(car.waiting), *speeds)


class _Cursor:
    """Reads the fields of one frame in order; an error names the frame and the field."""

    def __init__(self, frame: str, body: bytes) -> None:
        self._frame = frame
        self._body = body
        self._at = 1

    def number(self, field: str, kind: struct.Struct) -> int:
        try:
            (value,) = kind.unpack_from(self._body, self._at)
        except struct.error:
            raise self._error(field, "is cut off") from None
        self._at += kind.size
        return int(value)

    def time(self, field: str = "t") -> int:
        t_ns = self.number(field, _I64)
        if t_ns < 0:
            raise self._error(field, "is negative")
        return t_ns

    def choice(self, field: str, allowed: range) -> int:
        value = self.number(field, _U8)
        if value not in allowed:
            raise self._error(field, f"is {value}")
        return value

    def text(self, field: str, most: int = MAX_NAME_BYTES, length: struct.Struct = _U16) -> str:
        size = self.number(field, length)
        if size > most:
            raise self._error(field, f"has {size} bytes, {most} allowed")
        raw = self._body[self._at : self._at + size]
        if len(raw) != size:
            raise self._error(field, "is cut off")
        self._at += size
        try:
            return raw.decode("utf-8")
        except UnicodeDecodeError:
            raise self._error(field, "is not UTF-8") from None

    def name(self, field: str, pattern: re.Pattern[str], most: int = MAX_ENTITY_NAME_BYTES) -> str:
        """Read a name that goes into the report for each entity: by the rules of ROS, or empty."""
        name = self.text(field, most)
        if name and not pattern.fullmatch(name):
            raise self._error(field, "is not a name by the rules of ROS")
        return name

    def end(self) -> None:
        if self._at != len(self._body):
            raise self._error("end", f"is followed by {len(self._body) - self._at} bytes")

    def _error(self, field: str, what: str) -> ProtocolError:
        return ProtocolError(f"{self._frame}.{field} {what}")


def _read_entity(body: bytes) -> frames.Entity:
    cursor = _Cursor("ENTITY", body)
    entity = frames.Entity(
        id=cursor.number("id", _U16),
        what=cursor.choice("what", range(frames.NODE, frames.CLIENT + 1)),
        t_ns=cursor.time(),
        node=cursor.name("node", _NAME, MAX_NODE_NAME_BYTES),
        name=cursor.name("name", _NAME),
        type=cursor.name("type", _TYPE),
        reliable=cursor.choice("reliability", range(1, 3)) == 1,
        transient_local=cursor.choice("durability", range(1, 3)) == 1,
        depth=cursor.number("depth", _U16),
    )
    cursor.end()
    return entity


def _read_gone(body: bytes) -> frames.Gone:
    cursor = _Cursor("GONE", body)
    gone = frames.Gone(id=cursor.number("id", _U16), t_ns=cursor.time())
    cursor.end()
    return gone


def _read_publish(body: bytes) -> frames.Publish:
    try:
        _, identity, t_ns = _PUBLISH_HEAD.unpack_from(body)
    except struct.error:
        raise ProtocolError("PUBLISH.t is cut off") from None
    if t_ns < 0:
        raise ProtocolError("PUBLISH.t is negative")
    return frames.Publish(identity, t_ns, body[_PUBLISH_HEAD.size :])


def _read_repeat(body: bytes) -> frames.Repeat:
    """Read REPEAT: one time for each message, all the same as the one before."""
    try:
        _, identity, count = _REPEAT_HEAD.unpack_from(body)
        times_ns = struct.unpack_from(f"<{count}q", body, _REPEAT_HEAD.size)
    except struct.error:
        raise ProtocolError("REPEAT.times is cut off") from None
    if not times_ns or min(times_ns) < 0:
        raise ProtocolError("REPEAT.times is empty or has a negative one")
    if left := len(body) - _REPEAT_HEAD.size - count * _I64.size:
        raise ProtocolError(f"REPEAT.end is followed by {left} bytes")
    return frames.Repeat(identity, times_ns)


def _read_call(name: str, body: bytes) -> tuple[int, int, int, bytes]:
    try:
        _, identity, sequence, t_ns = _CALL_HEAD.unpack_from(body)
    except struct.error:
        raise ProtocolError(f"{name}.t is cut off") from None
    if t_ns < 0:
        raise ProtocolError(f"{name}.t is negative")
    return identity, sequence, t_ns, body[_CALL_HEAD.size :]


def _read_request(body: bytes) -> frames.Request:
    return frames.Request(*_read_call("REQUEST", body))


def _read_response(body: bytes) -> frames.Response:
    return frames.Response(*_read_call("RESPONSE", body))


def _read_advance(body: bytes) -> frames.Advance:
    if len(body) == _ADVANCE.size:  # the most frequent frame of a script that listens
        _, t_ns, together_ns = _ADVANCE.unpack(body)
        if t_ns >= 0 and together_ns >= 0:
            return frames.Advance(t_ns, together_ns)
    cursor = _Cursor("ADVANCE", body)
    advance = frames.Advance(t_ns=cursor.time(), together_ns=cursor.time("together"))
    cursor.end()
    return advance


def _read_note(body: bytes) -> frames.NoteFrame:
    cursor = _Cursor("NOTE", body)
    note = frames.NoteFrame(cursor.text("code"), cursor.text("text", MAX_MESSAGE_BYTES))
    cursor.end()
    return note


def _read_calls(body: bytes) -> frames.CallsFrame:
    """Read the head of CALLS; `recorded_calls` reads the calls themselves."""
    if len(body) <= _CALLS_HEAD.size:
        raise ProtocolError("CALLS.t is cut off, or no call follows")
    _, t_ns = _CALLS_HEAD.unpack_from(body)
    if t_ns < 0:
        raise ProtocolError("CALLS.t is negative")
    return frames.CallsFrame(t_ns, body[_CALLS_HEAD.size :])


def _read_facts(body: bytes) -> frames.Facts:
    cursor = _Cursor("FACTS", body)
    what = cursor.choice("what", range(frames.TREE, frames.LEDGER + 1))
    return frames.Facts(what, body[2:])


def _read_exit(body: bytes) -> frames.Exit:
    cursor = _Cursor("EXIT", body)
    ended = frames.Exit(
        t_ns=cursor.time(),
        reason=cursor.choice("reason", range(frames.FINISHED, frames.TOO_MANY_STEPS + 1)),
        after_interrupt=cursor.choice("after_interrupt", range(2)) == 1,
        exit_code=cursor.number("exit_code", _I32),
        exception_type=cursor.text("exception_type"),
        message=cursor.text("message", MAX_MESSAGE_BYTES),
        line=cursor.number("line", _U32),
        detail=cursor.text("text", MAX_DETAIL_BYTES, _U32),
    )
    cursor.end()
    return ended


_READERS: Final[dict[int, Callable[[bytes], frames.Frame]]] = {
    ENTITY: _read_entity,
    GONE: _read_gone,
    PUBLISH: _read_publish,
    REPEAT: _read_repeat,
    REQUEST: _read_request,
    RESPONSE: _read_response,
    ADVANCE: _read_advance,
    NOTE: _read_note,
    CALLS: _read_calls,
    FACTS: _read_facts,
    EXIT: _read_exit,
}
