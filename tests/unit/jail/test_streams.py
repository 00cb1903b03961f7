"""Bounded capture of output."""

import os

from hypothesis import given
from hypothesis import strategies as st

from grader.jail import bounds
from grader.jail.jail import Capture

HEAD, TAIL = bounds.STREAM_HEAD_BYTES, bounds.STREAM_TAIL_BYTES


def capture(blocks: list[bytes], limit_bytes: int = 1 << 22) -> Capture:
    reading, writing = os.pipe()
    captured = Capture(reading, limit_bytes)
    for block in blocks:
        for at in range(0, len(block), 32_768):
            os.write(writing, block[at : at + 32_768])
            captured.drain()
    os.close(writing)
    captured.drain()
    captured.close()
    return captured


@given(st.lists(st.integers(0, 90_000), max_size=8))
def test_head_and_tail_are_kept_and_the_rest_counted(sizes: list[int]) -> None:
    blocks = [bytes([97 + n]) * size for n, size in enumerate(sizes)]
    data = b"".join(blocks).decode()
    captured = capture(blocks)
    stream = captured.stream()
    assert captured.ended
    assert captured.total_bytes == len(data)
    if len(data) <= HEAD + TAIL:
        assert (stream.text, stream.dropped_bytes) == (data, 0)
    else:
        assert stream.dropped_bytes == len(data) - HEAD - TAIL
        assert stream.text.startswith(data[:HEAD])
        assert stream.text.endswith(data[-TAIL:])
        assert str(stream.dropped_bytes) in stream.text


@given(st.binary(max_size=2000))
def test_any_bytes_become_text(data: bytes) -> None:
    assert capture([data]).stream().text == data.decode(errors="replace")


@given(st.integers(0, 300_000))
def test_a_flood_is_cut_at_the_limit_whenever_it_was_noticed(noticed_after: int) -> None:
    data = b"0123456789" * 20_000
    cut = capture([data, b"x" * noticed_after], limit_bytes=len(data)).stream()
    assert cut == capture([data], limit_bytes=len(data)).stream()
