"""`grader rules`: show and change the rules of assignments, and extend them for single students.

Only what is named changes; the rest stays as it is. What is replaced is shown, before and after.
"""

import argparse
import difflib
import json
import sys
from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Any
from zoneinfo import ZoneInfo

from pydantic import ValidationError

from grader.commands.options import add_language_option, tell, whole_number
from grader.commands.storage import actor, add_course_option, add_data_option, chosen_course, opened
from grader.contracts import fields
from grader.contracts.assignment import Assignment
from grader.contracts.errors import CourseError
from grader.contracts.fields import kinds_of
from grader.contracts.grading import AssignmentSource
from grader.contracts.identity import Seen, sections_of, unknown_members
from grader.contracts.rules import NO_EXTENSION, NO_RULES, Counts, Extension, Rules
from grader.contracts.text import Text
from grader.contracts.validation_words import said
from grader.render.audit_lines import Teller
from grader.store.audit import Signature
from grader.store.clock import utc_now
from grader.store.database import Database
from grader.store.rules import CourseRules, StoredRules, tag, to_document
from grader.use_cases.bodies import ExtensionBody, RulesBody, rules_from

_KINDS = kinds_of(Rules)
_EXAMPLES = {
    "late": """'late={"kind":"linear","per_day":0.1}'""",
    "by_section": """'by_section=[{"section":"A","due":"2026-03-22T23:59:59"}]'""",
}
"""Of rules that are written as JSON, as a shell takes them."""

_NONE = ("none", "null", "")
_ALL = "all"
_NOTHING = to_document(NO_RULES)
_FEW = 5


