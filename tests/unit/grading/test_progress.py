"""What is told of a run while it lasts."""

from types import SimpleNamespace
from typing import Any

from grader.contracts.grading import RunProgress
from grader.contracts.outcome import Stream
from grader.grading.progress import ProgressLink, last_lines

ADDRESS = "<node at 0x7f1c2d>\n"


def link(clock: list[float], told: list[RunProgress]) -> ProgressLink:
    """A link to a process that has sent three frames; each time the clock is asked, it is the next instant."""
    frames = [b"a", b"b", None]
    jail: Any = SimpleNamespace(
        receive=lambda: frames.pop(0), printed=lambda: (Stream(text=ADDRESS + "half a l"), Stream(text="x\n"))
    )
    episode: Any = SimpleNamespace(now_ns=7)
    return ProgressLink(jail, episode, told.append, "humble", lambda: clock.pop(0))


def test_it_tells_now_and_then_and_passes_every_frame_on() -> None:
    told: list[RunProgress] = []
    one = link([0.0, 0.2, 0.3, 0.4], told)
    assert [one.receive() for _ in range(3)] == [b"a", b"b", None]
    assert told == [RunProgress(t_ns=7, stdout="<node at 0x…>\n", stderr="x\n")]


def test_the_last_lines_are_whole_and_few() -> None:
    assert last_lines("a\nb\nc", 100) == "a\nb\n"
    assert last_lines("aaaa\nbb\ncc\n", 5) == "cc\n"
    assert last_lines("aaaa\nbb\ncc\n", 8) == "bb\ncc\n"
    assert last_lines("x" * 50 + "\n", 8) == ""
    assert last_lines("no end", 8) == ""
