"""Courses that many tests begin with: made once, as an instructor makes them, in a database to copy."""

from collections.abc import Mapping
from contextlib import closing
from datetime import timedelta
from pathlib import Path

from grader.contracts.identity import Role, RosterEntry
from grader.store.courses import Courses
from grader.store.database import Database
from grader.store.tokens import Tokens
from tests.fakes.clock import FakeClock


class PreparedCourses:
    """Courses, their people and a token of each person, in `tokens` by person; `file` has nothing else."""

    def __init__(self, file: Path, courses: Mapping[str, Mapping[str, str]]) -> None:
        """Make them in the migrated and empty database in `file`; `courses` has the roles of each one's people."""
        self.file = file
        self.tokens: dict[str, str] = {}
        with closing(Database(f"sqlite:///{file}")) as database:
            clock = FakeClock()
            made, issued = Courses(database, clock), Tokens(database, clock)
            for course, people in courses.items():
                made.create(course, course, "Asia/Shanghai", "test")
                entries = [RosterEntry(id=one, name=one, role=Role(role)) for one, role in people.items()]
                made.import_roster(course, entries, "test")
                for one in people:
                    self.tokens[one] = issued.issue(course, one, timedelta(days=1), "test")[1]
