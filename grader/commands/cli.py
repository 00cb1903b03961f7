"""The command line: which commands there are, and what their failures look like.

A command is a module in `grader.commands` with `configure(parser)` and `run(arguments) -> int`; an `EPILOG` ends
its help. Only the chosen one is imported, so that `grader check` does not pay for the web framework. Exit codes: 0
for full marks, or a command that did its work; 1 for a lower score, or something found wrong; 2 when the command
could not be done.
"""

import argparse
import errno
import importlib
import io
import os
import re
import sys
from collections.abc import Sequence
from types import ModuleType
from typing import NoReturn

from grader import __version__
from grader.commands.options import default_language, told_value
from grader.contracts.errors import GraderError
from grader.contracts.text import Language, Text, trouble

_GROUPS: dict[str, dict[str, str]] = {
    "students / 学生": {
        "check": "grade one file here, as the service would / 本地预检",
        "run": "run a script against the simulated turtle, without grading / 只运行不评分",
        "live": "drive a turtle in real time by rosbridge, without a course / 通过 rosbridge 实时驾驶小乌龟",
        "submit": "hand a file in to a service and wait for its grading / 提交到服务器",
    },
    "teachers / 教师": {
        "hints": "the codes of mistakes and changes, with their sentences / 错误与改法的代码和文字",
        "assignments": "list, show and validate assignments / 查看作业与评分标准",
        "course": "create a course and import its people / 创建课程、导入名单",
        "token": "issue and revoke the tokens people identify with / 发放和撤销令牌",
        "rules": "dates, limits and late rules of assignments / 截止时间、次数与迟交规则",
        "receipt": "say whether a receipt is genuine / 检查回执是真是假",
        "regrade": "list re-grades, and undo one that was applied / 重新评分：查看、撤销",
        "regrade-folder": "grade a downloaded class without a service / 离线评一整班的提交",
        "lti": "learning platforms (LTI 1.3) of a course / 课程的学习平台",
        "gradescope": "pack an assignment as an autograder for Gradescope / 打包成 Gradescope 自动评分器",
        "prairielearn": "grade as an external grader of PrairieLearn / 作为 PrairieLearn 外部评分器",
    },
    "operators / 运维": {
        "serve": "start the HTTP service with its workers / 启动服务",
        "worker": "grade for services that share a database, without serving / 启动评分进程",
        "db": "back the service's database up, restore, move it / 数据库的备份、恢复与迁移",
        "doctor": "try every layer of the sandbox and say what is active / 检查沙箱",
        "demo": "grade a small class over HTTP and show the dashboard / 演示",
        "completion": "print the completion script of a shell / 输出 shell 自动补全脚本",
    },
}
COMMANDS: dict[str, str] = {name: text for group in _GROUPS.values() for name, text in group.items()}

EXIT_NOT_DONE = 2
_UNWRITTEN = (errno.EPIPE, errno.ENOSPC, errno.EDQUOT, errno.EIO, errno.EBADF)
EXIT_INTERRUPTED = 130  # as a shell reports SIGINT
EXIT_BROKEN_PIPE = 141  # as a shell reports SIGPIPE


_IN_CHINESE = (  # a message of argparse, as a pattern, and its Chinese wording
    (r"the following arguments are required: (.*)", r"缺少参数：\1"),
    (r"one of the arguments (.*) is required", r"要写其中一个：\1"),
    (r"unrecognized arguments: (.*)", r"没有这样的参数：\1"),
    (r"argument (.*): expected at most one argument", r"\1 后面最多写一个值"),
    (r"argument (.*): expected at least one argument", r"\1 后面至少写一个值"),
    (r"argument (.*): expected one argument", r"\1 后面缺少一个值"),
    (r"argument (.*): expected (\d+) arguments?", r"\1 后面要写 \2 个值"),
    (r"argument (.*): invalid choice: (.*) \(choose from (.*)\)", r"\1 不能是 \2，可选：\3"),
    (r"argument (.*): invalid \w+ value: (.*)", r"\1 的值不对：\2"),
    (r"argument (.*): not allowed with argument (.*)", r"\1 和 \2 不能一起写"),
    (r"argument (.*): ignored explicit argument (.*)", r"\1 后面不写值，多了 \2"),
    (r"ambiguous option: (.*) could match (.*)", r"\1 写得不完整，可能是：\2"),
)
_OF_A_VALUE = re.compile(r"argument (.*?): (.*)", re.DOTALL)
_LANGUAGE = re.compile(r"--lang(?:=|\0)(zh|en)")
_LEAST_LIKENESS = 0.6


class Parser(argparse.ArgumentParser):
    """A parser whose errors are one message, in the language that the command line asks for; else in Chinese."""

    language: Language = "zh"

    def error(self, message: str) -> NoReturn:
        """Print what is wrong and how to get help, and exit."""
        from grader.render.escape import visible

        told = _in_chinese(message) if self.language == "zh" else _in_english(message)
        line = visible(f"{self.prog}: {told}{_meant(message, self.language)}")
        self.exit(EXIT_NOT_DONE, f"{line}\n→ {self.prog} --help\n")


def _in_chinese(message: str) -> str:
    value = _OF_A_VALUE.fullmatch(message)
    if value is not None and (told := told_value(value[2])) is not None:
        return f"{value[1]}：{told.zh}"
    for english, chinese in _IN_CHINESE:
        if (found := re.fullmatch(english, message, re.DOTALL)) is not None:
            return found.expand(chinese)
    return f"命令写得不对（{message}）"


