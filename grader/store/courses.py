"""Courses and their people."""

from collections.abc import Sequence
from dataclasses import dataclass
from zoneinfo import ZoneInfo, ZoneInfoNotFoundError

from sqlalchemy import ColumnElement, and_, select
from sqlmodel import Session, col

from grader.contracts.errors import CourseError
from grader.contracts.identity import (
    Course,
    Member,
    Role,
    RosterEntry,
    checked_id,
    checked_name,
    unknown_course,
)
from grader.store.audit import Signature, record
from grader.store.clock import Clock
from grader.store.database import Database, one_at_a_time
from grader.store.tables import CourseRow, MemberRow, SubmissionRow


@dataclass(frozen=True, slots=True, kw_only=True)
class RosterChange:
    """What an import did: ids of new members, of changed ones, and how many stayed as they were."""

    added: tuple[str, ...]
    changed: tuple[str, ...]
    unchanged: int


class Courses:
    """Courses and their members; safe to share between threads."""

    def __init__(self, database: Database, clock: Clock) -> None:
        self._database = database
        self._clock = clock
        self._exist = False

    def exist(self) -> bool:
        """Whether there is a course at all. Courses are never deleted, so a yes is remembered."""
        if not self._exist:
            with self._database.reading() as session:
                self._exist = session.execute(select(col(CourseRow.id)).limit(1)).first() is not None
        return self._exist

    def create(self, course_id: str, title: str, time_zone: str, actor: str) -> Course:
        """Create a course without members.

        Raises:
            CourseError: there is one of that id, or id, title or time zone are not fit.
        """
        now = self._clock()
        row = CourseRow(
            id=checked_id(course_id, "id of a course"),
            title=checked_name(title),
            time_zone=_checked_zone(time_zone),
            created_at=now,
        )
        with self._database.writing() as session:
            one_at_a_time(session, "course", course_id)
            if session.get(CourseRow, course_id) is not None:
                raise CourseError(f"there is a course {course_id} already", f"已经有课程 {course_id}")
            session.add(row)
            signed = Signature(now, course_id, actor)
            after = {"title": row.title, "time_zone": row.time_zone}
            record(session, signed, "course.create", f"course {course_id}", after=after)
            return _course(row)

    def get(self, course_id: str) -> Course:
        """Return a course.

        Raises:
            CourseError: no course has that id.
        """
        with self._database.reading() as session:
            row = session.get(CourseRow, course_id)
        if row is None:
            raise unknown_course(course_id)
        return _course(row)

    def all(self) -> tuple[Course, ...]:
        """Return every course, oldest first."""
        statement = select(CourseRow).order_by(col(CourseRow.created_at), col(CourseRow.id))
        with self._database.reading() as session:
            return tuple(_course(row) for row in session.execute(statement).scalars())

    def members(self, course_id: str | None, role: Role | None = None) -> tuple[Member, ...]:
        """Return the people of a course, nobody of None, in order of their ids; only those of `role` if given."""
        if course_id is None:
            return ()
        statement = select(MemberRow).where(col(MemberRow.course) == course_id)
        if role is not None:
            statement = statement.where(col(MemberRow.role) == role.value)
        with self._database.reading() as session:
            rows = session.execute(statement.order_by(col(MemberRow.person))).scalars()
            return tuple(_member(row) for row in rows)

    def member(self, course_id: str, person: str) -> Member | None:
        """Return one member, or None."""
        with self._database.reading() as session:
            row = session.get(MemberRow, (course_id, person))
            return None if row is None else _member(row)

    def import_roster(self, course_id: str, entries: Sequence[RosterEntry], actor: str) -> RosterChange:
        """Add and change members as `entries` say, all of them or none. Nobody is removed.

        Raises:
            CourseError: there is no such course.
        """
        signed = Signature(self._clock(), course_id, actor)
        added: list[str] = []
        changed: list[str] = []
        with self._database.writing() as session:
            one_at_a_time(session, "course", course_id)
            if session.get(CourseRow, course_id) is None:
                raise unknown_course(course_id)
            for entry in entries:
                known = session.get(MemberRow, (course_id, entry.id))
                if known is None:
                    added.append(entry.id)
                elif (known.name, known.role) != (entry.name, _role(entry, known)):
                    changed.append(entry.id)
                else:
                    continue
                _put(session, signed, course_id, entry, known)
        kept = len(entries) - len(added) - len(changed)
        return RosterChange(added=tuple(added), changed=tuple(changed), unchanged=kept)


def in_class(course: str | None) -> ColumnElement[bool]:
    """Whether a submission belongs to a class: its students' work, not what its staff tries out."""
    if course is None:
        return and_(col(SubmissionRow.course).is_(None), col(SubmissionRow.regrade).is_(None))
    students = select(col(MemberRow.person)).where(
        col(MemberRow.course) == course, col(MemberRow.role) == Role.STUDENT.value
    )
    return and_(col(SubmissionRow.course) == course, col(SubmissionRow.student).in_(students))


def _role(entry: RosterEntry, known: MemberRow | None) -> str:
    if entry.role is not None:
        return entry.role.value
    return Role.STUDENT.value if known is None else known.role


def _put(
    session: Session, signed: Signature, course: str, entry: RosterEntry, known: MemberRow | None
) -> None:
    after = {"name": entry.name, "role": _role(entry, known)}
    subject = f"member {entry.id}"
    if known is None:
        session.add(MemberRow(course=course, person=entry.id, created_at=signed.at, **after))
        record(session, signed, "member.add", subject, after=after)
    else:
        before = {"name": known.name, "role": known.role}
        known.name, known.role = after["name"], after["role"]
        record(session, signed, "member.change", subject, before=before, after=after)


def _checked_zone(name: str) -> str:
    try:
        ZoneInfo(name)
    except (ZoneInfoNotFoundError, ValueError, OSError):
        raise CourseError(
            f"{name!r} is no time zone of this machine: use a name such as Asia/Shanghai",
            f"本机没有时区 {name!r}：请用 Asia/Shanghai 这样的名称",
        ) from None
    return name


def _course(row: CourseRow) -> Course:
    return Course(id=row.id, title=row.title, time_zone=row.time_zone, created_at=row.created_at)


def _member(row: MemberRow) -> Member:
    return Member(course=row.course, id=row.person, name=row.name, role=Role(row.role))
