"""What `grader course` does from one term to the next: copy, archive, reopen, forget people, erase what is old."""

import argparse
import sys
from collections.abc import Mapping
from typing import Any

from grader.commands.options import tell, whole_number, wrong_value
from grader.commands.storage import OpenedStore, actor, add_course_option, chosen_course
from grader.commands.token import add_days_option, write_tokens
from grader.contracts.errors import CourseError
from grader.contracts.identity import Member, Role, checked_id
from grader.contracts.notation import whole
from grader.store.audit import Signature
from grader.store.clock import utc_now
from grader.store.course_life import CourseLife, NewCourse
from grader.store.erasing import Space


def configure(actions: Any) -> list[argparse.ArgumentParser]:
    """Declare the arguments of these actions; return their parsers."""
    copy = actions.add_parser(
        "copy", help="make a course with the rules of another one / 以另一课程的规则新建课程"
    )
    _configure_copy(copy)
    archive = actions.add_parser("archive", help="let a course only be read / 归档课程，只能查看")
    reopen = actions.add_parser("reopen", help="let an archived course be changed again / 取消归档")
    for parser in (archive, reopen):
        parser.add_argument("--reason", default="", help="goes into the audit log / 写进操作记录")
    forget = actions.add_parser(
        "forget", help="erase a student's work and every trace of them / 删除一名学生的全部数据"
    )
    forget.add_argument("person", help="id of the student / 学号")
    sure = forget.add_mutually_exclusive_group()
    sure.add_argument(
        "--dry-run", action="store_true", help="erase nothing, say what would be / 只显示会删除什么"
    )
    sure.add_argument("--yes", action="store_true", help="do not ask / 不再询问")
    forget.add_argument("--reason", default="", help="goes into the audit log / 写进操作记录")
    parsers = [copy, archive, reopen, forget]
    for parser in parsers:
        add_course_option(parser)
    space = actions.add_parser("space", help="what each course takes / 各课程占用的空间")
    return [*parsers, space, _configure_retention(actions)]


def _configure_retention(actions: Any) -> argparse.ArgumentParser:
    retention: argparse.ArgumentParser = actions.add_parser(
        "retention", help="erase submissions of an age, of every course / 删除各课程中过期的提交"
    )
    retention.add_argument(
        "--older-than", type=_days, required=True, metavar="DAYS", help="e.g. 400d / 天数，例如 400d"
    )
    retention.add_argument(
        "--dry-run", action="store_true", help="erase nothing, show what would be / 只显示会删除什么"
    )
    retention.add_argument("--reason", default="", help="goes into the audit log / 写进操作记录")
    retention.add_argument("--course", metavar="ID", help="of this course only / 只限这门课程")
    return retention


def _days(text: str) -> int:
    try:
        return whole(text.removesuffix("d"))
    except ValueError:
        raise wrong_value(
            zh=f"{text!r} 不行：写天数，例如 400d", en=f"{text!r} will not do: days, as in 400d"
        ) from None


def _configure_copy(copy: argparse.ArgumentParser) -> None:
    copy.add_argument("id", help="short name of the new course / 新课程的代号")
    copy.add_argument("--title", default="", help="full name (default: the short one) / 课程名称")
    copy.add_argument(
        "--instructor", required=True, metavar="ID", help="who teaches it, e.g. wang / 教师的 id"
    )
    copy.add_argument(
        "--move-days",
        type=whole_number,
        default=0,
        metavar="N",
        help="how many days later every date is / 所有日期推后几天",
    )
    add_days_option(copy)


def _copy(storage: OpenedStore, arguments: argparse.Namespace) -> None:
    original = chosen_course(storage, arguments.course)
    teacher = checked_id(arguments.instructor, "id of an instructor")
    member_before = storage.courses.member(original, teacher)
    member = Member(
        course=arguments.id,
        id=teacher,
        name=teacher if member_before is None else member_before.name,
        role=Role.INSTRUCTOR,
        email="" if member_before is None else member_before.email,
    )
    new = NewCourse(id=arguments.id, title=arguments.title, move_days=arguments.move_days)
    course = CourseLife(storage.database, utc_now).copy(original, new, member, actor())
    tell(
        arguments,
        zh=f"课程 {course.id}：规则与 {original} 相同；令牌只显示这一次",
        en=f"course {course.id} has the rules of {original}; each token is shown this once",
    )
    write_tokens(storage, course.id, [teacher], arguments.days)


def _archive(storage: OpenedStore, arguments: argparse.Namespace) -> None:
    course = chosen_course(storage, arguments.course)
    life, signed = CourseLife(storage.database, utc_now), Signature(utc_now(), course, actor())
    if arguments.action == "archive":
        life.archive(signed, arguments.reason)
        tell(arguments, zh=f"课程 {course} 已归档", en=f"course {course} is archived")
    else:
        life.reopen(signed, arguments.reason)
        tell(arguments, zh=f"课程 {course} 已取消归档", en=f"course {course} is open again")


def _forget(storage: OpenedStore, arguments: argparse.Namespace) -> None:
    course, life = chosen_course(storage, arguments.course), CourseLife(storage.database, utc_now)
    signed = Signature(utc_now(), course, actor())
    count = life.work_of(course, arguments.person)
    tell(
        arguments,
        zh=f"{arguments.person} 有 {count} 份提交，连同报告和成绩会永久删除，不能恢复",
        en=f"{arguments.person} has {count} submissions, which will be gone for good with reports and grades",
    )
    if arguments.dry_run:
        tell(arguments, zh="没有删除任何东西", en="nothing was erased")
        return
    if not arguments.yes:
        _ask_to_erase(arguments)
    forgotten = life.forget(arguments.person, signed, arguments.reason)
    tell(
        arguments,
        zh=f"已删除 {forgotten.submissions} 份提交；操作记录里现在称为 {forgotten.pseudonym}",
        en=f"{forgotten.submissions} submissions erased; the audit log says {forgotten.pseudonym} now",
    )


def _ask_to_erase(arguments: argparse.Namespace) -> None:
    """Go on only if the id is typed once more. Raises CourseError: it is not."""
    tell(arguments, zh="要删除，再输入一次学号：", en="To erase it, type the id once more:")
    if sys.stdin.readline().strip() != arguments.person:
        raise CourseError(
            "nothing was erased: the id was not typed; --yes does not ask",
            "没有删除任何东西：没有输入这个学号；加 --yes 则不询问",
        )


def _space(storage: OpenedStore, _: argparse.Namespace) -> None:
    _print(CourseLife(storage.database, utc_now).space())


def _retention(storage: OpenedStore, arguments: argparse.Namespace) -> None:
    course = None if arguments.course is None else chosen_course(storage, arguments.course)
    life = CourseLife(storage.database, utc_now)
    if arguments.dry_run:
        _print(life.old_work(course, arguments.older_than))
        tell(arguments, zh="没有删除任何东西", en="nothing was erased")
    else:
        _print(life.erase_old_work(course, arguments.older_than, actor(), arguments.reason))


def _print(spaces: Mapping[str, Space]) -> None:
    sys.stdout.write("course\tsubmissions\tsources\treports\ttrajectories\tbytes\n")
    for course, one in sorted(spaces.items()):
        sizes = (one.submissions, one.sources_bytes, one.reports_bytes, one.trajectories_bytes, one.all_bytes)
        sys.stdout.write("\t".join([course, *map(str, sizes)]) + "\n")


ACTIONS = {
    "copy": _copy,
    "archive": _archive,
    "reopen": _archive,
    "forget": _forget,
    "space": _space,
    "retention": _retention,
}
