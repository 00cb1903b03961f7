"""Options that several commands take, and how they say what was done."""

import argparse
import os
import sys
from pathlib import Path
from typing import Any

from grader.contracts.assignment import DISTROS, WAYS_TO_RUN
from grader.contracts.errors import SettingsError
from grader.contracts.notation import whole
from grader.contracts.text import LANGUAGES, Language, Text

ASSIGNMENT_HELP = "assignment id, else guessed from the file name / 作业 id，不写就从文件名猜"
JSON_HELP = "print the whole report as JSON / 以 JSON 输出完整报告"
_OTHER_LANGUAGE = "\0"


def add_language_option(parser: argparse.ArgumentParser) -> None:
    """Declare the language of the command's output.

    Raises SettingsError: `default_language` refuses what is set.
    """
    parser.add_argument(
        "--lang",
        choices=LANGUAGES,
        default=default_language(),
        help="language / 语言 (zh, or GRADER_DEFAULT_LANGUAGE)",
    )


def default_language() -> Language:
    """Return the language of a command that asks for none: that of a service's answers, by the same variable.

    Raises SettingsError: GRADER_DEFAULT_LANGUAGE names another one.
    """
    value = os.environ.get("GRADER_DEFAULT_LANGUAGE") or "zh"
    for language in LANGUAGES:
        if value == language:
            return language
    raise SettingsError(
        f"GRADER_DEFAULT_LANGUAGE must be zh or en, not {value!r}",
        f"GRADER_DEFAULT_LANGUAGE 只能是 zh 或 en，不能是 {value!r}",
    )


def add_grading_options(parser: argparse.ArgumentParser) -> None:
    """Declare what every command that grades on this machine takes."""
    parser.add_argument(
        "--assignments",
        type=Path,
        metavar="DIR",
        help="folder of assignments (default: built in) / 作业文件夹（默认：自带的）",
    )
    parser.add_argument(
        "--isolation",
        choices=("strict", "best-effort", "dev"),
        default="strict",
        help="how much of the sandbox must be active (strict); dev: only for your own code, unprotected / "
        "沙箱的严格程度（strict）；dev 不加保护，只用于自己的代码",
    )


def add_distro_option(parser: argparse.ArgumentParser, **options: Any) -> None:
    """Declare the release of ROS 2."""
    parser.add_argument("--distro", choices=DISTROS, **options)


def add_way_option(parser: argparse.ArgumentParser) -> None:
    """Declare how a script is started."""
    parser.add_argument(
        "--runs-as",
        choices=WAYS_TO_RUN,
        help="how scripts are started: python3 FILE (python), or by calling main() as ros2 run does / "
        "脚本怎样启动：python3 文件，或像 ros2 run 那样调用 main()",
    )


def tell(arguments: argparse.Namespace, *, zh: str, en: str) -> None:
    """Say on standard error what was done, in the language of `add_language_option`."""
    sys.stderr.write(Text(zh=zh, en=en).get(arguments.lang) + "\n")


def wrong_value(*, zh: str, en: str) -> argparse.ArgumentTypeError:
    """Return what the type of an option raises at a value it cannot take."""
    return argparse.ArgumentTypeError(f"{zh}{_OTHER_LANGUAGE}{en}")


def whole_number(text: str) -> int:
    """Return the whole number that an argument is; the type of options."""
    try:
        return whole(text)
    except ValueError:
        raise wrong_value(
            zh=f"{text!r} 不行：要写整数", en=f"{text!r} will not do: write a whole number"
        ) from None


def told_value(message: str) -> Text | None:
    """Return what `wrong_value` was given, None when `message` is argparse's own."""
    zh, separator, en = message.partition(_OTHER_LANGUAGE)
    return Text(zh=zh, en=en) if separator else None
