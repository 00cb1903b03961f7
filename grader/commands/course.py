"""`grader course`: create a course, see which there are, import its people."""

import argparse
import sys
from pathlib import Path

from grader.commands import course_life
from grader.commands.options import add_distro_option, add_language_option, add_way_option, tell, whole_number
from grader.commands.storage import (
    OpenedStore,
    actor,
    add_course_option,
    add_data_option,
    chosen_course,
    opened,
)
from grader.commands.token import add_days_option, write_tokens
from grader.contracts.assignment import DEFAULT_DISTRO
from grader.contracts.errors import CourseError
from grader.contracts.identity import MOST_SESSION_HOURS, Role, RosterEntry, checked_id
from grader.contracts.text import Text, trouble
from grader.formats.sheets.reading import MAX_FILE_BYTES
from grader.formats.sheets.roster import Roster, read_roster
from grader.store.audit import Signature
from grader.store.clock import utc_now
from grader.store.costs import Costs
from grader.store.courses import RosterChange
from grader.use_cases.people import fitting

_COST_COLUMNS = ("course", "student", "in a slot", "gradings", "waiting", "tries")


def configure(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments."""
    actions = parser.add_subparsers(dest="action", required=True, metavar="create | copy | archive | …")
    create = actions.add_parser(
        "create", help="create a course and print its first tokens / 创建课程并打印令牌"
    )
    create.add_argument("id", help="short name, e.g. ros2-2026 / 课程代号")
    create.add_argument("--title", default="", help="full name (default: the short one) / 课程名称")
    create.add_argument("--time-zone", default="Asia/Shanghai", help="of its dates / 时区 (Asia/Shanghai)")
    add_distro_option(
        create, default=DEFAULT_DISTRO, help="release of ROS 2 of its scripts / 脚本用的 ROS 2 版本"
    )
    create.add_argument(
        "--instructor", required=True, metavar="ID", help="who teaches it, e.g. wang / 教师的 id"
    )
    create.add_argument(
        "--roster",
        type=Path,
        metavar="FILE",
        help="its people, each of whom gets a token / 名单，每人得到一个令牌",
    )
    add_days_option(create)
    roster = actions.add_parser(
        "roster", help="import people from a spreadsheet or CSV: id,name,... / 导入名单：学号,姓名,……"
    )
    _configure_roster(roster)
    change = actions.add_parser("set", help="change what a course is like / 修改课程设置")
    _configure_set(change)
    listing = actions.add_parser("list", help="list the courses / 列出课程")
    costs = actions.add_parser("costs", help="who cost most in the last hour / 一小时内谁占用得最多")
    for one in (create, roster, change, listing, costs, *course_life.configure(actions)):
        add_data_option(one)
        add_language_option(one)


def _configure_roster(roster: argparse.ArgumentParser) -> None:
    roster.add_argument("verb", choices=("import",))
    roster.add_argument("file", type=Path, metavar="FILE", help=".xlsx, .xls, .ods, .csv")
    roster.add_argument(
        "--dry-run", action="store_true", help="show what would change, change nothing / 只预览，不导入"
    )
    roster.add_argument(
        "--skip", action="store_true", help="import the others if rows are wrong / 跳过有错的行"
    )
    roster.add_argument(
        "--tokens", action="store_true", help="print a token for each new member / 为新成员打印令牌"
    )
    add_days_option(roster)
    add_course_option(roster)


def _configure_set(change: argparse.ArgumentParser) -> None:
    add_distro_option(
        change,
        help="release of ROS 2 of its scripts; what is graded stays / 脚本用的 ROS 2 版本，已评分的不变",
    )
    add_way_option(change)
    change.add_argument(
        "--session-hours",
        type=whole_number,
        metavar="N",
        help=f"how long members stay signed in on a page, 1 to {MOST_SESSION_HOURS} / 网页登录保持几小时",
    )
    change.add_argument("--title", help="full name / 课程名称")
    change.add_argument("--time-zone", help="on whose clock dates are read / 时区")
    change.add_argument("--reason", default="", help="goes into the audit log / 写进操作记录")
    add_course_option(change)


def run(arguments: argparse.Namespace) -> int:
    """Do it; what is wrong with a roster is raised as CourseError before anything is changed."""
    actions = {"create": _create, "roster": _import, "set": _set, "list": _list, "costs": _costs}
    action = {**actions, **course_life.ACTIONS}[arguments.action]
    with opened(arguments, create=arguments.action == "create") as storage:
        action(storage, arguments)
    return 0


def _create(storage: OpenedStore, arguments: argparse.Namespace) -> None:
    teacher = checked_id(arguments.instructor, "id of an instructor")
    listed: tuple[RosterEntry, ...] = ()
    if arguments.roster is not None:
        roster = fitting(storage.courses, arguments.id, _read(arguments.roster, arguments))
        _tell_restored(roster, arguments)
        listed = roster.checked()
    name = next((entry.name for entry in listed if entry.id == teacher), teacher)
    instructor = RosterEntry(id=teacher, name=name, role=Role.INSTRUCTOR)
    entries = [instructor, *(entry for entry in listed if entry.id != instructor.id)]
    course = storage.courses.create(
        arguments.id, arguments.title, arguments.time_zone, actor(), arguments.distro
    )
    storage.courses.import_roster(course.id, entries, actor())
    tell(
        arguments,
        zh=f"课程 {course.id}：{len(entries)} 人；令牌只显示这一次",
        en=f"course {course.id}: {_members(len(entries))}; each token is shown this once",
    )
    write_tokens(storage, course.id, [entry.id for entry in entries], arguments.days)


def _import(storage: OpenedStore, arguments: argparse.Namespace) -> None:
    course = chosen_course(storage, arguments.course)
    roster = fitting(storage.courses, course, _read(arguments.file, arguments))
    _tell_restored(roster, arguments)
    if arguments.skip:
        _tell_skipped(roster, arguments)
    if arguments.dry_run:
        _show(storage.courses.preview_roster(course, roster.entries), arguments)
    entries = roster.entries if arguments.skip else roster.checked()
    if arguments.dry_run:
        return
    change = storage.courses.import_roster(course, entries, actor())
    added, changed, same = len(change.added), len(change.changed), change.unchanged
    tell(
        arguments,
        zh=f"课程 {course}：新增 {added} 人，修改 {changed} 人，{same} 人不变",
        en=f"course {course}: {added} added, {changed} changed, {same} as they were",
    )
    if arguments.tokens:
        write_tokens(storage, course, [member.id for member in change.added], arguments.days)
    else:
        _tell_returning(change, arguments)


def _show(change: RosterChange, arguments: argparse.Namespace) -> None:
    """Print what an import would do: a line for each member who would be added, changed, or is not in the file.

    Those who are not in it are only counted where they are more than those who are: the file is a part then.
    """
    chinese = arguments.lang == "zh"
    listed = len(change.added) + len(change.changed) + change.unchanged
    is_part = len(change.gone) > listed
    for word, members in (
        ("新增" if chinese else "new", [one for one in change.added if one.id not in change.returning]),
        ("回来" if chinese else "back", [one for one in change.added if one.id in change.returning]),
        ("修改" if chinese else "change", [pair.after for pair in change.changed]),
        ("名单里没有" if chinese else "not listed", () if is_part else change.gone),
    ):
        for member in members:
            parts = (word, member.id, member.name, member.role.value, member.email, ",".join(member.sections))
            sys.stdout.write("\t".join(parts).rstrip() + "\n")
    if is_part:
        tell(
            arguments,
            zh=f"课程里还有 {len(change.gone)} 名学生不在名单里",
            en=f"{len(change.gone)} other students of the course are not in the list",
        )
    _tell_returning(change, arguments)
    tell(
        arguments,
        zh=f"{change.unchanged} 人不变；没有改动任何东西",
        en=f"{change.unchanged} as they were; nothing was changed",
    )


def _tell_returning(change: RosterChange, arguments: argparse.Namespace) -> None:
    if change.returning:
        ids = ", ".join(change.returning)
        tell(
            arguments,
            zh=f"{ids} 以前被移出过，旧令牌已失效：发新的（--tokens，或 grader token issue）",
            en=f"{ids}: removed before, so the old tokens open nothing: give them new ones "
            "(--tokens, or grader token issue)",
        )


def _set(storage: OpenedStore, arguments: argparse.Namespace) -> None:
    signed = Signature(utc_now(), chosen_course(storage, arguments.course), actor())
    if arguments.session_hours is not None and not 1 <= arguments.session_hours <= MOST_SESSION_HOURS:
        raise CourseError(
            f"--session-hours: {arguments.session_hours} will not do: write 1 to {MOST_SESSION_HOURS}",
            f"--session-hours：{arguments.session_hours} 不行，要写 1 到 {MOST_SESSION_HOURS}",
        )
    course = storage.courses.change(
        signed,
        arguments.reason,
        distro=arguments.distro,
        runs_as=arguments.runs_as,
        session_hours=arguments.session_hours,
        title=arguments.title,
        time_zone=arguments.time_zone,
    )
    settings = f"{course.title}, {course.time_zone}, ROS 2 {course.distro.capitalize()}, {course.runs_as}"
    settings += f", {course.session_hours} h"
    tell(
        arguments,
        zh=f"课程 {course.id}：{settings}；已评分的不变，要改就重新评分",
        en=f"course {course.id}: {settings}; what is graded stays until it is graded again",
    )


def _list(storage: OpenedStore, arguments: argparse.Namespace) -> None:
    for course in storage.courses.all():
        count = len(storage.courses.members(course.id))
        members = f"{count} 人" if arguments.lang == "zh" else _members(count)
        archived = Text(zh="已归档", en="archived").get(arguments.lang) if course.archived_at else ""
        line = f"{course.id}\t{course.time_zone}\t{course.distro}\t{members}\t{course.title}\t{archived}"
        sys.stdout.write(line.rstrip() + "\n")


def _costs(storage: OpenedStore, arguments: argparse.Namespace) -> None:
    chinese = arguments.lang == "zh"
    head = ("课程", "学生", "占用槽位", "评分", "等待", "启动") if chinese else _COST_COLUMNS
    sys.stdout.write("\t".join(head) + "\n")
    for cost in Costs(storage.database, utc_now).lately(None, everywhere=True):
        counts = (cost.gradings, cost.waiting, cost.tries)
        cells = (cost.course or "-", cost.student, f"{cost.slot_s:.1f} s", *map(str, counts))
        sys.stdout.write("\t".join(cells) + "\n")


def _members(count: int) -> str:
    return "1 member" if count == 1 else f"{count} members"


def _read(path: Path, arguments: argparse.Namespace) -> Roster:
    """Return a roster; of one that is not UTF-8 show a name, which tells whether it was read rightly."""
    roster = read_roster(_content(path))
    if roster.encoding == "gb18030" and roster.entries:
        named = next((entry for entry in roster.entries if not entry.name.isascii()), roster.entries[0])
        tell(
            arguments,
            zh=f"{path} 不是 UTF-8，按 GBK 读取，例如：{named.id} {named.name}",
            en=f"{path} is not UTF-8 and was read as GBK, such as: {named.id} {named.name}",
        )
    return roster


def _tell_restored(roster: Roster, arguments: argparse.Namespace) -> None:
    for restored in roster.restored:
        at, change = restored.place.words, f"{restored.written} → {restored.id}"
        tell(arguments, zh=f"{at.zh}补上学号开头的 0：{change}", en=f"{at.en}, zeros put back: {change}")


def _tell_skipped(roster: Roster, arguments: argparse.Namespace) -> None:
    for row in roster.skipped:
        at = row.place.words
        tell(
            arguments,
            zh=f"跳过{at.zh}：{row.reason.zh}",
            en=f"{at.en} is skipped: {row.reason.en}",
        )


def _content(path: Path) -> bytes:
    try:
        with path.open("rb") as file:
            return file.read(MAX_FILE_BYTES + 1)
    except OSError as error:
        raise CourseError.about(path, trouble(error)) from error
