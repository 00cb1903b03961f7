"""`grader hints`: print the codes of all mistakes and changes that a report or an explanation may name."""

import argparse
import sys

from grader.commands.options import add_language_option

EPILOG = "`mistake:` in an assignment's wrong scripts takes these codes / 作业里的 `mistake:` 用这些代码"


def configure(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments."""
    parser.add_argument(
        "part", nargs="?", default="", help="only codes and sentences with this text / 只列出含有这段文字的"
    )
    add_language_option(parser)


def run(arguments: argparse.Namespace) -> int:
    """Print one line for each code: the code, then its sentence with its fields in braces."""
    from grader.messages import entries

    for name, sentence in sorted(entries(arguments.lang, "grader").items()):
        kind, _, code = name.partition(".")
        if kind in ("mistake", "change") and arguments.part in f"{code} {sentence}":
            sys.stdout.write(f"{code}: {sentence}\n")
    return 0
