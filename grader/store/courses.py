"""Courses and their people."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any
from zoneinfo import ZoneInfo, ZoneInfoNotFoundError

from sqlalchemy import ColumnElement, and_, delete, select
from sqlalchemy.orm import aliased
from sqlmodel import Session, col

from grader.contracts.assignment import DEFAULT_DISTRO, Distro, RunsAs
from grader.contracts.errors import CourseError
from grader.contracts.identity import (
    Course,
    Member,
    Role,
    RosterEntry,
    checked_id,
    checked_name,
    difference,
    folded_id,
    unknown_course,
    unknown_members,
)
from grader.contracts.text import Text
from grader.store.audit import Signature, record, record_all
from grader.store.clock import Clock, TimedPart
from grader.store.database import Database, one_at_a_time
from grader.store.tables import (
    OF_MEMBERS,
    AuditRow,
    CourseRow,
    MemberRow,
    SectionRow,
    SubmissionRow,
    as_contract,
)


@dataclass(frozen=True, slots=True, kw_only=True)
class MemberChange:
    """One member before and after an import."""

    before: Member
    after: Member


@dataclass(frozen=True, slots=True, kw_only=True)
class RosterChange:
    """What an import does.

    Attributes:
        unchanged: how many of the roster are in the course as it says.
        gone: students of the course whom the roster does not name; an import leaves them where they are. None
            where the roster names no student; where it says the section of every student that it names, only
            those of its sections, or of none.
        returning: ids of those added who were removed from the course before. Their tokens ended then.
    """

    added: tuple[Member, ...]
    changed: tuple[MemberChange, ...]
    unchanged: int
    gone: tuple[Member, ...]
    returning: tuple[str, ...] = ()


class Courses(TimedPart):
    """Courses and their members; safe to share between threads."""

    def exist(self) -> bool:
        """Whether there is a course at all. Courses are never deleted."""
        return self._finds(select(col(CourseRow.id)))

    def create(
        self, course_id: str, title: str, time_zone: str, actor: str, distro: Distro = DEFAULT_DISTRO
    ) -> Course:
        """Create a course without members; a blank `title` is the id.

        Raises CourseError: there is one of that id, or id, title or time zone are not fit.
        """
        with self._database.writing() as session:
            now = self._clock()
            new = Course(id=course_id, title=title, time_zone=time_zone, created_at=now, distro=distro)
            return add_course(session, new, actor)

    def __init__(self, database: Database, clock: Clock) -> None:
        super().__init__(database, clock)
        self._begun: set[str] = set()

    def change(  # noqa: PLR0913
        self,
        signed: Signature,
        reason: str = "",
        *,
        distro: Distro | None = None,
        runs_as: RunsAs | None = None,
        session_hours: int | None = None,
        title: str | None = None,
        time_zone: str | None = None,
    ) -> Course:
        """Change what the course of `signed` is like, and return it; None: stays.

        Dates stay the instants that they are; only the clock on which they are read changes with the time zone.

        Raises CourseError: there is no such course, or title or time zone are not fit.
        """
        course = signed.in_course()
        with self._database.writing() as session:
            one_at_a_time(session, "course", course)
            row = session.get(CourseRow, course)
            if row is None:
                raise unknown_course(course)
            wanted = {
                "distro": distro,
                "runs_as": runs_as,
                "session_hours": session_hours,
                "title": None if title is None else checked_name(title, "title") or row.id,
                "time_zone": None if time_zone is None else _checked_zone(time_zone.strip()),
            }
            _set(session, signed, row, wanted, reason)
            return _course(row)

    def begin(self, course_id: str, assignments: Iterable[str]) -> None:
        """Note that students hand in, and which assignments there are: new ones are drafts from then on.

        Only the first time counts.
        """
        if course_id in self._begun:
            return
        with self._database.writing() as session:
            one_at_a_time(session, "course", course_id)
            row = session.get(CourseRow, course_id)
            if row is not None and row.begun_with is None:
                row.begun_with = " ".join(sorted(assignments))
        self._begun.add(course_id)

    def get(self, course_id: str) -> Course:
        """Return a course. Raises CourseError: no course has that id."""
        row = self._get(CourseRow, course_id)
        if row is None:
            raise unknown_course(course_id)
        return _course(row)

    def all(self) -> tuple[Course, ...]:
        """Return every course, oldest first."""
        statement = select(CourseRow).order_by(col(CourseRow.created_at), col(CourseRow.id))
        return tuple(_course(row) for row in self._scalars(statement))

    def members(self, course_id: str | None, role: Role | None = None) -> tuple[Member, ...]:
        """Return the people of a course in order of their ids, only those of `role` if given; None: nobody."""
        if course_id is None:
            return ()
        with self._database.reading() as session:
            return tuple(_members(session, course_id, role).values())

    def member(self, course_id: str, person: str) -> Member | None:
        """Return one member, or None."""
        with self._database.reading() as session:
            return _one_member(session, course_id, person)

    def alike(self, course_id: str, entries: Sequence[RosterEntry]) -> dict[str, Text]:
        """Return why new ids in `entries` are probably other spellings of members' ids, by new id."""
        with self._database.reading() as session:
            return _alike(entries, _members(session, course_id))

    def preview_roster(self, course_id: str, entries: Sequence[RosterEntry]) -> RosterChange:
        """Return what `import_roster` would do now. Raises as `import_roster`."""
        with self._database.reading() as session:
            return _roster_change(session, course_id, entries)

    def import_roster(self, course_id: str, entries: Sequence[RosterEntry], actor: str) -> RosterChange:
        """Add and change members as `entries` say, all of them or none. Nobody is removed.

        Raises:
            CourseError: there is no such course; an id is probably another spelling of a member's; or no
                instructor would be left.
        """
        signed = Signature(self._clock(), course_id, actor)
        with self._database.writing() as session:
            one_at_a_time(session, "course", course_id)
            change = _roster_change(session, course_id, entries)
            add_members(session, signed, change.added)
            for member in change.changed:
                _change(session, signed, member)
            return change

    def remove(self, course_id: str, people: Sequence[str], actor: str, reason: str = "") -> None:
        """Remove people from a course, all of them or none, with their tokens, extensions and sections.

        Their submissions stay stored, and count again if they come back.

        Raises CourseError: one of them is no member, or no instructor would be left.
        """
        signed = Signature(self._clock(), course_id, actor)
        with self._database.writing() as session:
            one_at_a_time(session, "course", course_id)
            members = _members(session, course_id)
            unknown = [one for one in people if one not in members]
            if unknown:
                raise unknown_members(course_id, *unknown)
            _check_instructor(members, {id_: one for id_, one in members.items() if id_ not in people})
            for table in OF_MEMBERS:
                theirs = col(table.course) == course_id, col(table.person).in_(people)
                session.execute(delete(table).where(*theirs))
            for person in people:
                before = _audited(members[person])
                record(session, signed, "member.remove", f"member {person}", before=before, reason=reason)


