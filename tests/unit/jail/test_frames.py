"""Frames out of hostile bytes."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from grader.contracts.errors import ProtocolError
from grader.jail import bounds
from grader.jail.jail import FrameReader, pack


def read_all(reader: FrameReader) -> list[bytes]:
    frames = []
    while (frame := reader.next()) is not None:
        frames.append(frame)
    return frames


@given(st.lists(st.binary(min_size=1, max_size=300), max_size=12), st.lists(st.integers(1, 400), min_size=1))
def test_frames_survive_any_cutting(bodies: list[bytes], sizes: list[int]) -> None:
    data = b"".join(map(pack, bodies))
    reader, frames, at, turn = FrameReader(), [], 0, 0
    while at < len(data):
        size = sizes[turn % len(sizes)]
        reader.feed(data[at : at + size])
        frames += read_all(reader)
        at, turn = at + size, turn + 1
    assert frames == bodies
    assert reader.pending_bytes == 0


@given(st.lists(st.binary(max_size=200)))
def test_any_bytes_give_frames_or_a_protocol_error(pieces: list[bytes]) -> None:
    reader, total = FrameReader(), 0
    try:
        for piece in pieces:
            reader.feed(piece)
            total += sum(len(frame) + 4 for frame in read_all(reader))
    except ProtocolError:
        return
    assert total + reader.pending_bytes == sum(map(len, pieces))


@given(st.one_of(st.just(0), st.integers(bounds.FRAME_MAX_BYTES + 1, 2**32 - 1)))
def test_an_impossible_length_is_refused_before_its_bytes_arrive(length: int) -> None:
    reader = FrameReader()
    reader.feed(length.to_bytes(4, "little"))
    with pytest.raises(ProtocolError, match=str(length)):
        reader.next()


def test_the_largest_frame_passes() -> None:
    reader = FrameReader()
    reader.feed(pack(b"x" * bounds.FRAME_MAX_BYTES))
    assert read_all(reader) == [b"x" * bounds.FRAME_MAX_BYTES]


def test_frames_and_bytes_of_a_run_are_bounded(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bounds, "FRAMES_MAX", 3)
    monkeypatch.setattr(bounds, "CHANNEL_MAX_BYTES", 100)
    reader = FrameReader()
    reader.feed(pack(b"a") * 4)
    assert [reader.next() for _ in range(3)] == [b"a"] * 3
    with pytest.raises(ProtocolError, match="3 messages"):
        reader.next()
    with pytest.raises(ProtocolError, match="100 bytes"):
        reader.feed(bytes(81))
