"""`grader policy`: show and change the rules of assignments, and extend them for single students."""

import argparse
import json
import sys
from datetime import datetime
from typing import Any
from zoneinfo import ZoneInfo

from pydantic import ValidationError

from grader.catalog import Catalog
from grader.commands.storage import actor, add_course_option, add_data_option, chosen_course, opened
from grader.contracts.errors import CourseError
from grader.contracts.policy import NO_POLICY, Counts, Extension
from grader.routes.problems import ProblemError
from grader.routes.rule_views import PolicyBody, policy_from
from grader.store.audit import Signature
from grader.store.columns import utc_now
from grader.store.policies import Policies, to_document

_FIELDS = tuple(to_document(NO_POLICY))
_TEXTS = ("opens", "due", "hidden_until", "counts")


def configure(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments."""
    actions = parser.add_subparsers(dest="action", required=True, metavar="show | set | extend")
    show = actions.add_parser("show", help="print the rules of a course as JSON")
    change = actions.add_parser("set", help="change some of the rules of an assignment")
    change.add_argument("assignment")
    change.add_argument(
        "rules",
        nargs="+",
        metavar="RULE=VALUE",
        help=f"{', '.join(_FIELDS)}; e.g. due=2026-03-20T23:59:59 attempts=5 counts={Counts.LAST} "
        'late=\'{"kind": "linear", "per_day": 0.1}\'; none takes a rule back',
    )
    extend = actions.add_parser("extend", help="give one student more time or attempts")
    extend.add_argument("student")
    extend.add_argument("assignment")
    extend.add_argument(
        "--due", metavar="INSTANT", help="in the course's time zone, e.g. 2026-03-27T23:59:59"
    )
    extend.add_argument("--extra-attempts", type=int, default=0)
    for one in (change, extend):
        one.add_argument("--reason", default="", help="goes into the audit log")
    for one in (show, change, extend):
        add_course_option(one)
        add_data_option(one)


def run(arguments: argparse.Namespace) -> int:
    """Do it; rules that make no sense are raised as CourseError before anything is changed."""
    action = {"show": _show, "set": _set, "extend": _extend}[arguments.action]
    with opened(arguments) as storage:
        course = chosen_course(storage, arguments.course)
        action(Policies(storage.database), Signature(utc_now(), course, actor()), arguments)
    return 0


def _show(policies: Policies, signed: Signature, _: argparse.Namespace) -> None:
    rules = policies.rules(signed.course)
    document = {assignment: to_document(policy) for assignment, policy in sorted(rules.policies.items())}
    sys.stdout.write(json.dumps(document, ensure_ascii=False, indent=2) + "\n")


def _set(policies: Policies, signed: Signature, arguments: argparse.Namespace) -> None:
    items = {item.id for item in Catalog().get(arguments.assignment).items}
    rules = policies.rules(signed.course)
    document = to_document(rules.policy(arguments.assignment))
    for rule in arguments.rules:
        name, given, value = rule.partition("=")
        if name not in _FIELDS or not given:
            raise CourseError(f"{rule}: write RULE=VALUE with one of {', '.join(_FIELDS)}")
        document[name] = _value(name, value)
    try:
        policy = policy_from(PolicyBody.model_validate(document), rules.zone)
    except ValidationError as error:
        wrong = error.errors()[0]
        where = ".".join(str(part) for part in wrong["loc"])
        raise CourseError(f"{where}: {wrong['msg']}") from None
    except ProblemError as error:
        raise CourseError(f"these rules make no sense: {error.text}") from None
    if unknown := set(policy.hidden_items) - items:
        raise CourseError(
            f"{arguments.assignment} has no item {min(unknown)}; it has {', '.join(sorted(items))}"
        )
    policies.set(arguments.assignment, policy, signed, arguments.reason)


def _extend(policies: Policies, signed: Signature, arguments: argparse.Namespace) -> None:
    Catalog().get(arguments.assignment)
    zone = policies.rules(signed.course).zone
    due = None if arguments.due is None else _instant(arguments.due, zone)
    try:
        extension = Extension(due=due, extra_attempts=arguments.extra_attempts)
    except ValueError as error:
        raise CourseError(str(error)) from None
    policies.extend(arguments.assignment, arguments.student, extension, signed, arguments.reason)


def _value(name: str, text: str) -> Any:
    if text in ("none", "null", ""):
        return to_document(NO_POLICY)[name]
    if name in _TEXTS:
        return text
    if name == "hidden_items":
        return text.split(",")
    try:
        return json.loads(text)
    except ValueError:
        raise CourseError(f"{name}={text}: not a number or JSON") from None


def _instant(text: str, zone: ZoneInfo) -> datetime:
    try:
        instant = datetime.fromisoformat(text)
    except ValueError:
        raise CourseError(f"{text}: write an instant such as 2026-03-20T23:59:59") from None
    return instant if instant.tzinfo is not None else instant.replace(tzinfo=zone)
