"""`grader run FILE`: drive the simulated turtle with a script and look, without grading."""

import argparse
import math
import re
import sys
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from grader.catalog.files import INTERFACES, interface_files
from grader.commands.check import faults_explained, handed_in_name, read_handed_in
from grader.commands.options import (
    add_distro_option,
    add_grading_options,
    add_language_option,
    add_way_option,
    wrong_value,
)
from grader.commands.plots import check_plot_path, form_of, write_file
from grader.contracts.assignment import (
    TOPIC_PATTERN,
    Assignment,
    Case,
    InterfaceDefinition,
    WantedPackage,
    World,
)
from grader.contracts.errors import AssignmentError, SettingsError
from grader.contracts.grading import GradingJob, GradingResult
from grader.contracts.notation import decimal
from grader.contracts.outcome import Blame, RunOutcome
from grader.contracts.report import GradeReport
from grader.contracts.text import EMPTY, Text
from grader.contracts.trajectory import Trajectory, decode_trajectory
from grader.formats.packages.bundle import is_package
from grader.grading.slot import Slot, SlotConfig
from grader.messages.quantity import number
from grader.render.labels import word

if TYPE_CHECKING:
    from rich.console import Console

PASSES_ON = "args"
"""The option that takes everything after the first ``--``, further ``--`` included: the script's arguments."""

_NOT_ASKED = ("no_publisher", "teleported")
"""Mistakes in an exercise about driving that are none in a mere run."""

_MOST_SPEED = 100.0
_LONGEST_TOPIC = 247  # characters, as rmw_validate_full_topic_name has it


