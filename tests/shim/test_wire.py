"""The shim's end of the wire writes and reads the golden frames byte for byte."""

import importlib.util
import json
import struct
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).resolve().parents[2]
GOLDEN = ROOT / "tests" / "golden" / "wire"
_spec = importlib.util.spec_from_file_location("wire_under_test", ROOT / "grader/shim/rclpy/_wire.py")
assert _spec is not None
assert _spec.loader is not None
wire: Any = importlib.util.module_from_spec(_spec)
_spec.loader.exec_module(wire)


def golden(name: str) -> list[Any]:
    frames = json.loads((GOLDEN / name).read_text("utf-8"))
    return [pytest.param(frame, id=frame["name"]) for frame in frames]


def write(f: dict[str, Any]) -> bytes:
    payload = bytes.fromhex(f.get("payload", ""))
    frame: bytes
    match f["kind"]:
        case "ENTITY":
            quality = (1 if f["reliable"] else 2, 1 if f["transient_local"] else 2, f["depth"])
            frame = wire.entity(f["id"], f["what"], f["t_ns"], (f["node"], f["name"], f["type"]), quality)
        case "GONE":
            frame = wire.gone(f["id"], f["t_ns"])
        case "PUBLISH":
            frame = wire.publish(f["id"], f["t_ns"], payload)
        case "REPEAT":
            frame = wire.repeat(f["id"], f["times_ns"])
        case "REQUEST" | "RESPONSE":
            kind = wire.REQUEST if f["kind"] == "REQUEST" else wire.RESPONSE
            frame = wire.service(kind, f["id"], f["sequence"], f["t_ns"], payload)
        case "ADVANCE":
            frame = wire.advance(f["t_ns"], f["together_ns"])
        case "NOTE":
            frame = wire.note(f["code"], f["text"])
        case _:
            frame = wire.Exit(
                f["t_ns"],
                f["reason"],
                f["after_interrupt"],
                f["exit_code"],
                f["exception_type"],
                f["message"],
                f["line"],
                f["detail"],
            ).frame()
    return frame


@pytest.mark.parametrize("case", golden("jail_to_episode.json"))
def test_what_the_jail_writes(case: dict[str, Any]) -> None:
    body = bytes.fromhex(case["hex"])
    assert write(case["fields"]) == len(body).to_bytes(4, "little") + body


def in_tuples(value: Any) -> Any:
    return tuple(map(in_tuples, value)) if isinstance(value, list) else value


@pytest.mark.parametrize("case", golden("episode_to_jail.json"))
def test_what_the_jail_reads(case: dict[str, Any]) -> None:
    body, fields = bytes.fromhex(case["hex"]), case["fields"]
    if fields["kind"] == "START":
        text, source = wire.read_start(body)
        assert json.loads(text) == fields["json"]
        assert source == bytes.fromhex(fields["source"])
    else:
        now_ns, quiet_ns, events, car = wire.read_events(body)
        assert (now_ns, quiet_ns) == (fields["now_ns"], fields["quiet_ns"])
        events = [(e.what, e.id, e.sequence, e.t_ns, e.cdr.hex()) for e in events]
        assert events == [tuple(event) for event in fields["events"]]
        told = fields.get("car")
        assert car == (told and tuple(map(in_tuples, told.values())))


@pytest.mark.parametrize(
    "body",
    [
        b"\x15" + bytes(16),
        b"\x81" + bytes(16) + b"\x01\x00" + b"\x01" * 19,
        b"\x81" + bytes(18) + b"\x01\x00\x02",
    ],
)
def test_what_is_not_a_frame_is_refused(body: bytes) -> None:
    with pytest.raises((ValueError, struct.error)):
        wire.read_events(body)
    with pytest.raises((ValueError, struct.error)):
        wire.read_start(body)


@pytest.mark.parametrize(
    ("text", "expected"), [("é" * 600, "é" * 512), ("a\ud800", "a?"), ("好" * 400, "好" * 341)]
)
def test_text_is_cut_at_a_character(text: str, expected: str) -> None:
    assert wire.bounded(text, 1024).decode() == expected
