"""`grader assignments`: list them, show what earns points, start new ones, and validate them."""

import argparse
import shlex
from pathlib import Path

from grader.catalog import Catalog
from grader.commands.options import add_language_option, whole_number
from grader.contracts.errors import AssignmentError, UnknownAssignmentError
from grader.render.terminal import console


def configure(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments."""
    actions = parser.add_subparsers(dest="action", required=True, metavar="list|show|new|validate")
    actions.add_parser("list", help="every assignment / 列出全部作业")
    show = actions.add_parser(
        "show", help="what one asks for and how it earns points / 查看一个作业的要求和评分标准"
    )
    show.add_argument("id")
    _configure_validate(
        actions.add_parser(
            "validate", help="run solutions and wrong scripts, report wrong scores / 用自带脚本检验作业"
        )
    )
    new = actions.add_parser("new", help="start a new assignment from a working example / 从例子新建一个作业")
    new.add_argument("name", help="its id, e.g. heptagon / 作业 id")
    new.add_argument(
        "--from",
        dest="like",
        metavar="ID",
        help="begin with a copy of this one, e.g. letter_l / 从这个作业复制",
    )
    for action in actions.choices.values():
        add_language_option(action)
        action.add_argument(
            "--assignments",
            type=Path,
            metavar="DIR",
            help="folder (default: built in; new needs one) / 作业文件夹",
        )


def _configure_validate(validate: argparse.ArgumentParser) -> None:
    validate.add_argument(
        "ids",
        nargs="*",
        metavar="id",
        help="these, with margins and sensitivity (default: all, without) / 只检验这些，给出细节",
    )
    validate.add_argument(
        "--seeds",
        type=whole_number,
        default=1,
        metavar="N",
        help="N times: other starts, rooms, noise, a later Ctrl+C (default: 1) / 换 N 组种子，Ctrl+C 也更晚",
    )
    validate.add_argument(
        "--mutants",
        type=whole_number,
        default=0,
        metavar="N",
        help="instead, grade N single edits of each solution / 改为给答案的 N 处小改动评分",
    )
    validate.add_argument(
        "--write",
        type=Path,
        metavar="DIR",
        help="also write their scripts to DIR/<id>, changes carried out / 把脚本（含改动后的）写到 DIR/<id>",
    )


def run(arguments: argparse.Namespace) -> int:
    """Run the chosen action; validate returns 0 when every file scores as expected, else 1."""
    if arguments.action == "new":
        return _new(arguments)
    catalog = Catalog(arguments.assignments)
    if arguments.action == "list":
        return _list(catalog, arguments)
    if arguments.action == "show":
        return _show(catalog, arguments)
    from grader.commands.audit import audit
    from grader.commands.validation import validate, validate_seeds, write_scripts

    ids = arguments.ids or [assignment.id for assignment in catalog.all()]
    if arguments.write is not None:
        write_scripts(catalog, ids, arguments.write)
    if arguments.mutants:
        return audit(catalog, ids, arguments.lang, arguments.mutants)
    if arguments.seeds > 1:
        return validate_seeds(catalog, ids, arguments.lang, arguments.seeds)
    return validate(catalog, ids, arguments.lang, details=bool(arguments.ids))


def _list(catalog: Catalog, arguments: argparse.Namespace) -> int:
    from grader.render.rubric import render_list

    console().print(render_list(catalog.all(), language=arguments.lang))
    return 0


def _new(arguments: argparse.Namespace) -> int:
    """Start an assignment in the folder named; the built-in ones belong to the installation."""
    from grader.catalog.authoring import create

    if arguments.assignments is None:
        raise AssignmentError(
            "say in which folder of assignments to start it: --assignments DIR",
            "请用 --assignments DIR 指明作业放在哪个文件夹",
        )
    arguments.assignments.mkdir(parents=True, exist_ok=True)
    catalog = Catalog(arguments.assignments)
    like = None if arguments.like is None else _folder_of(arguments.like, catalog)
    folder = create(catalog, arguments.name, like)
    command = f"grader assignments validate {arguments.name}"
    command += f" --assignments {shlex.quote(str(arguments.assignments))}"
    console().print(f"→ {folder}\n  {command}", soft_wrap=True)
    return 0


def _folder_of(assignment_id: str, catalog: Catalog) -> Path:
    """Return the folder of one of the assignments here, or else of one that comes with the grader."""
    try:
        return catalog.folder(assignment_id)
    except UnknownAssignmentError:
        return Catalog().folder(assignment_id)


def _show(catalog: Catalog, arguments: argparse.Namespace) -> int:
    from grader.checks import published_rubric
    from grader.commands.validation import fitting
    from grader.render.rubric import render_rubric

    assignment = fitting(catalog, arguments.id)
    console().print(render_rubric(assignment, published_rubric(assignment), language=arguments.lang))
    return 0
