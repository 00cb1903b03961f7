"""`grader regrade`: see the re-grades of a course, and undo one that was applied."""

import argparse
import sys

from grader.commands.options import add_language_option, tell
from grader.commands.storage import (
    OpenedStore,
    actor,
    add_course_option,
    add_data_option,
    chosen_course,
    opened,
)
from grader.contracts.errors import CourseError, RefusedError
from grader.messages import say
from grader.store.audit import Signature
from grader.store.clock import utc_now
from grader.store.regrades import Regrades


def configure(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments."""
    actions = parser.add_subparsers(dest="action", required=True, metavar="list | undo")
    listing = actions.add_parser("list", help="list the re-grades, newest first / 列出重新评分")
    undo = actions.add_parser("undo", help="let the earlier gradings count again / 撤销，以前的评分重新生效")
    undo.add_argument("id", help="of a re-grade that was applied / 重新评分的编号")
    undo.add_argument(
        "--reason",
        required=True,
        help="for the audit log and the students whose points change / 原因，写进操作记录，学生也会看到",
    )
    for action in (listing, undo):
        add_data_option(action)
        add_course_option(action)
        add_language_option(action)


def run(arguments: argparse.Namespace) -> int:
    """Carry out the action."""
    with opened(arguments) as storage:
        {"list": _list, "undo": _undo}[arguments.action](storage, arguments)
    return 0


def _list(storage: OpenedStore, arguments: argparse.Namespace) -> None:
    for regrade in Regrades(storage.database).all(chosen_course(storage, arguments.course)):
        cells = (
            regrade.id,
            regrade.wanted.assignment,
            regrade.state.value,
            regrade.created_at.isoformat(),
            regrade.reason,
        )
        sys.stdout.write("\t".join(cells).rstrip() + "\n")


def _undo(storage: OpenedStore, arguments: argparse.Namespace) -> None:
    signed = Signature(utc_now(), chosen_course(storage, arguments.course), actor())
    try:
        undone = Regrades(storage.database).undo(arguments.id, signed, arguments.reason)
    except RefusedError as error:
        raise CourseError.about(arguments.id, say(f"problem.{error.code}.title")) from None
    tell(
        arguments,
        zh=f"{undone.wanted.assignment}：已撤销，{undone.changed} 份提交恢复原来的分数",
        en=f"{undone.wanted.assignment}: undone; {undone.changed} submissions have their earlier points again",
    )