def _set(
    session: Session, signed: Signature, row: CourseRow, wanted: Mapping[str, object], reason: str
) -> None:
    """Give a course's row the values in `wanted` that are not None."""
    after = {
        name: value for name, value in wanted.items() if value is not None and value != getattr(row, name)
    }
    before = {name: getattr(row, name) for name in after}
    for name, value in after.items():
        setattr(row, name, value)
    if after:
        subject = f"course {row.id}"
        record(session, signed, "course.change", subject, before=before, after=after, reason=reason)


def add_course(session: Session, new: Course, actor: str, copy_of: str | None = None) -> Course:
    """Add a course without members; return it as it is kept.

    Raises CourseError: there is one of that id, or id, title or time zone are not fit.
    """
    row = CourseRow(
        id=checked_id(new.id, "id of a course"),
        title=checked_name(new.title, "title") or new.id,
        time_zone=_checked_zone(new.time_zone),
        created_at=new.created_at,
        distro=new.distro,
        runs_as=new.runs_as,
        session_hours=new.session_hours,
    )
    one_at_a_time(session, "course", row.id.casefold())
    for other in session.execute(select(col(CourseRow.id))).scalars():
        if other.casefold() == row.id.casefold():
            raise CourseError(f"there is a course {other} already", f"已经有课程 {other}", "id")
    session.add(row)
    session.flush()
    after = {
        name: getattr(row, name) for name in ("title", "time_zone", "distro", "runs_as", "session_hours")
    }
    if copy_of is not None:
        after["copy_of"] = copy_of
    signed = Signature(new.created_at, row.id, actor)
    record(session, signed, "course.create", f"course {row.id}", after=after)
    return _course(row)