def _in_english(message: str) -> str:
    value = _OF_A_VALUE.fullmatch(message)
    told = None if value is None else told_value(value[2])
    return message if value is None or told is None else f"{value[1]}: {told.en}"


def _meant(message: str, language: Language) -> str:
    """Return the choice that a wrong one is like, as a question."""
    invalid_choice = re.fullmatch(r".*: invalid choice: '(.*)' \(choose from (.*)\)", message, re.DOTALL)
    if invalid_choice is None:
        return ""
    import difflib

    choices = [choice.strip("' ") for choice in invalid_choice[2].split(",")]
    likely = difflib.get_close_matches(invalid_choice[1], choices, 1, _LEAST_LIKENESS)
    question = Text(zh="（是不是 {}？）", en=" (did you mean {}?)").get(language)
    return question.format(likely[0]) if likely else ""


def _language(argv: Sequence[str]) -> Language:
    """Return the language that the arguments ask for, before they are parsed."""
    own = argv[: argv.index("--")] if "--" in argv else argv
    languages = _LANGUAGE.findall("\0".join(own))
    return languages[-1] if languages else default_language()


def _parse(parser: Parser, argv: list[str], passes_on: str) -> argparse.Namespace:
    """Parse a command's arguments; with `passes_on` only those before the first ``--``, the rest is kept there.

    Left to argparse, options could not stand between a command's file and ``--``, and every ``--`` would be lost.
    """
    cut = argv.index("--") if passes_on and "--" in argv else len(argv)
    arguments = parser.parse_args(argv[:cut])
    if passes_on:
        setattr(arguments, passes_on, [*getattr(arguments, passes_on), *argv[cut + 1 :]])
    return arguments


def module_of(command: str) -> ModuleType:
    """Import the module of a command."""
    return importlib.import_module(f"grader.commands.{command.replace('-', '_')}")


def _prepared(command: str, argv: list[str]) -> tuple[ModuleType, argparse.Namespace]:
    """Import the command and parse its arguments."""
    module = module_of(command)
    parser = Parser(
        prog=f"grader {command}", description=COMMANDS[command], epilog=getattr(module, "EPILOG", None)
    )
    module.configure(parser)
    return module, _parse(parser, argv, getattr(module, "PASSES_ON", ""))


def run(argv: Sequence[str]) -> int:
    """Run one command and return the process's exit code. Bad input is reported in one line, with no traceback."""
    if sys.stdout is None:  # closed by the shell: `>&-`
        sys.stdout = open(os.devnull, "w", encoding="utf-8")  # noqa: SIM115 - open until the process ends
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="replace")  # the encoding of a terminal may lack a sign, as GBK does ✓
    try:
        Parser.language = _language(argv)
    except GraderError as error:
        return _told(error)
    parser = _parser()
    if not argv:
        parser.print_help(sys.stderr)
        return EXIT_NOT_DONE
    try:
        chosen = parser.parse_args(argv)
        module, arguments = _prepared(chosen.command, chosen.arguments)
        code = int(module.run(arguments))
        sys.stdout.flush()
        return code
    except GraderError as error:
        return _told(error)
    except ModuleNotFoundError as error:
        return _lacks(error)
    except KeyboardInterrupt:
        return EXIT_INTERRUPTED
    except OSError as error:
        return _not_done(error)


def _parser() -> Parser:
    """Return the parser of what stands before a command's own arguments."""
    parser = Parser(
        prog="grader",
        description="Auto-grader for introductory ROS 2 (rclpy) motion exercises / ROS 2 运动练习自动评分",
        formatter_class=argparse.RawDescriptionHelpFormatter,
        epilog=_overview(),
    )
    parser.add_argument("--version", action="version", version=f"grader {__version__}")
    parser.add_argument(
        "command",
        choices=list(COMMANDS),
        metavar="command",
        help="one of those below; its options: grader COMMAND --help / 以下之一",
    )
    parser.add_argument("arguments", nargs=argparse.REMAINDER, help=argparse.SUPPRESS)
    return parser


def _told(error: GraderError) -> int:
    from grader.render.escape import visible

    sys.stderr.write(f"grader: {visible(error.message_in(Parser.language))}\n")
    return EXIT_NOT_DONE


def _lacks(error: ModuleNotFoundError) -> int:
    """Say which extra to install; return the exit code.

    Raises ModuleNotFoundError: no extra has the module.
    """
    from grader.contracts.extras import MissingExtraError

    if (missing := MissingExtraError.of(error)) is None:
        raise error
    return _told(missing)


def _overview() -> str:
    """Return the commands by who mostly uses them, and an example."""
    groups = (
        "\n".join([f"{title}:", *(f"  {name:<14} {text}" for name, text in commands.items())])
        for title, commands in _GROUPS.items()
    )
    return "\n\n".join([*groups, "example / 例：grader check square_mover.py -a square --lang en"])


def _not_done(error: OSError) -> int:
    """Say which file a command could not use, or that its output cannot be written; return the exit code.

    Raises OSError: the error is about something else.
    """
    told = trouble(error)
    if error.filename is None:
        if error.errno not in _UNWRITTEN:
            raise error
        # Python would fail again when it flushes.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        if isinstance(error, BrokenPipeError):  # the reader has closed the pipe, as `head` does
            return EXIT_BROKEN_PIPE
        told = Text(zh=f"写不出结果：{told.zh}", en=f"the output cannot be written: {told.en}")
    else:
        told = told.about(error.filename)
    sys.stderr.write(f"grader: {told.get(Parser.language)}\n")
    return EXIT_NOT_DONE
