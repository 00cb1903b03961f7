"""The moving picture of a drive: what its frames show, at which pace, and what a pipe gets."""

import io
import math
from dataclasses import replace

import numpy as np
import pytest
from rich.console import Console

from grader.contracts.outcome import LogRecord
from grader.render.live import Film, watch
from tests.unit.render.samples import SECOND, IdealTurtle

LOGS = (
    LogRecord(t_ns=SECOND // 2, level=20, name="n", message="begin"),
    LogRecord(t_ns=2 * SECOND, level=20, name="n", message="\x1b[2Jdone"),
)


def drawn(film: Film, t_ns: int) -> str:
    stream = io.StringIO()
    Console(file=stream, width=80).print(film.frame(t_ns))
    return stream.getvalue()


def dots(frame: str) -> int:
    return sum((ord(each) - 0x2800).bit_count() for each in frame if 0x2800 <= ord(each) < 0x2900)


def test_the_trail_grows_and_the_pose_is_told() -> None:
    film = Film(
        IdealTurtle().go(1.0, 0.0, 2.0).go(0.0, 1.0, math.pi / 2).trajectory(), LOGS, rows=20, columns=80
    )
    begin, middle, end = (drawn(film, t_ns) for t_ns in (0, SECOND, film.end_ns))
    assert dots(begin) < dots(middle) <= dots(end)
    assert "x = 5.54 m" in begin
    assert "begin" not in begin
    assert "[INFO] begin" in middle
    assert "θ = 90°" in end
    assert "\\x1b[2Jdone" in end


def test_a_jump_leaves_no_trail_and_a_car_outside_the_window_is_seen() -> None:
    turtle = IdealTurtle().stop(0.1)
    turtle.x_m = 40.0
    far = turtle.stop(0.1).trajectory()
    jumped = replace(far, jumps=(int(np.argmax(np.diff(far.x_m))) + 1,))
    film = Film(jumped, (), rows=20, columns=80)
    assert dots(drawn(film, film.end_ns)) < 40


@pytest.mark.parametrize(("speed", "frames"), [(1.0, 3), (4.0, 1)])
def test_it_is_shown_at_its_pace_or_faster(speed: float, frames: int) -> None:
    stream = io.StringIO()
    terminal = Console(file=stream, width=80, height=24, force_terminal=True, color_system=None)
    clock = [0.0]

    def sleep(pause_s: float) -> None:
        clock[0] += 1.0  # a slow terminal: frames are left out, not played slower

    drive = IdealTurtle().go(1.0, 0.0, 2.9).trajectory()
    watch(terminal, drive, (), speed=speed, now_s=lambda: clock[0], sleep=sleep)
    assert clock[0] == pytest.approx(frames)
    assert "t = 2.90 s" in stream.getvalue()


def test_a_pipe_gets_the_last_picture_without_control_characters() -> None:
    stream = io.StringIO()
    watch(Console(file=stream, width=80), IdealTurtle().go(1.0, 0.0, 2.0).trajectory(), LOGS)
    assert "\x1b" not in stream.getvalue()
    assert "t = 2.00 s" in stream.getvalue()


def test_a_narrow_terminal_has_the_pose_below() -> None:
    film = Film(IdealTurtle().go(1.0, 0.0, 2.0).trajectory(), LOGS, rows=12, columns=40)
    assert drawn(film, SECOND).rstrip().splitlines()[-1].startswith("t = 1.00 s")
