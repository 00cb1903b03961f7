"""`grader run FILE`: drive the simulated turtle with a script and look, without grading."""

import argparse
import math
import re
import sys
from pathlib import Path

from grader.catalog.files import interface_files
from grader.commands.check import faults_explained, read_source
from grader.commands.options import add_grading_options, add_language_option
from grader.contracts.assignment import TOPIC_PATTERN, Assignment, Case, InterfaceDefinition, World
from grader.contracts.errors import AssignmentError
from grader.contracts.grading import GradingJob, GradingResult
from grader.contracts.notation import decimal
from grader.contracts.outcome import Blame
from grader.contracts.text import EMPTY
from grader.contracts.trajectory import decode_trajectory
from grader.grading.slot import Slot, SlotConfig

PASSES_ON = "args"
"""The option that takes everything after the first ``--``, further ``--`` included: the script's arguments."""

_LONGEST_TOPIC = 247  # characters, as rmw_validate_full_topic_name has it


def configure(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments."""
    parser.add_argument("file", type=Path, help="the script to run / 要运行的脚本")
    parser.add_argument(
        "args", nargs="*", help="arguments for the script, after -- / 传给脚本的参数，写在 -- 后面"
    )
    parser.add_argument("--for", dest="horizon_s", type=_seconds, default=60.0, metavar="SECONDS",
                        help="virtual seconds until Ctrl+C (60) / 虚拟时间多少秒后按 Ctrl+C")  # fmt: skip
    parser.add_argument(
        "--input", default="", metavar="TEXT", help="what input() reads; \\n ends a line / input() 读到的内容"
    )
    parser.add_argument(
        "--topic",
        type=_topic,
        default="/turtle1/cmd_vel",
        help="topic that moves the turtle / 控制小乌龟的话题",
    )
    parser.add_argument(
        "--no-walls", action="store_true", help="an open world instead of turtlesim's window / 没有墙"
    )
    parser.add_argument("--interfaces", type=Path, metavar="DIR",
                        help="import the interfaces of this assignment's folder / 用这个作业的接口")  # fmt: skip
    add_language_option(parser)
    add_grading_options(parser)


def run(arguments: argparse.Namespace) -> int:
    """Run the script; 0 when it ended well, 1 when it failed."""
    job = GradingJob(
        file_name=arguments.file.name, source=read_source(arguments.file), assignment=_sandpit(arguments)
    )
    with faults_explained(), Slot(SlotConfig(mode=arguments.isolation)) as slot:
        result = slot.grade(job)
    _show(arguments, result)
    return 0 if result.report.runs[0].outcome.blame is Blame.NOBODY else 1


def _sandpit(arguments: argparse.Namespace) -> Assignment:
    """Return an assignment that asks for nothing."""
    return Assignment(
        id="run",
        version=1,
        order=0,
        title=EMPTY,
        brief=EMPTY,
        check="node",
        items=(),
        horizon_s=arguments.horizon_s,
        world=World(cmd_vel_topic=arguments.topic, walls=not arguments.no_walls),
        interfaces=_interfaces(arguments.interfaces),
        cases=(Case(stdin=arguments.input.replace("\\n", "\n"), args=tuple(arguments.args)),),
    )


def _interfaces(folder: Path | None) -> tuple[InterfaceDefinition, ...]:
    if folder is None:
        return ()
    from grader.catalog.interfaces import read_interfaces

    if not interface_files(folder):
        raise AssignmentError(
            f"{folder} brings no interfaces; name an assignment's folder, such as assignments/rosclaw",
            f"{folder} 里没有 interfaces：指明一个作业文件夹，例如 assignments/rosclaw",
        )
    return read_interfaces(folder)


def _show(arguments: argparse.Namespace, result: GradingResult) -> None:
    from grader.render.escape import visible
    from grader.render.terminal import console
    from grader.render.timeline import render_timeline

    outcome = result.report.runs[0].outcome
    trajectory = decode_trajectory(result.trajectories[result.report.runs[0].case])
    for stream, target in ((outcome.stdout, sys.stdout), (outcome.stderr, sys.stderr)):
        target.write(visible(stream.text))
    output = console()
    output.print(render_timeline(outcome, trajectory, language=arguments.lang))
    x_m, y_m = trajectory.x_m[-1], trajectory.y_m[-1]
    heading_deg = math.degrees(math.remainder(trajectory.heading_rad[-1], math.tau))
    output.print(
        f"x = {x_m:.3f} m   y = {y_m:.3f} m   θ = {heading_deg:.1f}°   t = {outcome.duration_ns / 1e9:.3f} s"
    )


def _topic(text: str) -> str:
    if not re.fullmatch(TOPIC_PATTERN, text) or len(text) > _LONGEST_TOPIC:
        raise argparse.ArgumentTypeError(
            f"{text!r} is no name of a topic: / and letters, digits, _, such as /turtle1/cmd_vel"
        )
    return text


def _seconds(text: str) -> float:
    try:
        value = decimal(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is not a number of seconds") from None
    if not 0.0 < value <= 600.0:
        raise argparse.ArgumentTypeError(f"{text}: must be more than 0 and at most 600 virtual seconds")
    return value