def add_members(session: Session, signed: Signature, members: Sequence[Member]) -> None:
    """Add people who are not in it yet to the course of `signed`."""
    record_all(session, signed, "member.add", {f"member {member.id}": _audited(member) for member in members})
    session.add_all(
        MemberRow(
            course=member.course,
            person=member.id,
            name=member.name,
            role=member.role.value,
            email=member.email,
            created_at=signed.at,
        )
        for member in members
    )
    session.flush()  # before what refers to them
    session.add_all(section for member in members for section in _sections(member))


def bound_to(session: Session, course: str, assistant: str) -> frozenset[str] | None:
    """Return the students in an assistant's sections; None if the assistant has no section: then all students."""
    own, theirs, member = aliased(SectionRow), aliased(SectionRow), MemberRow
    statement = (
        select(col(theirs.person), col(member.role))
        .join_from(
            own, theirs, (col(theirs.course) == col(own.course)) & (col(theirs.section) == col(own.section))
        )
        .join(member, (col(member.course) == col(theirs.course)) & (col(member.person) == col(theirs.person)))
        .where(col(own.course) == course, col(own.person) == assistant)
    )
    rows = session.execute(statement).all()  # the assistant is in each of the sections, too
    return frozenset(person for person, role in rows if role == Role.STUDENT.value) if rows else None


def sections_of(session: Session, course: str) -> dict[str, list[str]]:
    """Return the sections of each person of a course who has any, by id."""
    sections: dict[str, list[str]] = {}
    for row in session.execute(select(SectionRow).where(col(SectionRow.course) == course)).scalars():
        sections.setdefault(row.person, []).append(row.section)
    return sections


def in_class(course: str | None, students: frozenset[str] | None = None) -> ColumnElement[bool]:
    """Return the condition that a submission is a student's of the class, and not one that staff tried out.

    `students`: only theirs. `course` None: the class of a service without courses.
    """
    if students is not None:
        return and_(in_class(course), col(SubmissionRow.student).in_(students))
    if course is None:
        return and_(col(SubmissionRow.course).is_(None), col(SubmissionRow.regrade).is_(None))
    everybody = select(col(MemberRow.person)).where(
        col(MemberRow.course) == course, col(MemberRow.role) == Role.STUDENT.value
    )
    return and_(col(SubmissionRow.course) == course, col(SubmissionRow.student).in_(everybody))


def _members(session: Session, course: str, role: Role | None = None) -> dict[str, Member]:
    """Return the people of a course by id, in order of their ids."""
    member = MemberRow  # its columns, not objects: making those takes ten times as long
    columns = select(col(member.person), col(member.name), col(member.role), col(member.email))
    statement = columns.where(col(member.course) == course)
    if role is not None:
        statement = statement.where(col(MemberRow.role) == role.value)
    rows = session.execute(statement.order_by(col(MemberRow.person))).all()
    sections = sections_of(session, course)
    return {row.person: _member(course, row, sections.get(row.person, ())) for row in rows}


def _one_member(session: Session, course: str, person: str) -> Member | None:
    row = session.get(MemberRow, (course, person))
    if row is None:
        return None
    theirs = select(col(SectionRow.section)).where(
        col(SectionRow.course) == course, col(SectionRow.person) == person
    )
    return _member(course, row, session.execute(theirs).scalars())


def _roster_change(session: Session, course: str, entries: Sequence[RosterEntry]) -> RosterChange:
    if session.get(CourseRow, course) is None:
        raise unknown_course(course)
    members = _members(session, course)
    if alike := _alike(entries, members):
        en, zh = ("\n".join(why.get(language) for why in alike.values()) for language in ("en", "zh"))
        raise CourseError(f"nobody was added or changed:\n{en}", f"没有添加或修改任何人：\n{zh}", "id")
    after = [_put_into(members.get(entry.id), course, entry) for entry in entries]
    _check_instructor(members, members | {member.id: member for member in after})
    added = tuple(member for member in after if member.id not in members)
    return RosterChange(
        added=added,
        changed=tuple(
            MemberChange(before=members[member.id], after=member)
            for member in after
            if member.id in members and members[member.id] != member
        ),
        unchanged=sum(members.get(member.id) == member for member in after),
        gone=_gone(members, after, entries),
        returning=_removed_before(session, course, [member.id for member in added]),
    )


