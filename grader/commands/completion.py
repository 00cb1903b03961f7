"""`grader completion SHELL`: print what makes a shell complete the commands, their options and assignment ids."""

import argparse
import sys
from collections.abc import Iterator
from pathlib import Path

SHELLS = ("bash", "zsh")


def configure(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments."""
    parser.add_argument("shell", choices=SHELLS, help="the shell to complete in / 在哪个 shell 里补全")


def run(arguments: argparse.Namespace) -> int:
    """Print the script."""
    import shtab

    sys.stdout.write(shtab.complete(whole_command_line(), shell=arguments.shell) + "\n")
    return 0


def whole_command_line() -> argparse.ArgumentParser:
    """Return one parser with all commands, whose arguments know what may stand there."""
    from grader.commands.cli import COMMANDS, module_of

    parser = argparse.ArgumentParser(prog="grader", description="ROS 2")
    commands = parser.add_subparsers(dest="command")
    for name, text in COMMANDS.items():
        command = commands.add_parser(name, help=text)
        module_of(name).configure(command)
        for action in _actions(command):
            _set_completer(action)
    return parser


def _actions(parser: argparse.ArgumentParser) -> Iterator[argparse.Action]:
    """Yield the arguments of a parser and of those below it."""
    for action in parser._actions:  # argparse has no public way to them
        yield action
        if isinstance(action, argparse._SubParsersAction):
            for below in action.choices.values():
                yield from _actions(below)


def _set_completer(action: argparse.Action) -> None:
    """Set how shtab completes an argument that is a file, a folder or an assignment."""
    import shtab

    if action.type is Path:
        action.complete = shtab.DIRECTORY if action.metavar == "DIR" else shtab.FILE  # type: ignore[attr-defined]
    elif action.dest == "assignment" and action.choices is None:
        from grader.catalog import Catalog

        action.choices = [assignment.id for assignment in Catalog().all()]
