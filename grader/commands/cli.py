"""The command line: which commands there are, and what their failures look like.

A command is a module in `grader.commands` with `configure(parser)` and `run(arguments) -> int`. Only the chosen
one is imported, so that `grader check` does not pay for the web framework. Exit codes: 0 for full marks, or a
command that did its work; 1 for a lower score, or something found wrong; 2 when the command could not be done.
"""

import argparse
import importlib
import os
import re
import sys
from collections.abc import Sequence
from typing import NoReturn

from grader import __version__
from grader.contracts.errors import GraderError

COMMANDS: dict[str, str] = {
    "check": "grade one file here, as the service would / 本地预检",
    "run": "run a script against the simulated turtle, without grading / 只运行不评分",
    "assignments": "list, show and validate assignments / 查看作业与评分标准",
    "serve": "start the HTTP service with its workers / 启动服务",
    "worker": "grade for services that share a database, without serving / 启动评分进程",
    "submit": "hand a file in to a service and wait for its grading / 提交到服务器",
    "course": "create a course and import its people / 创建课程、导入名单",
    "token": "issue and revoke the tokens people identify with / 发放和撤销令牌",
    "rules": "dates, limits and late rules of assignments / 截止时间、次数与迟交规则",
    "db": "back the service's database up, restore, move it / 数据库的备份、恢复与迁移",
    "doctor": "try every layer of the sandbox and say what is active / 检查沙箱",
    "demo": "grade a small class over HTTP and show the dashboard / 演示",
}

EXIT_NOT_DONE = 2
EXIT_INTERRUPTED = 130  # as a shell reports SIGINT
EXIT_BROKEN_PIPE = 141  # as a shell reports SIGPIPE


_IN_CHINESE = (  # a message of argparse, as a pattern, and its Chinese wording
    (r"the following arguments are required: (.*)", r"缺少参数：\1"),
    (r"one of the arguments (.*) is required", r"要写其中一个：\1"),
    (r"unrecognized arguments: (.*)", r"没有这样的参数：\1"),
    (r"argument (.*): expected one argument", r"\1 后面缺少一个值"),
    (r"argument (.*): invalid choice: (.*) \(choose from (.*)\)", r"\1 不能是 \2，可选：\3"),
    (r"argument (.*): invalid \w+ value: (.*)", r"\1 的值不对：\2"),
)


class Parser(argparse.ArgumentParser):
    """A parser whose errors are in both languages: it fails before it has read which one is wanted."""

    def error(self, message: str) -> NoReturn:
        """Print what is wrong and how to get help, and exit."""
        chinese = "".join(
            re.sub(en, zh, message) for en, zh in _IN_CHINESE if re.fullmatch(en, message, re.DOTALL)
        )
        self.print_usage(sys.stderr)
        lines = [chinese, message, f"→ {self.prog} --help"]
        self.exit(EXIT_NOT_DONE, "".join(f"{self.prog}: {line}\n" for line in lines if line))


def _parse(parser: Parser, argv: list[str], passes_on: str) -> argparse.Namespace:
    """Parse a command's arguments; with `passes_on` only those before the first ``--``, the rest is kept there.

    Left to argparse, options could not stand between a command's file and ``--``, and every ``--`` would be lost.
    """
    cut = argv.index("--") if passes_on and "--" in argv else len(argv)
    arguments = parser.parse_args(argv[:cut])
    if passes_on:
        setattr(arguments, passes_on, [*getattr(arguments, passes_on), *argv[cut + 1 :]])
    return arguments


def run(argv: Sequence[str]) -> int:
    """Run one command and return the process's exit code. Bad input is told in one line, without a traceback."""
    parser = Parser(
        prog="grader",
        description="Auto-grader for introductory ROS 2 (rclpy) motion exercises / ROS 2 运动练习自动评分",
        formatter_class=argparse.RawDescriptionHelpFormatter,
        epilog="\n".join(f"  {name:<12} {text}" for name, text in COMMANDS.items()),
    )
    parser.add_argument("--version", action="version", version=f"grader {__version__}")
    parser.add_argument("command", choices=list(COMMANDS), metavar="command", help="one of these / 以下之一")
    parser.add_argument("arguments", nargs=argparse.REMAINDER, help=argparse.SUPPRESS)
    if not argv:
        parser.print_help(sys.stderr)
        return EXIT_NOT_DONE
    chosen = parser.parse_args(argv)
    module = importlib.import_module(f"grader.commands.{chosen.command}")
    command_parser = Parser(prog=f"grader {chosen.command}", description=COMMANDS[chosen.command])
    module.configure(command_parser)
    arguments = _parse(command_parser, chosen.arguments, getattr(module, "PASSES_ON", ""))
    try:
        code = int(module.run(arguments))
        sys.stdout.flush()
        return code
    except GraderError as error:
        from grader.render.escape import visible

        sys.stderr.write(f"grader: {visible(error.told(getattr(arguments, 'lang', 'zh')))}\n")
        return EXIT_NOT_DONE
    except KeyboardInterrupt:
        return EXIT_INTERRUPTED
    except (
        BrokenPipeError
    ):  # the reader has closed the pipe, as `head` does; Python would fail again when it flushes
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return EXIT_BROKEN_PIPE
