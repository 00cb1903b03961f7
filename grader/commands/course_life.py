"""What `grader course` does with a course from one term to the next: copy it, archive and reopen it."""

import argparse
from typing import Any

from grader.commands.options import tell
from grader.commands.storage import OpenedStore, actor, add_course_option, chosen_course
from grader.commands.token import add_days_option, write_tokens
from grader.contracts.identity import Member, Role, checked_id
from grader.contracts.notation import whole
from grader.store.audit import Signature
from grader.store.clock import utc_now
from grader.store.course_life import CourseLife, NewCourse


def configure(actions: Any) -> list[argparse.ArgumentParser]:
    """Declare the arguments of these actions; return their parsers."""
    copy = actions.add_parser(
        "copy", help="make a course with the rules of another one / 以另一课程的规则新建课程"
    )
    _configure_copy(copy)
    archive = actions.add_parser("archive", help="let a course only be read / 归档课程，只能查看")
    reopen = actions.add_parser("reopen", help="let an archived course be changed again / 取消归档")
    for one in (archive, reopen):
        one.add_argument("--reason", default="", help="goes into the audit log / 写进操作记录")
    made = [copy, archive, reopen]
    for one in made:
        add_course_option(one)
    return made


def _configure_copy(copy: argparse.ArgumentParser) -> None:
    copy.add_argument("id", help="short name of the new course / 新课程的代号")
    copy.add_argument("--title", default="", help="full name (default: the short one) / 课程名称")
    copy.add_argument(
        "--instructor", required=True, metavar="ID", help="who teaches it, e.g. wang / 教师的 id"
    )
    copy.add_argument(
        "--move-days",
        type=whole,
        default=0,
        metavar="N",
        help="how many days later every date is / 所有日期推后几天",
    )
    add_days_option(copy)


def _copy(storage: OpenedStore, arguments: argparse.Namespace) -> None:
    original = chosen_course(storage, arguments.course)
    teacher = checked_id(arguments.instructor, "id of an instructor")
    known = storage.courses.member(original, teacher)
    member = Member(
        course=arguments.id,
        id=teacher,
        name=teacher if known is None else known.name,
        role=Role.INSTRUCTOR,
        email="" if known is None else known.email,
    )
    new = NewCourse(id=arguments.id, title=arguments.title or arguments.id, move_days=arguments.move_days)
    made = CourseLife(storage.database, utc_now).copy(original, new, member, actor())
    tell(
        arguments,
        zh=f"课程 {made.id}：规则与 {original} 相同；令牌只显示这一次",
        en=f"course {made.id} has the rules of {original}; each token is shown this once",
    )
    write_tokens(storage, made.id, [teacher], arguments.days)


def _archive(storage: OpenedStore, arguments: argparse.Namespace) -> None:
    course = chosen_course(storage, arguments.course)
    life, signed = CourseLife(storage.database, utc_now), Signature(utc_now(), course, actor())
    if arguments.action == "archive":
        life.archive(signed, arguments.reason)
        tell(arguments, zh=f"课程 {course} 已归档", en=f"course {course} is archived")
    else:
        life.reopen(signed, arguments.reason)
        tell(arguments, zh=f"课程 {course} 已取消归档", en=f"course {course} is open again")


ACTIONS = {"copy": _copy, "archive": _archive, "reopen": _archive}
