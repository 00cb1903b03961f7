"""What the fuzzer feeds: each decoder of bytes that cross the jail's border, with what must hold of it.

A target takes any bytes and raises `AssertionError`, or whatever the decoder wrongly raised, on a finding;
it returns whether the decoder took the bytes for well-formed.
"""

from __future__ import annotations

import json
import struct
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, Final

ROOT: Final = Path(__file__).resolve().parents[1]
SHIM: Final = ROOT / "grader" / "shim"

if str(SHIM) not in sys.path:
    sys.path.insert(0, str(SHIM))

import rclpy._interfaces.own  # noqa: E402, F401 - makes the interface packages importable
from rclpy import _wire as shim_wire  # noqa: E402
from rclpy._interfaces import cdr as shim_cdr  # noqa: E402
from rclpy._interfaces.definitions import INTERFACES  # noqa: E402
from rclpy._interfaces.messages import CLASSES, interface_class  # noqa: E402

from grader.contracts.errors import ProtocolError  # noqa: E402
from grader.jail import bounds  # noqa: E402
from grader.jail.jail import FrameReader, pack  # noqa: E402
from grader.sim import cdr, wire  # noqa: E402
from grader.sim.interfaces import ros_types  # noqa: E402

Target = Callable[[bytes], bool]

TRUSTED_TYPES: Final = sorted(ros_types().fields)
for _name in [name for name in INTERFACES if "/msg/" in name]:
    interface_class(_name)
SHIM_TYPES: Final = sorted(CLASSES)


def trusted_frames(data: bytes) -> bool:
    """`FrameReader`: the same frames however the bytes are cut, and never more memory than was sent."""
    if not data:
        return False
    step = data[0] + 1
    whole = _frames([data[1:]])
    assert whole == _frames([data[i : i + step] for i in range(1, len(data), step)])
    return bool(whole)


def _frames(pieces: list[bytes]) -> list[bytes]:
    reader = FrameReader()
    found: list[bytes] = []
    try:
        for piece in pieces:
            reader.feed(piece)
            while (frame := reader.next()) is not None:
                assert 1 <= len(frame) <= bounds.FRAME_MAX_BYTES
                found.append(frame)
    except ProtocolError:
        found.append(b"")
    return found


def trusted_wire(data: bytes) -> bool:
    """`grader.sim.wire.decode`: a frame with every field in its range, or `ProtocolError`."""
    try:
        frame = wire.decode(data)
    except ProtocolError:
        return False
    for name, value in frame._asdict().items():
        if isinstance(value, str):
            assert len(value.encode()) <= wire.MAX_DETAIL_BYTES, name
        if name == "t_ns":
            assert 0 <= value < 1 << 63
    return True


def trusted_cdr(data: bytes) -> bool:
    """`grader.sim.cdr.decode`: what is read can be written, and then reads the same."""
    (index,) = struct.unpack("<H", data[:2].ljust(2, b"\0"))
    name = TRUSTED_TYPES[index % len(TRUSTED_TYPES)]
    message = cdr.HEADER + data[2:]
    try:
        values = cdr.decode(name, message)
    except ProtocolError:
        return False
    written = cdr.encode(name, values)
    assert len(written) == len(message), name
    assert cdr.encode(name, cdr.decode(name, written)) == written, name
    if name in CLASSES:
        shim_cdr.deserialize(message, CLASSES[name])  # the lenient side reads all that the strict one does
    return True


def jail_wire(data: bytes) -> bool:
    """`rclpy._wire`: START or EVENTS, or an error the link knows."""
    read: Callable[[bytes], Any] = shim_wire.read_events if data[:1] == b"\x81" else shim_wire.read_start
    try:
        read(data)
    except (ValueError, struct.error):
        return False
    return True


def jail_cdr(data: bytes) -> bool:
    """`rclpy._interfaces.cdr.deserialize`: what is read can be serialized, and then reads the same."""
    (index,) = struct.unpack("<H", data[:2].ljust(2, b"\0"))
    message_class = CLASSES[SHIM_TYPES[index % len(SHIM_TYPES)]]
    try:
        message: Any = shim_cdr.deserialize(shim_cdr.HEADER + data[2:], message_class)
    except shim_cdr.CdrError:
        return False
    written = shim_cdr.serialize(message)
    assert shim_cdr.serialize(shim_cdr.deserialize(written, message_class)) == written, message_class
    return True


TARGETS: Final[dict[str, Target]] = {
    target.__name__: target for target in (trusted_frames, trusted_wire, trusted_cdr, jail_wire, jail_cdr)
}


def seeds(name: str) -> list[bytes]:
    """Return well-formed inputs of the target `name` to start from."""
    return list(_SEEDS[name]())


def _golden(file: str) -> list[bytes]:
    rows = json.loads((ROOT / "tests" / "golden" / "wire" / file).read_text(encoding="utf-8"))
    return [bytes.fromhex(row["hex"]) for row in rows]


def _stream_seeds() -> Iterator[bytes]:
    frames = _golden("jail_to_episode.json")
    yield b"\x03" + b"".join(map(pack, frames))
    for frame in frames:
        yield b"\x40" + pack(frame)


def _trusted_cdr_seeds() -> Iterator[bytes]:
    for index, name in enumerate(TRUSTED_TYPES):
        yield struct.pack("<H", index) + cdr.encode(name)[4:]


def _jail_cdr_seeds() -> Iterator[bytes]:
    for index, name in enumerate(SHIM_TYPES):
        yield struct.pack("<H", index) + shim_cdr.serialize(CLASSES[name]())[4:]


_SEEDS: Final[dict[str, Callable[[], Iterator[bytes]]]] = {
    "trusted_frames": _stream_seeds,
    "trusted_wire": lambda: iter(_golden("jail_to_episode.json")),
    "trusted_cdr": _trusted_cdr_seeds,
    "jail_wire": lambda: iter(_golden("episode_to_jail.json")),
    "jail_cdr": _jail_cdr_seeds,
}
