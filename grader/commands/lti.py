"""`grader lti`: the learning platforms of a course, and the keys with which the service signs its requests."""

import argparse
import sys

from grader.commands.options import add_language_option, tell
from grader.commands.storage import actor, add_course_option, add_data_option, chosen_course, opened
from grader.contracts.errors import CourseError, GraderError, RefusedError
from grader.contracts.platform import NewPlatform
from grader.contracts.text import Text
from grader.store.audit import Signature
from grader.store.clock import utc_now
from grader.store.platforms import KEY_READ_WITHIN, Platforms
from grader.use_cases.platforms import wrong_field

_REFUSED = {
    "platform_exists": Text(
        zh="这个平台已经添加过：一个客户端 ID 只属于一门课程",
        en="this platform was added before: a client ID is of one course",
    ),
    "platform_differs": Text(
        zh="这个平台的另一个部署用的是别的地址", en="another deployment of this platform has other addresses"
    ),
    "too_many_platforms": Text(
        zh="这门课程的学习平台太多了", en="the course has too many learning platforms"
    ),
}
_NOT_THERE = Text(
    zh="没有这样的学习平台（grader lti list）", en="there is no such platform (grader lti list)"
)


def configure(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments."""
    actions = parser.add_subparsers(dest="action", required=True, metavar="list | add | remove | rotate")
    listing = actions.add_parser(
        "list", help="list platforms, and what leads here from them / 列出学习平台及其活动"
    )
    add = actions.add_parser("add", help="let a platform send people to the course / 添加学习平台")
    for name in NewPlatform.__dataclass_fields__:
        add.add_argument(f"--{name.replace('_', '-')}", required=True, metavar="TEXT")
    remove = actions.add_parser(
        "remove", help="let it send nobody any more; signs its people out / 移除学习平台，其用户被登出"
    )
    remove.add_argument("platform", help="the id that `list` shows / list 显示的 id")
    rotate = actions.add_parser(
        "rotate", help="make a new key; it signs when platforms have read it / 更换签名密钥"
    )
    rotate.add_argument(
        "--now",
        action="store_true",
        help="the old one is known to others: use the new one at once, and no old one / 旧密钥已泄露：立即停用",
    )
    for action in (listing, add, remove, rotate):
        if action is not rotate:  # the keys are the service's, not a course's
            add_course_option(action)
        add_data_option(action)
        add_language_option(action)


def run(arguments: argparse.Namespace) -> int:
    """Carry the action out. Raises GraderError: there is no such platform, or a field is wrong."""
    with opened(arguments) as storage:
        platforms = Platforms(storage.database, utc_now)
        if arguments.action == "rotate":
            _rotate(platforms, arguments)
            return 0
        course = chosen_course(storage, arguments.course)
        {"list": _list, "add": _add, "remove": _remove}[arguments.action](platforms, course, arguments)
    return 0


def _list(platforms: Platforms, course: str, arguments: argparse.Namespace) -> None:
    links = platforms.links(course)
    for platform in platforms.of_course(course):
        sys.stdout.write(
            f"{platform.id}\t{platform.title}\t{platform.issuer}\t{platform.client_id}\t{platform.deployment}\n"
        )
        for link in links:
            if link.platform == platform.id:
                scores = Text(zh="接收成绩", en="takes scores") if link.line_item else Text(zh="-", en="-")
                columns = (link.title or link.resource, link.assignment or "-", scores.get(arguments.lang))
                sys.stdout.write("\t" + "\t".join(columns) + "\n")


def _add(platforms: Platforms, course: str, arguments: argparse.Namespace) -> None:
    new = NewPlatform(**{name: getattr(arguments, name).strip() for name in NewPlatform.__dataclass_fields__})
    field = wrong_field(new)
    if field is not None:
        option = f"--{field.replace('_', '-')}"
        raise CourseError(
            f"{option}: copy it from the platform as it stands; addresses begin with https://",
            f"{option}：请照平台显示的原样填写；地址以 https:// 开头",
        )
    try:
        added = platforms.add(new, Signature(utc_now(), course, actor()))
    except RefusedError as error:
        raise _worded(error) from None
    sys.stdout.write(f"{added.id}\n")


def _remove(platforms: Platforms, course: str, arguments: argparse.Namespace) -> None:
    if not platforms.remove(arguments.platform, Signature(utc_now(), course, actor())):
        raise CourseError(_NOT_THERE.en, _NOT_THERE.zh)
    tell(arguments, zh="已移除", en="removed")


def _rotate(platforms: Platforms, arguments: argparse.Namespace) -> None:
    from grader.outside.lti.scores import new_key  # its cryptography is needed for this action alone

    platforms.rotate_key(new_key, at_once=arguments.now)
    hours = KEY_READ_WITHIN.total_seconds() / 3600
    if arguments.now:
        tell(arguments, zh="新密钥已启用，旧密钥全部作废", en="the new key signs now; the old ones are gone")
    else:
        tell(
            arguments,
            zh=f"新密钥已公布，{hours:g} 小时后启用",
            en=f"the new key is shown, and signs in {hours:g} hours",
        )


def _worded(error: RefusedError) -> GraderError:
    """Return the error with the text that commands have for its code."""
    text = _REFUSED.get(error.code)
    return error if text is None else CourseError(text.en, text.zh)
