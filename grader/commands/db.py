"""`grader db`: bring the database up to date, back it up, put a backup back, move it to another place."""

import argparse
import sys
from collections.abc import Sequence
from contextlib import closing
from pathlib import Path

from grader.commands.options import add_language_option, tell
from grader.commands.storage import add_data_option, database_url, refuse_missing
from grader.contracts.errors import SettingsError
from grader.contracts.text import Text
from grader.operation.settings import load
from grader.store.backups import back_up, restore_file, restore_rows
from grader.store.database import Database
from grader.store.occupancy import alone
from grader.store.schema import migrate, up_to_date
from grader.store.transfer import TableContent, check_source, transfer

_SHOWN_DIGITS = 16


def configure(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments."""
    actions = parser.add_subparsers(dest="action", required=True, metavar="migrate | backup | restore | move")
    up = actions.add_parser("migrate", help="bring the tables up to date, as every start does / 更新表结构")
    backup = actions.add_parser(
        "backup", help="copy the database to a file, also while in use / 备份到文件，服务不用停"
    )
    backup.add_argument(
        "file", type=Path, help="where to; replaced when it exists / 写到哪里；已有的会被替换"
    )
    restore = actions.add_parser(
        "restore", help="put a backup in place of the database; stop the service first / 恢复备份，先停服务"
    )
    restore.add_argument("file", type=Path, help="the backup / 备份文件")
    restore.add_argument(
        "--replace",
        action="store_true",
        help="on PostgreSQL: delete what the database has now / 删除 PostgreSQL 里现有的内容",
    )
    move = actions.add_parser(
        "move",
        help="copy everything into another, empty database; stop the service first / 迁移到空数据库，先停服务",
    )
    move.add_argument(
        "--to",
        required=True,
        metavar="URL",
        help="such as postgresql+psycopg://user@host/name / 新数据库的地址",
    )
    for action in (up, backup, restore, move):
        add_data_option(action)
        add_language_option(action)


def run(arguments: argparse.Namespace) -> int:
    """Carry out the action.

    Raises SettingsError: a file or a database cannot be used; the command ends with exit code 2.
    """
    action = {"migrate": _migrate, "backup": _backup, "restore": _restore, "move": _move}[arguments.action]
    may_create = arguments.action in ("migrate", "restore")
    url = database_url(arguments.data, create=may_create) or load().database_url
    with closing(Database(url)) as database:
        if not may_create:
            refuse_missing(database)
        action(database, arguments)
    return 0


def _migrate(database: Database, arguments: argparse.Namespace) -> None:
    with up_to_date(database) as (before, after):
        if before == after:
            change = Text(zh="已是最新", en="is up to date")
        elif before is None:
            change = Text(zh="新建", en="made")
        else:
            change = Text(zh=f"原来是 {before}", en=f"was at {before}")
        tell(
            arguments,
            zh=f"{database.name}：表结构 {after}，{change.zh}",
            en=f"{database.name}: schema {after}, {change.en}",
        )


def _backup(database: Database, arguments: argparse.Namespace) -> None:
    back_up(database, arguments.file)
    tell(
        arguments,
        zh=f"已备份：{database.name} → {arguments.file}",
        en=f"backed up: {database.name} → {arguments.file}",
    )


def _restore(database: Database, arguments: argparse.Namespace) -> None:
    if database.is_sqlite:
        with alone(database):
            old = restore_file(arguments.file, Path(database.name))
        if old is not None:
            tell(arguments, zh=f"原来的数据库保留在 {old}", en=f"what was there is kept as {old}")
    else:
        with alone(database):
            restore_rows(arguments.file, database, replace=arguments.replace)
    tell(
        arguments,
        zh=f"已恢复：{arguments.file} → {database.name}",
        en=f"put back: {arguments.file} → {database.name}",
    )


def _move(database: Database, arguments: argparse.Namespace) -> None:
    with closing(Database(load(database_url=arguments.to).database_url)) as target:
        if _same(database, target):
            raise SettingsError(
                f"{target.name} is the very database that is to be moved",
                f"{target.name} 就是要迁移的那个数据库",
            )
        check_source(database)
        with alone(database), alone(target):
            migrate(target)
            _show(transfer(database, target), arguments)
        tell(
            arguments,
            zh=f"已迁移：{database.name} → {target.name}，内容完全一致；原来的数据库没有改动。"
            "接下来把 GRADER_DATABASE_URL 设为新地址再启动服务。",
            en=f"moved: {database.name} → {target.name}, everything is the same; the old one was not changed. "
            "Now set GRADER_DATABASE_URL to the new address and start the service.",
        )


def _same(source: Database, target: Database) -> bool:
    if source.is_sqlite and target.is_sqlite:
        return Path(source.name).resolve() == Path(target.name).resolve()
    return source.engine.url == target.engine.url


def _show(copied: Sequence[TableContent], arguments: argparse.Namespace) -> None:
    """Print what was copied. `transfer` has already refused any difference between the two sides."""
    width = max(len(content.table) for content in copied)
    rows, same = ("行", "一致") if arguments.lang == "zh" else ("rows", "same")
    for content in copied:
        digest = content.sha256[:_SHOWN_DIGITS]
        sys.stdout.write(f"{content.table:{width}} {content.rows:>9} {rows}  {digest}  {same}\n")
