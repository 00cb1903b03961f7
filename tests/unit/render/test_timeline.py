"""The timeline tells what happened when, without drowning in repeated commands."""

import io

from grader.contracts.outcome import LogRecord, RunOutcome, RunStatus
from grader.contracts.text import Language
from grader.contracts.trajectory import Contact, Trajectory
from grader.render.terminal import console
from grader.render.timeline import MOST_EVENTS, render_timeline
from tests.unit.render.samples import SECOND, IdealTurtle, crash, outcome


def lines(run: RunOutcome, trajectory: Trajectory | None = None, language: Language = "zh") -> list[str]:
    stream = io.StringIO()
    console(stream, 100).print(render_timeline(run, trajectory, language=language))
    return [line.rstrip() for line in stream.getvalue().split("\n") if " s  " in line]


def test_events_in_order_of_time() -> None:
    contact = Contact(start_ns=1 * SECOND, end_ns=2 * SECOND, wall="right")
    motion = IdealTurtle().go(1.0, 0.0, 2.0).go(0.0, -1.5, 1.0).trajectory((contact,))
    run = outcome(duration_ns=5 * SECOND)
    assert lines(run, motion) == [
        " 0.000 s   速度命令 v = 1 m/s, ω = 0 rad/s  共 20 条，持续 1.9 s",
        " 0.001 s   [INFO] [square_mover]: 🎯 正方形控制节点启动!",
        " 1.000 s   撞到右墙",
        " 2.000 s   速度命令 v = 0 m/s, ω = -1.5 rad/s  共 10 条，持续 0.9 s",
        " 2.100 s   [INFO] [square_mover]: ✓ 直行完成",
        " 5.000 s   结束: 程序正常结束",
    ]


def test_the_end_names_the_error() -> None:
    run = outcome(status=RunStatus.CRASHED, error=crash(), logs=())
    (end,) = lines(run, language="en")
    assert "end: the script crashed - AssertionError: The 'x' field must be of type 'float'" in end


def test_a_long_timeline_loses_its_middle() -> None:
    logs = tuple(LogRecord(t_ns=i * SECOND, level=20, name="n", message=f"log {i}.") for i in range(1000))
    shown = lines(outcome(logs=logs, duration_ns=1000 * SECOND))
    assert len(shown) == MOST_EVENTS + 1
    assert "log 0." in shown[0]
    assert "801" in shown[MOST_EVENTS // 2]
    assert "结束" in shown[-1]


def test_log_text_is_escaped() -> None:
    logs = (LogRecord(t_ns=0, level=40, name="n", message="\x1b[31m\ntwo [bold]x[/bold]"),)
    assert "[ERROR] [n]: \\x1b[31m\\ntwo [bold]x[/bold]" in lines(outcome(logs=logs))[0]
