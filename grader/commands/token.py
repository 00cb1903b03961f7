"""`grader token`: issue, revoke and list the bearer tokens of a course's people."""

import argparse
import csv
import sys
from collections.abc import Iterable
from datetime import timedelta
from io import TextIOWrapper

from grader.commands.options import add_language_option, tell, wrong_value
from grader.commands.storage import (
    OpenedStore,
    actor,
    add_course_option,
    add_data_option,
    chosen_course,
    opened,
)
from grader.contracts.errors import CourseError
from grader.contracts.identity import sections_of, unknown_members
from grader.contracts.notation import whole
from grader.contracts.text import BYTE_ORDER_MARK, Text
from grader.formats.sheets.writing import as_text
from grader.use_cases.people import TOKEN_COLUMNS, token_cells

DEFAULT_DAYS = 200  # a term and the exams after it
_MOST_DAYS = 3_660


def configure(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments."""
    actions = parser.add_subparsers(dest="action", required=True, metavar="issue | revoke | list")
    issue = actions.add_parser("issue", help="print a new token, this once / 发放新令牌，只显示这一次")
    who = issue.add_mutually_exclusive_group(required=True)
    who.add_argument("person", nargs="*", default=[], help="ids of members / 成员的 id")
    who.add_argument(
        "--missing", action="store_true", help="everybody without a valid one / 所有没有有效令牌的人"
    )
    who.add_argument("--section", help="everybody in a section / 一个班的所有人")
    add_days_option(issue)
    revoke = actions.add_parser("revoke", help="make tokens open nothing, from now on / 撤销令牌")
    which = revoke.add_mutually_exclusive_group(required=True)
    which.add_argument(
        "person", nargs="?", help="id of a member: all of their tokens / 成员的 id：他的全部令牌"
    )
    which.add_argument(
        "--token", metavar="ID", help="one token, by the id that `list` shows / list 显示的令牌 id"
    )
    listing = actions.add_parser(
        "list", help="list tokens, without what makes them work / 列出令牌（不显示内容）"
    )
    for action in (issue, revoke, listing):
        add_course_option(action)
        add_data_option(action)
        add_language_option(action)


def add_days_option(parser: argparse.ArgumentParser) -> None:
    """Declare how long new tokens live."""
    parser.add_argument(
        "--days",
        type=_days,
        default=DEFAULT_DAYS,
        help=f"how long the tokens work / 有效天数 ({DEFAULT_DAYS})",
    )


def run(arguments: argparse.Namespace) -> int:
    """Do it; 2, as a CourseError, when there is no such member or token."""
    action = {"issue": _issue, "revoke": _revoke, "list": _list}[arguments.action]
    with opened(arguments) as storage:
        action(storage, chosen_course(storage, arguments.course), arguments)
    return 0


def write_tokens(storage: OpenedStore, course: str, people: Iterable[str], days: int) -> None:
    """Issue a token for each of `people` and print them as CSV, as the page of people does.

    Into a file as the gradebook is: UTF-8 with a byte order mark, without which Excel takes Chinese names for GBK.

    Raises CourseError: one of them is no member; no token was made then.
    """
    members = {member.id: member for member in storage.courses.members(course)}
    ids = list(dict.fromkeys(people))
    unknown = [person for person in ids if person not in members]
    if unknown:
        raise unknown_members(course, *unknown)
    if not sys.stdout.isatty():
        if isinstance(sys.stdout, TextIOWrapper):
            sys.stdout.reconfigure(encoding="utf-8")
        sys.stdout.write(BYTE_ORDER_MARK)
    table = csv.writer(sys.stdout, lineterminator="\n")
    table.writerow(TOKEN_COLUMNS)
    tokens = storage.tokens.issue_all(course, ids, timedelta(days=days), actor())
    for person, (_, secret) in zip(ids, tokens, strict=True):
        table.writerow(map(as_text, token_cells(members[person], secret)))


def _issue(storage: OpenedStore, course: str, arguments: argparse.Namespace) -> None:
    people = arguments.person
    if arguments.missing:
        people = _without_token(storage, course)
    elif arguments.section is not None:
        people = _in_section(storage, course, arguments.section)
    write_tokens(storage, course, people, arguments.days)


def _without_token(storage: OpenedStore, course: str) -> list[str]:
    served = storage.tokens.holders(course)
    return [member.id for member in storage.courses.members(course) if member.id not in served]


def _in_section(storage: OpenedStore, course: str, section: str) -> list[str]:
    members = storage.courses.members(course)
    if section not in (known := sections_of(members)):
        listed = ", ".join(known)
        raise CourseError(
            f"no section {section!r}; there are: {listed}", f"没有班级 {section!r}；有：{listed}"
        )
    return [member.id for member in members if section in member.sections]


def _revoke(storage: OpenedStore, course: str, arguments: argparse.Namespace) -> None:
    count = storage.tokens.revoke(course, actor(), token_id=arguments.token, person=arguments.person)
    if not count:
        raise CourseError("no such token that still opens anything", "没有这样的有效令牌")
    tell(arguments, zh=f"已撤销 {count} 个令牌", en=f"{count} revoked")


def _list(storage: OpenedStore, course: str, arguments: argparse.Namespace) -> None:
    for token in storage.tokens.of_course(course):
        ended, end = token.revoked_at is not None, token.revoked_at or token.expires_at
        what = Text(zh="已撤销", en="revoked") if ended else Text(zh="有效到", en="until")
        sys.stdout.write(f"{token.id}\t{token.person}\t{what.get(arguments.lang)} {end:%Y-%m-%d}\n")


def _days(text: str) -> int:
    try:
        days = whole(text)
    except ValueError:
        days = 0
    if not 1 <= days <= _MOST_DAYS:
        raise wrong_value(
            zh=f"{text!r} 不行：天数从 1 到 {_MOST_DAYS}", en=f"{text!r} will not do: 1 to {_MOST_DAYS} days"
        )
    return days
