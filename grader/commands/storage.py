"""What commands on the service's database share: where the database is, and in whose name they act."""

import argparse
import getpass
from collections.abc import Iterator
from contextlib import closing, contextmanager
from dataclasses import dataclass
from pathlib import Path

from grader.contracts.errors import CourseError, SettingsError
from grader.contracts.identity import no_course
from grader.contracts.text import trouble
from grader.operation.settings import load
from grader.store.clock import utc_now
from grader.store.courses import Courses
from grader.store.database import Database, sqlite_address
from grader.store.schema import up_to_date
from grader.store.tokens import Tokens

DATABASE_FILE = "grader.db"


@dataclass(frozen=True, slots=True, kw_only=True)
class OpenedStore:
    """The parts of the store that commands change."""

    database: Database
    courses: Courses
    tokens: Tokens


def add_data_option(parser: argparse.ArgumentParser) -> None:
    """Declare where the database is, as `grader serve` does."""
    parser.add_argument(
        "--data",
        type=Path,
        metavar="DIR",
        help="folder of the database (default: GRADER_DATABASE_URL, else here) / 数据库所在文件夹",
    )


def add_course_option(parser: argparse.ArgumentParser) -> None:
    """Declare which course is meant."""
    parser.add_argument(
        "--course", metavar="ID", help="which course, when there are several / 有几个课程时指明一个"
    )


def database_url(folder: Path | None, *, create: bool = True) -> str | None:
    """Return the address of the database in `folder`, made unless `create` is False; None when none is named.

    Raises SettingsError: the folder cannot be made.
    """
    if folder is None:
        return None
    try:
        if create:
            folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise SettingsError.about(f"--data {folder}", trouble(error)) from error
    return sqlite_address(folder / DATABASE_FILE)


def refuse_missing(database: Database) -> None:
    """Look whether the file of a SQLite database is there, which opening it would make.

    Raises SettingsError: it is not.
    """
    if database.is_sqlite and not Path(database.name).is_file():
        raise SettingsError(
            f"{database.name}: there is no database; check --data (or GRADER_DATABASE_URL)",
            f"{database.name}：没有这个数据库，请检查 --data（或 GRADER_DATABASE_URL）",
        )


@contextmanager
def opened(arguments: argparse.Namespace, *, create: bool = False) -> Iterator[OpenedStore]:
    """Open the database, also while a service works with it.

    `arguments.data` says where it is; `create`: make it when it is not there.

    Raises:
        SettingsError: it is not there, or does not fit this version. InfrastructureError: it cannot be opened.
    """
    url = database_url(arguments.data, create=create)
    with closing(Database(load().database_url if url is None else url)) as database:
        if not create:
            refuse_missing(database)
        with up_to_date(database):
            yield OpenedStore(
                database=database, courses=Courses(database, utc_now), tokens=Tokens(database, utc_now)
            )


def chosen_course(storage: OpenedStore, course: str | None) -> str:
    """Return the id of the course meant.

    Raises CourseError: there is no such course, none at all, or several and none was named.
    """
    if course is not None:
        return storage.courses.get(course).id
    courses = storage.courses.all()
    if not courses:
        raise no_course(storage.database.name)
    if len(courses) > 1:
        ids = ", ".join(course.id for course in courses)
        raise CourseError(f"say which course with --course: {ids}", f"请用 --course 指明课程：{ids}")
    return courses[0].id


def actor() -> str:
    """Return how the audit log names who uses the command line."""
    try:
        user = getpass.getuser()
    except (KeyError, OSError):
        user = "?"
    return f"command line ({user[:40]})"