def configure(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments."""
    actions = parser.add_subparsers(dest="action", required=True, metavar="show | set | extend")
    show = actions.add_parser("show", help="print rules and extensions / 打印规则和延期")
    show.add_argument("--json", action="store_true", help="every field, as JSON / 以 JSON 打印全部字段")
    change = actions.add_parser(
        "set", help="change some rules of assignments; the others stay / 修改规则，没写的不变"
    )
    change.add_argument(
        "assignment", help=f"or several, as in square,triangle, or {_ALL} / 可以写几个，用逗号隔开"
    )
    change.add_argument(
        "rules",
        nargs="+",
        metavar="RULE=VALUE",
        help=f"{', '.join(_KINDS)}; e.g. due=2026-03-20T23:59:59 attempts=5 counts={Counts.LAST} "
        'late=\'{"kind": "linear", "per_day": 0.1}\'; none takes a rule back / none 取消一条规则',
    )
    extend = actions.add_parser("extend", help="give students more time or attempts / 给学生延期或增加次数")
    extend.add_argument("student", help="or several, as in 20260123,20260124 / 可以写几个，用逗号隔开")
    extend.add_argument("assignment")
    extend.add_argument(
        "--due",
        metavar="INSTANT",
        help="in the course's time zone, e.g. 2026-03-27T23:59:59; none takes it back / 课程时区的时间，none 取消",
    )
    extend.add_argument(
        "--extra-attempts", type=whole_number, metavar="N", help="0 takes them back / 0 表示取消"
    )
    for action in (change, extend):
        action.add_argument("--reason", default="", help="goes into the audit log / 写进操作记录")
        action.add_argument(
            "--dry-run", action="store_true", help="change nothing, show what would / 只显示会改什么"
        )
    for action in (show, change, extend):
        add_course_option(action)
        add_data_option(action)
        add_language_option(action)


def run(arguments: argparse.Namespace) -> int:
    """Do it; rules that make no sense are raised as CourseError before anything is changed."""
    with opened(arguments) as storage:
        course = chosen_course(storage, arguments.course)
        members = {member.id: member for member in storage.courses.members(course)}
        students = _names(arguments.student) if arguments.action == "extend" else []
        if unknown := [one for one in students if one not in members]:
            raise unknown_members(course, *unknown)
        stored, signed = StoredRules(storage.database), Signature(utc_now(), course, actor())
        if arguments.action == "show":
            _show(stored.of(course), arguments)
            return 0
        assignments = _assignments(storage.database, course)
        if arguments.action == "set":
            names = _names(arguments.assignment)
            wanted = assignments.all() if names == [_ALL] else [assignments.get(name) for name in names]
            _set(stored, signed, wanted, arguments, sections_of(members.values()))
        else:
            assignments.get(arguments.assignment)
            for student in students:
                _extend(stored, signed, student, arguments)
    return 0


def _names(text: str) -> list[str]:
    return list(dict.fromkeys(part.strip() for part in text.split(",")))


def _assignments(database: Database, course: str) -> AssignmentSource:
    """Return the assignments that the grader brings, the operator adds, or the course has made."""
    from grader.operation.settings import load
    from grader.service.composition import assignments_of

    return assignments_of(load(), database, utc_now).of(course)


def _show(known: CourseRules, arguments: argparse.Namespace) -> None:
    """Print what somebody set, in words; or all of it as JSON."""
    if arguments.json:
        _show_json(known)
        return
    teller = Teller(arguments.lang, known.zone)
    lines = []
    for assignment in sorted({*known.by_assignment, *(of for of, _ in known.extensions)}):
        rules = to_document(known.by_assignment.get(assignment, NO_RULES))
        told = [
            f"{name}: {teller.value(name, rules[name])}" for name in rules if rules[name] != _NOTHING[name]
        ]
        lines.append(f"{assignment}\t{'; '.join(told) or '—'}")
        for student, extension in known.extended(assignment):
            more = to_document(extension)
            told = [f"{name}: {teller.value(name, value)}" for name, value in more.items() if value]
            lines.append(f"  {student}\t{'; '.join(told)}")
    sys.stdout.write("".join(f"{line}\n" for line in lines))


def _show_json(known: CourseRules) -> None:
    document = {assignment: to_document(rules) for assignment, rules in sorted(known.by_assignment.items())}
    for (assignment, student), extension in sorted(known.extensions.items(), key=lambda item: item[0]):
        if extension != NO_EXTENSION:
            shown = document.setdefault(assignment, to_document(NO_RULES))
            shown.setdefault("extensions", {})[student] = to_document(_local(extension, known.zone))
    sys.stdout.write(json.dumps(document, ensure_ascii=False, indent=2) + "\n")


def _local(extension: Extension, zone: ZoneInfo) -> Extension:
    return extension if extension.due is None else replace(extension, due=extension.due.astimezone(zone))


def _set(
    stored: StoredRules,
    signed: Signature,
    assignments: Iterable[Assignment],
    arguments: argparse.Namespace,
    sections: Sequence[str],
) -> None:
    known = stored.of(signed.course)
    wanted = {assignment.id: _wanted(assignment, known, arguments.rules) for assignment in assignments}
    changes: dict[tuple[str, ...], list[str]] = {}
    for name, rules in wanted.items():
        before = known.of(name)
        if not arguments.dry_run:
            stored.set(name, rules, signed, arguments.reason, seen=Seen.one(tag(before)))
        changes.setdefault(_change(before, rules, known.zone, arguments), []).append(name)
    for change, names in changes.items():
        _print_change(_listed(names, arguments), change)
    empty = {rule.section for rules in wanted.values() for rule in rules.by_section} - set(sections)
    if empty and any(rule.startswith("by_section=") for rule in arguments.rules):
        listed = ", ".join(sorted(empty))
        tell(arguments, zh=f"注意：班里没有人在 {listed}", en=f"note: nobody is in the section {listed}")


def _wanted(assignment: Assignment, known: CourseRules, given: list[str]) -> Rules:
    """Return the rules of an assignment with those that were given in their places."""
    items = [item.id for item in assignment.items]
    rules = _read(_changed(known.of(assignment.id), given), known.zone)
    if unknown := set(rules.hidden_items) - set(items):
        name, all_items = min(unknown), ", ".join(items)
        raise CourseError(
            f"{assignment.id} has no item {name}; it has {all_items}",
            f"{assignment.id} 没有评分项 {name}；它有 {all_items}",
        )
    return rules


def _changed(before: Rules, given: list[str]) -> dict[str, Any]:
    """Return the rules `before` as a document, with those that were given in their places."""
    document = to_document(before)
    names = [rule.partition("=")[0] for rule in given]
    if twice := next((name for name in names if names.count(name) > 1), None):
        raise CourseError(f"{twice} is given twice", f"{twice} 写了两次")
    for rule in given:
        name, equals, value = rule.partition("=")
        if name not in _KINDS or not equals:
            raise _no_rule(rule, name)
        document[name] = _value(name, value)
    return document


def _no_rule(rule: str, name: str) -> CourseError:
    kinds, likely = ", ".join(_KINDS), difflib.get_close_matches(name, _KINDS, 1)
    if likely and likely != [name]:
        return CourseError(
            f"no rule {name!r}; do you mean {likely[0]}?", f"没有规则 {name!r}；是不是 {likely[0]}？"
        )
    return CourseError(
        f"{rule}: write RULE=VALUE with one of {kinds}", f"{rule}：写成 规则=值，规则有 {kinds}"
    )


def _value(name: str, text: str) -> Any:
    if text in _NONE:
        return to_document(NO_RULES)[name]
    kind = _KINDS[name]
    if isinstance(kind, fields.Instant | fields.Choice):
        return text
    if isinstance(kind, fields.Names) and not text.startswith("["):
        return [part.strip() for part in text.split(",")]
    try:
        return json.loads(text)
    except ValueError:
        example = _EXAMPLES.get(name, f"{name}=3")
        raise CourseError(
            f"{name}={text}: not a number or JSON; write for example {example}",
            f"{name}={text}：不是数字或 JSON；例如 {example}",
        ) from None


def _read(document: dict[str, Any], zone: ZoneInfo) -> Rules:
    try:
        return rules_from(RulesBody.model_validate(document), zone)
    except ValidationError as error:
        raise _refusal(error) from None


def _extend(stored: StoredRules, signed: Signature, student: str, arguments: argparse.Namespace) -> None:
    rules = stored.of(signed.course)
    before = rules.extension(arguments.assignment, student)
    extension = _extended(before, rules.zone, arguments)
    if not arguments.dry_run:
        stored.extend(
            arguments.assignment, student, extension, signed, arguments.reason, seen=Seen.one(tag(before))
        )
    change = _change(before, extension, rules.zone, arguments)
    _print_change(f"{arguments.assignment}, {student}", change)
    _warn_of_no_effect(extension, rules, student, arguments)


def _extended(before: Extension, zone: ZoneInfo, arguments: argparse.Namespace) -> Extension:
    """Return what the student has `before`, with what was given in its place."""
    if arguments.due is None and arguments.extra_attempts is None:
        raise CourseError("say --due or --extra-attempts", "请给出 --due 或 --extra-attempts")
    values: dict[str, Any] = {}
    if arguments.due is not None:
        values["due"] = None if arguments.due in _NONE else arguments.due
    if arguments.extra_attempts is not None:
        values["extra_attempts"] = arguments.extra_attempts
    try:
        read = ExtensionBody.model_validate(values).meant(zone)
    except ValidationError as error:
        raise _refusal(error) from None
    return replace(before, **{name: getattr(read, name) for name in values})


def _warn_of_no_effect(
    extension: Extension, known: CourseRules, student: str, arguments: argparse.Namespace
) -> None:
    rules = known.of(arguments.assignment, student)
    if extension.due is None or rules.due_for(extension) == extension.due:
        return
    if rules.due is None:
        tell(
            arguments,
            zh="注意：这道题没有截止时间，没有作用",
            en="note: the assignment has no due date, so without effect",
        )
    else:
        tell(
            arguments,
            zh="注意：不晚于这名学生本来的截止时间，没有作用",
            en="note: no later than the student's own due date, so without effect",
        )


def _refusal(error: ValidationError) -> CourseError:
    wrong = error.errors()[0]
    where = ".".join(str(part) for part in wrong["loc"])
    return CourseError(f"{where}: {said(wrong, 'en')}", f"{where}：{said(wrong, 'zh')}")


def _listed(names: Sequence[str], arguments: argparse.Namespace) -> str:
    """Return the names of a few assignments, or of many how many, from the first to the last."""
    if len(names) <= _FEW:
        return ", ".join(names)
    count = Text(zh=f"{len(names)} 个作业", en=f"{len(names)} assignments").get(arguments.lang)
    return f"{count} ({names[0]} … {names[-1]})"


def _change(
    before: Rules | Extension, after: Rules | Extension, zone: ZoneInfo, arguments: argparse.Namespace
) -> tuple[str, ...]:
    """Return what to print of a change: a heading, and a line for each field that differs, old and new."""
    old, new = to_document(before), to_document(after)
    teller = Teller(arguments.lang, zone)
    changed = [name for name in old if getattr(before, name) != getattr(after, name)]
    if not changed:
        head = Text(zh="没有变化", en="nothing changes")
    elif arguments.dry_run:
        head = Text(zh="将会改变（试运行，什么也没改）", en="would change (dry run: nothing was changed)")
    else:
        head = Text(zh="已改变", en="changed")
    lines = (
        f"  {name:<16} {teller.value(name, old[name])} → {teller.value(name, new[name])}" for name in changed
    )
    return (head.get(arguments.lang), *lines)


def _print_change(what: str, change: Sequence[str]) -> None:
    sys.stderr.write("\n".join((f"{what}: {change[0]}", *change[1:])) + "\n")
