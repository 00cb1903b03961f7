"""Courses that many tests begin with: made once as an instructor makes them, then put in as the rows they are."""

from collections.abc import Mapping
from contextlib import closing
from datetime import timedelta

from sqlalchemy import insert, select
from sqlmodel import SQLModel

from grader.contracts.identity import Role, RosterEntry
from grader.store.courses import Courses
from grader.store.database import Database
from grader.store.tables import AuditRow, CourseRow, MemberRow, TokenRow
from grader.store.tokens import Tokens
from tests.fakes.clock import FakeClock

_TABLES: tuple[type[SQLModel], ...] = (CourseRow, MemberRow, TokenRow, AuditRow)


class PreparedCourses:
    """Courses, their people and a token of each person, in `tokens` by person."""

    def __init__(self, url: str, courses: Mapping[str, Mapping[str, str]]) -> None:
        """Make them in the migrated and empty database at `url`; `courses` has the roles of each one's people."""
        database, clock = Database(url), FakeClock()
        made, issued = Courses(database, clock), Tokens(database, clock)
        self.tokens: dict[str, str] = {}
        for course, people in courses.items():
            made.create(course, course, "Asia/Shanghai", "test")
            entries = [RosterEntry(id=one, name=one, role=Role(role)) for one, role in people.items()]
            made.import_roster(course, entries, "test")
            for one in people:
                self.tokens[one] = issued.issue(course, one, timedelta(days=1), "test")[1]
        with database.reading() as session:
            self._rows = {
                table: [row.model_dump() for row in session.execute(select(table)).scalars()]
                for table in _TABLES
            }
        database.close()
        for row in self._rows[AuditRow]:
            del row["id"]  # counted anew by each database

    def put_into(self, url: str) -> None:
        """Put them into the database at `url`, which is migrated and empty."""
        with closing(Database(url)) as database, database.writing() as session:
            for table, rows in self._rows.items():
                session.execute(insert(table), rows)
