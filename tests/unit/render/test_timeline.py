"""The timeline tells what happened when, without drowning in repeated commands."""

import io
from dataclasses import replace

from grader.contracts.grading import WorldRequest
from grader.contracts.outcome import LogRecord, Note, RunOutcome, RunStatus
from grader.contracts.text import Language
from grader.contracts.trajectory import Contact, Trajectory
from grader.render.terminal import console
from grader.render.timeline import MOST_EVENTS, render_timeline
from tests.unit.render.samples import SECOND, IdealTurtle, crash, outcome


def lines(
    run: RunOutcome,
    trajectory: Trajectory | None = None,
    language: Language = "zh",
    requests: tuple[WorldRequest, ...] = (),
) -> list[str]:
    stream = io.StringIO()
    console(stream, 100).print(render_timeline(run, trajectory, language=language, requests=requests))
    return [line.rstrip() for line in stream.getvalue().split("\n") if " s  " in line]


def test_events_in_order_of_time() -> None:
    contact = Contact(start_ns=1 * SECOND, end_ns=2 * SECOND, wall="right")
    motion = IdealTurtle().go(1.0, 0.0, 2.0).go(0.0, -1.5, 1.0).trajectory((contact,))
    run = outcome(duration_ns=5 * SECOND)
    assert lines(run, motion) == [
        " 0.000 s   速度命令 v = 1 m/s, ω = 0 rad/s  共 20 条，作用 2 s，前进 2 m",
        " 0.001 s   [INFO] [square_mover]: 🎯 正方形控制节点启动!",
        " 1.000 s   撞到右墙",
        " 2.000 s   速度命令 v = 0 m/s, ω = -1.5 rad/s  共 10 条，作用 1 s，右转 85.9°",
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


def test_calls_and_where_they_put_the_turtle() -> None:
    motion = replace(IdealTurtle().stop(0.1).go(1.0, 0.0, 1.0).trajectory(), jumps=(1,))
    request = WorldRequest(t_ns=int(motion.t_ns[1]) + 5, service="/turtle1/teleport_absolute", values="x=2")
    shown = [
        line
        for line in lines(outcome(logs=()), motion, "en", (request,))
        if "turtle1" in line or "jump" in line
    ]
    assert "called /turtle1/teleport_absolute(x=2)" in shown[0]
    assert "jumped to x = 5.544 m" in shown[1]


def test_a_drive_that_turtlesim_ended_is_told() -> None:
    once = replace(
        (driven := IdealTurtle().go(1.0, 0.0, 1.0).stop(4.0).trajectory()), commands=driven.commands[:1]
    )
    assert "作用 1 s，前进 1 m，之后 1" in lines(outcome(logs=()), once)[0]


def test_equal_messages_in_a_row_are_one_line() -> None:
    logs = tuple(LogRecord(t_ns=i * SECOND, level=20, name="n", message="Published") for i in range(1, 5))
    assert lines(outcome(logs=logs))[0] == "  1.000 s   [INFO] [n]: Published  共 4 条，到 4.000 s"


def test_the_queue_of_commands_is_told_where_the_turtle_first_drove_on() -> None:
    said = IdealTurtle().go(1.0, 0.0, 2.0).stop().trajectory()
    driven = replace(IdealTurtle().go(1.0, 0.0, 2.1).stop().trajectory(), commands=said.commands)
    run = outcome(logs=(), notes=(Note(code="commands_wait", text="100|0.10"),))
    shown = lines(run, replace(driven, commanded=said), language="en")
    (told,) = (line for line in shown if "queue" in line)
    assert told.lstrip().startswith("2.0")
    assert "(100 a second come, 62.5 are taken)" in told
    assert "ahead 2 m" in shown[0] or "2 m ahead" in shown[0]  # as commanded, not as driven
