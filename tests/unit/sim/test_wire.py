"""The episode's end of the wire against the golden frames, and against everything that is not a frame."""

import contextlib
import json
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from grader.contracts.errors import ProtocolError
from grader.sim import wire
from grader.sim.frames import CarState, Entity, Event, Exit, NoteFrame
from tests.fakes import jail

GOLDEN = Path(__file__).parents[2] / "golden" / "wire"
KINDS = {"NOTE": "NoteFrame"}


def golden(name: str) -> list[Any]:
    rows = json.loads((GOLDEN / name).read_text(encoding="utf-8"))
    return [pytest.param(bytes.fromhex(row["hex"]), row["fields"], id=row["name"]) for row in rows]


@pytest.mark.parametrize(("body", "fields"), golden("jail_to_episode.json"))
def test_golden_frames_are_read(body: bytes, fields: dict[str, Any]) -> None:
    frame = wire.decode(body)
    kind = fields.pop("kind")
    assert type(frame).__name__ == KINDS.get(kind, kind.capitalize())
    if "payload" in fields:
        fields["payload"] = bytes.fromhex(fields["payload"])
    if "times_ns" in fields:
        fields["times_ns"] = tuple(fields["times_ns"])
    assert frame._asdict() == fields


@pytest.mark.parametrize(("body", "fields"), golden("episode_to_jail.json"))
def test_golden_frames_are_written(body: bytes, fields: dict[str, Any]) -> None:
    if fields["kind"] == "START":
        assert wire.encode_start(fields["json"], bytes.fromhex(fields["source"])) == body
    else:
        events = [Event(*event[:4], bytes.fromhex(event[4])) for event in fields["events"]]
        car = CarState(**fields["car"]) if "car" in fields else None
        assert wire.encode_events(fields["now_ns"], fields["quiet_ns"], events, car) == body


@pytest.mark.parametrize(("body", "fields"), golden("jail_to_episode.json"))
def test_a_frame_that_is_cut_is_refused(body: bytes, fields: dict[str, Any]) -> None:
    whole = len(body) - len(bytes.fromhex(fields.get("payload", "")))  # a payload may have any length
    for length in range(whole):
        with pytest.raises(ProtocolError):
            wire.decode(body[:length])


@pytest.mark.parametrize(("body", "fields"), golden("jail_to_episode.json"))
def test_nothing_may_follow_the_last_field(body: bytes, fields: dict[str, Any]) -> None:
    if "payload" in fields:
        return
    with pytest.raises(ProtocolError, match="followed by 1 bytes"):
        wire.decode(body + b"\0")


@pytest.mark.parametrize(
    ("body", "words"),
    [
        (b"", "empty frame"),
        (b"\x80", "unknown frame kind 0x80"),
        (jail.entity(1, 6), "ENTITY.what is 6"),
        (jail.entity(1, 1, -1), "ENTITY.t is negative"),
        (jail.entity(1, 1, node="/" + "x" * 501), "ENTITY.node has 502 bytes, 501 allowed"),
        (jail.entity(1, 2, name="/" + "x" * 255), "ENTITY.name has 256 bytes, 255 allowed"),
        (jail.entity(1, 1, node="/\x01"), "ENTITY.node is not a name"),
        (jail.entity(1, 1, node="student"), "ENTITY.node is not a name"),
        (jail.entity(1, 2, name="/2d"), "ENTITY.name is not a name"),
        (jail.entity(1, 2, name="/a\n"), "ENTITY.name is not a name"),
        (jail.entity(1, 2, name="/a", type="Twist"), "ENTITY.type is not a name"),
        (jail.entity(1, 2, reliability=0), "ENTITY.reliability is 0"),
        (jail.entity(1, 2, durability=3), "ENTITY.durability is 3"),
        (jail.publish(1, -1, b""), "PUBLISH.t is negative"),
        (jail.repeat(1), "REPEAT.times is empty"),
        (jail.repeat(1, 5, -1), "REPEAT.times is empty or has a negative one"),
        (jail.request(1, 1, -5, b""), "REQUEST.t is negative"),
        (jail.response(1, 1, -5, b""), "RESPONSE.t is negative"),
        (jail.advance(-1), "ADVANCE.t is negative"),
        (jail.advance(0, -1), "ADVANCE.together is negative"),
        (b"\x20" + jail.text(b"\xff") + jail.text(""), "NOTE.code is not UTF-8"),
        (
            b"\x20" + jail.text("a") + jail.text("\ud800".encode("utf-8", "surrogatepass")),
            "NOTE.text is not UTF-8",
        ),
        (jail.note("a", "x" * 4_097), "NOTE.text has 4097 bytes"),
        (jail.ended(0, reason=6), "EXIT.reason is 6"),
        (jail.ended(0, after_interrupt=2), "EXIT.after_interrupt is 2"),
        (jail.ended(0, detail="x" * 16_385), "EXIT.text has 16385 bytes"),
    ],
)
def test_a_refusal_names_the_field(body: bytes, words: str) -> None:
    with pytest.raises(ProtocolError, match=words.replace(".", r"\.")):
        wire.decode(body)


@given(st.binary(max_size=200))
def test_any_bytes_are_a_frame_or_a_protocol_error(body: bytes) -> None:
    with contextlib.suppress(ProtocolError):
        wire.decode(body)


FRAMES = [row.values[0] for row in golden("jail_to_episode.json")]


@given(st.sampled_from(FRAMES), st.lists(st.tuples(st.integers(0, 200), st.binary(max_size=4)), max_size=4))
def test_a_frame_with_wrong_bytes_is_a_frame_or_a_protocol_error(
    body: bytes, patches: list[tuple[int, bytes]]
) -> None:
    changed = bytearray(body)
    for at, patch in patches:
        changed[at : at + len(patch)] = patch
    with contextlib.suppress(ProtocolError):
        wire.decode(bytes(changed))


NAMES = st.text(st.characters(exclude_categories=["Cs"]), max_size=60)


ROS_NAMES = st.from_regex(r"(/[A-Za-z_][A-Za-z0-9_]{0,9}){0,5}", fullmatch=True)
TYPES = st.from_regex(r"([a-z][a-z0-9_]{0,9}/msg/[A-Z][A-Za-z0-9]{0,9})?", fullmatch=True)


@given(st.integers(0, 65_535), st.integers(1, 5), st.integers(0, 2**63 - 1), ROS_NAMES, ROS_NAMES, TYPES)
def test_an_entity_comes_through(
    identity: int, what: int, t_ns: int, node: str, name: str, kind: str
) -> None:
    frame = wire.decode(jail.entity(identity, what, t_ns, node=node, name=name, type=kind))
    assert frame == Entity(identity, what, t_ns, node, name, kind, True, False, 10)


@given(NAMES, NAMES)
def test_a_note_comes_through(code: str, text: str) -> None:
    assert wire.decode(jail.note(code, text)) == NoteFrame(code, text)


@given(st.integers(0, 2**63 - 1), st.integers(-(2**31), 2**31 - 1), NAMES, st.integers(0, 2**32 - 1))
def test_an_exit_comes_through(t_ns: int, code: int, words: str, line: int) -> None:
    frame = wire.decode(
        jail.ended(t_ns, reason=2, code=code, type=words, message=words, line=line, detail=words)
    )
    assert frame == Exit(t_ns, 2, False, code, words, words, line, words)