def _gone(
    before: Mapping[str, Member], after: Sequence[Member], entries: Sequence[RosterEntry]
) -> tuple[Member, ...]:
    listed = {member.id for member in after}
    students = [(one, entry) for one, entry in zip(after, entries, strict=True) if one.role is Role.STUDENT]
    whole = not all(entry.sections for _, entry in students)
    sections = {name for one, _ in students for name in one.sections}
    return tuple(
        member
        for member in before.values()
        if students
        and member.role is Role.STUDENT
        and member.id not in listed
        and (whole or not member.sections or sections.intersection(member.sections))
    )


def _removed_before(session: Session, course: str, people: Sequence[str]) -> tuple[str, ...]:
    removals = select(col(AuditRow.subject)).where(
        col(AuditRow.course) == course, col(AuditRow.action) == "member.remove"
    )
    removed = set(session.execute(removals).scalars()) if people else set()
    return tuple(person for person in people if f"member {person}" in removed)


def _put_into(member: Member | None, course: str, entry: RosterEntry) -> Member:
    """Return the member that results from `entry`; `member` is the member so far, None if there is none."""
    before = member or Member(course=course, id=entry.id, name="", role=Role.STUDENT)
    return replace(
        before,
        name=entry.name or before.name,
        role=entry.role or before.role,
        email=before.email if entry.email is None else entry.email,
        sections=before.sections if entry.sections is None else tuple(sorted(set(entry.sections))),
    )


def _alike(entries: Sequence[RosterEntry], members: Mapping[str, Member]) -> dict[str, Text]:
    """Return what to say of new ids that differ from a member's only in case, or in leading zeros."""
    folded = {folded_id(member): member for member in members}
    clashes = {
        entry.id: folded[folded_id(entry.id)]
        for entry in entries
        if entry.id not in members and folded_id(entry.id) in folded
    }
    return {
        new: Text(
            zh=f"{new} 和已有的成员 {old} {difference(new, old).zh}",
            en=f"{new} differs from the member {old} only in {difference(new, old).en}",
        )
        for new, old in clashes.items()
    }


def _check_instructor(before: Mapping[str, Member], after: Mapping[str, Member]) -> None:
    """Refuse a change that leaves a course without its last instructor."""
    had, has = (any(member.role is Role.INSTRUCTOR for member in them.values()) for them in (before, after))
    if had and not has:
        raise CourseError(
            "the course would have no instructor: make somebody else one first",
            "这样课程就没有教师了：请先让另一个人当教师",
            "role",
        )


def _audited(member: Member) -> dict[str, object]:
    """Return a member as the audit log records it, without an address or sections if there are none."""
    values: dict[str, object] = {"name": member.name, "role": member.role.value}
    if member.email:
        values["email"] = member.email
    if member.sections:
        values["sections"] = list(member.sections)
    return values


def _change(session: Session, signed: Signature, change: MemberChange) -> None:
    member = change.after
    row = session.get_one(MemberRow, (member.course, member.id))
    row.name, row.role, row.email = member.name, member.role.value, member.email
    if change.before.sections != member.sections:
        theirs = col(SectionRow.course) == member.course, col(SectionRow.person) == member.id
        session.execute(delete(SectionRow).where(*theirs))
        session.add_all(_sections(member))
    before, after = _audited(change.before), _audited(member)
    record(session, signed, "member.change", f"member {member.id}", before=before, after=after)


def _sections(member: Member) -> list[SectionRow]:
    return [
        SectionRow(course=member.course, person=member.id, section=section) for section in member.sections
    ]


def _checked_zone(name: str) -> str:
    try:
        ZoneInfo(name)
    except (ZoneInfoNotFoundError, ValueError, OSError):
        raise CourseError(
            f"{name!r} is no time zone of this machine: use a name such as Asia/Shanghai",
            f"本机没有时区 {name!r}：请用 Asia/Shanghai 这样的名称",
            "time_zone",
        ) from None
    return name


def _course(row: CourseRow) -> Course:
    return as_contract(row, Course)


def _member(course: str, row: Any, sections: Iterable[str]) -> Member:
    return Member(
        course=course,
        id=row.person,
        name=row.name,
        role=Role(row.role),
        email=row.email,
        sections=tuple(sorted(sections)),
    )