def configure(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments."""
    parser.add_argument("file", type=Path, help="the script or package to run / 要运行的脚本或功能包")
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
    _add_package_options(parser)
    add_distro_option(parser, help="release of ROS 2 that the script finds (humble) / 脚本用的 ROS 2 版本")
    add_way_option(parser)
    parser.add_argument("--interfaces", type=Path, metavar="DIR",
                        help="import the interfaces of this assignment's folder / 用这个作业的接口")  # fmt: skip
    parser.add_argument(
        "--watch",
        action="store_true",
        help="show the drive as it goes, in the terminal / 在终端里播放行驶过程",
    )
    parser.add_argument(
        "--speed", type=_factor, default=1.0, metavar="FACTOR", help="of --watch (1) / 播放速度的倍数（1）"
    )
    parser.add_argument(
        "--plot", type=Path, metavar="OUT", help="draw the drive to OUT, .png or .svg / 把轨迹画到 OUT"
    )
    add_language_option(parser)
    add_grading_options(parser)


def _add_package_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "-a",
        "--assignment",
        default="",
        metavar="ID",
        help="speak to the script as this assignment does / 按这个作业的步骤和程序对话",
    )
    parser.add_argument(
        "--executable",
        default="",
        metavar="NAME",
        help="of a package: what to run / 功能包里要运行的可执行文件",
    )
    parser.add_argument(
        "--launch",
        default="",
        metavar="FILE",
        help="of a package: the launch file to start / 要启动的 launch 文件",
    )


def run(arguments: argparse.Namespace) -> int:
    """Run the script; 0 when it ended well, 1 when it failed."""
    if arguments.plot is not None:
        check_plot_path(arguments.plot)
    source = read_handed_in(arguments.file)
    if (arguments.executable or arguments.launch) and not is_package(source):
        raise SettingsError(
            f"{arguments.file} is a script: --executable and --launch choose what to run of a package",
            f"{arguments.file} 是脚本：--executable 和 --launch 用来选功能包里要运行的程序",
        )
    assignment = _spoken_to(arguments) if arguments.assignment else _sandpit(arguments, source)
    job = GradingJob(file_name=handed_in_name(arguments.file), source=source, assignment=assignment)
    with faults_explained(), Slot(SlotConfig(mode=arguments.isolation)) as slot:
        result = slot.grade(job)
    _show(arguments, result)
    return 0 if result.report.runs[0].outcome.blame is Blame.NOBODY else 1


def _spoken_to(arguments: argparse.Namespace) -> Assignment:
    from grader.catalog import Catalog

    return Catalog().get(arguments.assignment).of_course(arguments.distro, arguments.runs_as)


def _sandpit(arguments: argparse.Namespace, source: bytes = b"") -> Assignment:
    """Return an assignment that asks for nothing; of a package it runs what the options name."""
    name, packed = arguments.file.name, is_package(source)
    package = WantedPackage(executable=arguments.executable, launch=arguments.launch)
    return Assignment(
        id="run",
        version=1,
        order=0,
        title=Text(zh=name, en=name),
        brief=EMPTY,
        check="motion",
        options={"direction": "forward"},
        items=(),
        input="package" if packed else "script",
        package=package if packed else None,
        horizon_s=arguments.horizon_s,
        world=World(cmd_vel_topic=arguments.topic, walls=not arguments.no_walls),
        interfaces=_interfaces(arguments.interfaces),
        distro=arguments.distro,
        runs_as=arguments.runs_as,
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

    run = result.report.runs[0]
    trajectory = decode_trajectory(result.trajectories[run.case])
    requests = result.requests.get(run.case, ())
    output = console()
    if arguments.watch:
        from grader.render.live import watch

        watch(output, trajectory, run.outcome.logs, speed=arguments.speed)
    for stream, target in ((run.outcome.stdout, sys.stdout), (run.outcome.stderr, sys.stderr)):
        text = visible(stream.text)
        target.write(text if not text or text.endswith("\n") else f"{text}\n")
        target.flush()
    output.print(render_timeline(run.outcome, trajectory, language=arguments.lang, requests=requests))
    output.print(_end(run.outcome, trajectory))
    _advise(arguments, result.report, output)
    if arguments.plot is not None:
        _plot(arguments, result.report, trajectory)


def _end(outcome: RunOutcome, track: Trajectory) -> str:
    heading_deg = math.degrees(math.remainder(float(track.heading_rad[-1]), math.tau))
    return (
        f"x = {track.x_m[-1]:.3f} m   y = {track.y_m[-1]:.3f} m   θ = {number(heading_deg, 'deg')}"
        f"   t = {outcome.duration_ns / 1e9:.3f} s"
    )


def _advise(arguments: argparse.Namespace, report: GradeReport, output: "Console") -> None:
    """Print what `grader check` would call the next step, unless it is about an exercise, and its notes."""
    from grader.render.escape import visible
    from grader.render.prose import Prose
    from grader.render.terminal import next_steps, run_notes

    lines = []
    code = report.mistakes[0] if report.mistakes else ""
    if (folder := _interfaces_for(report)) is not None:
        lines.append(word("give_interfaces", arguments.lang, folder=folder))
    elif code not in (*_NOT_ASKED, "", "no_input"):  # the hint on input speaks of an exercise
        lines.append(visible(report.hint.get(arguments.lang)))
    if code in ("no_input", "asks_again"):
        command = f"grader run {visible(str(arguments.file))} --input '2.0'"
        lines.append(word("give_input", arguments.lang, command=command))
    for note in run_notes(report.runs[0].outcome, arguments.lang):
        output.print(Prose(f"· {note}", style="dim"))
    if lines:
        output.print()
        output.print(next_steps(lines, arguments.lang))


def _interfaces_for(report: GradeReport) -> Path | None:
    """Return the folder of the built-in assignment that brings the package whose import failed, if any."""
    error = report.runs[0].outcome.error
    missing_module = re.match(r"No module named '(\w+)", "" if error is None else error.message)
    if missing_module is None:
        return None
    from grader.catalog import default_root

    folders = (
        path.parent.parent for path in sorted(default_root().glob(f"*/{INTERFACES}/{missing_module[1]}"))
    )
    return next(folders, None)


def _plot(arguments: argparse.Namespace, report: GradeReport, trajectory: Trajectory) -> None:
    form = form_of(arguments.plot)
    from grader.render.plot import plot

    end = _end(report.runs[0].outcome, trajectory)
    shown_report = replace(report, summary=Text(zh=end, en=end))
    picture = plot(_sandpit(arguments), shown_report, trajectory, None, arguments.lang, form=form)
    write_file("--plot", arguments.plot, picture)
    sys.stdout.write(f"→ {arguments.plot}\n")


def _topic(text: str) -> str:
    if not re.fullmatch(TOPIC_PATTERN, text) or len(text) > _LONGEST_TOPIC:
        raise wrong_value(
            zh=f"{text!r} 不是话题名：用 /、字母、数字和 _，例如 /turtle1/cmd_vel",
            en=f"{text!r} is no name of a topic: / and letters, digits, _, such as /turtle1/cmd_vel",
        )
    return text


def _seconds(text: str) -> float:
    return _between(text, 600.0, zh="要写虚拟秒数", en="write virtual seconds")


def _factor(text: str) -> float:
    return _between(text, _MOST_SPEED, zh="要写倍数", en="write a factor")


def _between(text: str, most: float, *, zh: str, en: str) -> float:
    """Return a number above 0 and up to `most`."""
    try:
        value = decimal(text)
    except ValueError:
        value = math.nan
    if not 0.0 < value <= most:
        raise wrong_value(
            zh=f"{text!r} 不行：{zh}，大于 0，最大 {most:g}",
            en=f"{text!r} will not do: {en} above 0 and up to {most:g}",
        )
    return value
