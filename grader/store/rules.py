"""Rules of assignments per course, and extensions of single students."""

import hashlib
import json
from collections.abc import Collection, Mapping
from dataclasses import asdict, dataclass, field, replace
from datetime import datetime, tzinfo
from functools import lru_cache
from typing import Any, cast
from zoneinfo import ZoneInfo

from sqlalchemy import and_, bindparam, func, literal, outerjoin, select
from sqlmodel import Session, col

from grader.contracts.assignment import Distro, RunsAs
from grader.contracts.errors import ChangedMeanwhileError
from grader.contracts.fields import kinds_of
from grader.contracts.identity import Seen, unknown_course, unknown_members
from grader.contracts.python import UTC
from grader.contracts.record import from_plain
from grader.contracts.rules import NO_EXTENSION, NO_RULES, Extension, Rules, Shown
from grader.store.audit import Signature, record
from grader.store.courses import sections_of
from grader.store.database import StorePart, one_at_a_time
from grader.store.tables import CourseRow, ExtensionRow, MemberRow, RulesRow, SectionRow, table_of

_UTC = "UTC"
_TAG_LENGTH = 16
ANY_STATE = Seen(None)
_DRAFT = Rules(shown=Shown.DRAFT)

_course_of, _member_of, _rules_of, _extension_of, _section_of = (
    table_of(row).c for row in (CourseRow, MemberRow, RulesRow, ExtensionRow, SectionRow)
)
_BETWEEN = "\n"  # no name of a section has one: it can be printed
_sections = (
    select(func.aggregate_strings(_section_of.section, _BETWEEN))
    .where(_section_of.course == bindparam("course"), _section_of.person == bindparam("student"))
    .scalar_subquery()
)
ABOUT = (
    _course_of.time_zone,
    _rules_of.document,
    _extension_of.due,
    _extension_of.extra_attempts,
    _sections,
)
"""Columns of `ABOUT_FROM`, in the order of the parameters of `rules_about`."""

OF_COURSE = (_course_of.archived_at, _course_of.distro, _course_of.runs_as, _member_of.person)
"""Columns of `ABOUT_FROM`: since when the course is archived, its settings, the student if it has one."""

_ONE_ROW = select(
    literal(1).label("asked")
).subquery()  # one row, which the outer joins keep whatever is missing
ABOUT_FROM = (
    outerjoin(_ONE_ROW, table_of(CourseRow), _course_of.id == bindparam("course"))
    .outerjoin(
        table_of(MemberRow),
        and_(_member_of.course == _course_of.id, _member_of.person == bindparam("student")),
    )
    .outerjoin(
        table_of(RulesRow),
        and_(_rules_of.course == _course_of.id, _rules_of.assignment == bindparam("assignment")),
    )
    .outerjoin(
        table_of(ExtensionRow),
        and_(
            _extension_of.course == _course_of.id,
            _extension_of.assignment == bindparam("assignment"),
            _extension_of.person == bindparam("student"),
        ),
    )
)
"""Selects one row: the rules that apply to a student's submissions for an assignment (see `rules_about`).

Parameters: `course`, `assignment` and `student`.
"""


_ABOUT_ONE = select(*ABOUT, _course_of.archived_at, _course_of.distro, _course_of.runs_as).select_from(
    ABOUT_FROM
)


@dataclass(frozen=True, slots=True, kw_only=True)
class CourseRules:
    """The rules of all assignments of a course. Without courses there are none.

    Attributes:
        sections: by person; only where some rule asks for them.
        distro, runs_as: settings of the course; None without one.
        begun_with: the assignments that there were when students began to hand in; those that came later are
            drafts unless they have rules. None: nobody has handed in.
    """

    zone: ZoneInfo
    archived: bool
    by_assignment: dict[str, Rules]
    extensions: dict[tuple[str, str], Extension]
    sections: Mapping[str, Collection[str]] = field(default_factory=dict)
    distro: Distro | None = None
    runs_as: RunsAs | None = None
    begun_with: frozenset[str] | None = None

    def of(self, assignment: str, student: str | None = None) -> Rules:
        """Return the rules of one assignment, for everybody or as they hold for a student's sections."""
        rules = self.by_assignment.get(assignment) or _first_rules(self.begun_with, assignment)
        if student is None or not rules.by_section:
            return rules
        return rules.for_sections(self.sections.get(student, ()))

    def extension(self, assignment: str, person: str) -> Extension:
        """Return the extension of one student."""
        return self.extensions.get((assignment, person), NO_EXTENSION)

    def extended(self, assignment: str) -> list[tuple[str, Extension]]:
        """Return the students who have an extension for one assignment, in order, each with it."""
        return sorted(
            (person, one)
            for (of, person), one in self.extensions.items()
            if of == assignment and one != NO_EXTENSION
        )


_NO_COURSE = CourseRules(zone=ZoneInfo(_UTC), archived=False, by_assignment={}, extensions={})


class StoredRules(StorePart):
    """Reads and changes rules; every change is in the audit log. Safe to share between threads."""

    def of(self, course: str | None) -> CourseRules:
        """Return all rules of a course as they are at one instant."""
        with self._database.reading() as session:
            return rules_of(session, course)

    def about(self, course: str | None, student: str, assignment: str) -> CourseRules:
        """Return of a course's rules those that concern one student's submissions to one assignment."""
        if course is None:
            return _NO_COURSE
        asked = {"course": course, "student": student, "assignment": assignment}
        with self._database.reading() as session:
            zone, document, due, extra_attempts, sections, archived_at, distro, runs_as = (
                session.connection().execute(_ABOUT_ONE, asked).one()
            )
        extended = extra_attempts is not None
        return CourseRules(
            zone=ZoneInfo(zone or _UTC),
            archived=archived_at is not None,
            by_assignment={} if document is None else {assignment: _read(document, zone)},
            extensions={(assignment, student): Extension(due=due, extra_attempts=extra_attempts)}
            if extended
            else {},
            sections={student: (sections or "").split(_BETWEEN)},
            distro=distro,
            runs_as=runs_as,
        )

    def set(
        self,
        assignment: str,
        rules: Rules,
        signed: Signature,
        reason: str = "",
        *,
        seen: Seen = ANY_STATE,
    ) -> Rules:
        """Make `rules` the rules of an assignment in the course of `signed`; return the rules before.

        Raises:
            CourseError: there is no such course.
            ChangedMeanwhileError: the `tag` of the rules is not one of `seen`; nothing is changed.
        """
        course = signed.in_course()
        with self._database.writing() as session:
            one_at_a_time(session, "course", course)
            course_row = session.get(CourseRow, course)
            if course_row is None:
                raise unknown_course(course)
            before = _rules_before(session, course_row, assignment)
            _require(seen, before)
            document = json.dumps(to_document(rules), sort_keys=True)
            session.merge(
                RulesRow(course=course, assignment=assignment, document=document, changed_at=signed.at)
            )
            if rules != before:
                record(
                    session,
                    signed,
                    "rules.change",
                    f"assignment {assignment}",
                    before=to_document(before),
                    after=to_document(rules),
                    reason=reason,
                )
            return before

    def extend(  # noqa: PLR0913
        self,
        assignment: str,
        person: str,
        extension: Extension,
        signed: Signature,
        reason: str = "",
        *,
        seen: Seen = ANY_STATE,
    ) -> None:
        """Give one student what `extension` says, instead of what they had before.

        Raises:
            CourseError: the course has no such member.
            ChangedMeanwhileError: the `tag` of what they had is not one of `seen`; nothing is changed.
        """
        course = signed.in_course()
        with self._database.writing() as session:
            one_at_a_time(session, "course", course)
            if session.get(MemberRow, (course, person)) is None:
                raise unknown_members(course, person)
            row = session.get(ExtensionRow, (course, assignment, person))
            before = NO_EXTENSION if row is None else _extension(row)
            _require(seen, before)
            session.merge(
                ExtensionRow(course=course, assignment=assignment, person=person, **asdict(extension))
            )
            if before != extension:
                record(
                    session,
                    signed,
                    "extension.change",
                    f"assignment {assignment}, member {person}",
                    before=to_document(before),
                    after=to_document(extension),
                    reason=reason,
                )


def _rules_before(session: Session, course: CourseRow, assignment: str) -> Rules:
    row = session.get(RulesRow, (course.id, assignment))
    if row is None:
        return _first_rules(_begun_with(course), assignment)
    return _read(row.document, course.time_zone)


def add_rules(session: Session, assignment: str, rules: Rules, signed: Signature) -> None:
    """Give an assignment its first rules in the course of `signed`."""
    document = to_document(rules)
    text, course = json.dumps(document, sort_keys=True), signed.in_course()
    session.add(RulesRow(course=course, assignment=assignment, document=text, changed_at=signed.at))
    record(session, signed, "rules.change", f"assignment {assignment}", after=document)


def tag(rules: Rules | Extension) -> str:
    """Return a digest of the rules or of the extension: different ones have different tags.

    The same instants have the same tag, whatever offset they are written with: databases give back UTC.
    """
    plain = _plain(asdict(rules), UTC)
    return hashlib.sha256(json.dumps(plain, sort_keys=True).encode()).hexdigest()[:_TAG_LENGTH]


def rules_of(session: Session, course: str | None) -> CourseRules:
    """Return all rules of a course in the transaction of `session`."""
    if course is None:
        return _NO_COURSE
    row = session.get(CourseRow, course)
    ruled = select(RulesRow).where(col(RulesRow.course) == course)
    extended = select(ExtensionRow).where(col(ExtensionRow.course) == course)
    rows, extensions = session.execute(ruled).scalars(), session.execute(extended).scalars()
    zone = _UTC if row is None else row.time_zone
    by_assignment = {stored.assignment: _read(stored.document, zone) for stored in rows}
    return CourseRules(
        zone=ZoneInfo(zone),
        archived=row is not None and row.archived_at is not None,
        by_assignment=by_assignment,
        sections=sections_of(session, course)
        if any(assignment_rules.by_section for assignment_rules in by_assignment.values())
        else {},
        extensions={
            (extension.assignment, extension.person): _extension(extension) for extension in extensions
        },
        distro=None if row is None else cast("Distro", row.distro),
        runs_as=None if row is None else cast("RunsAs", row.runs_as),
        begun_with=None if row is None else _begun_with(row),
    )


def _begun_with(row: CourseRow) -> frozenset[str] | None:
    return None if row.begun_with is None else frozenset(row.begun_with.split())


def _first_rules(begun_with: Collection[str] | None, assignment: str) -> Rules:
    """Return the rules of an assignment that nobody has set."""
    return NO_RULES if begun_with is None or assignment in begun_with else _DRAFT


def rules_about(
    zone: str | None,
    document: str | None,
    due: datetime | None,
    extra_attempts: int | None,
    sections: str | None,
) -> tuple[Rules, Extension, ZoneInfo]:
    """Return rules, extension and time zone for a student's submissions, from the columns of a row of `ABOUT`."""
    rules = NO_RULES if document is None else _read(document, zone)
    rules = rules.for_sections((sections or "").split(_BETWEEN))
    extension = NO_EXTENSION if extra_attempts is None else Extension(due=due, extra_attempts=extra_attempts)
    return rules, extension, ZoneInfo(zone or _UTC)


def to_document(rules: Rules | Extension) -> dict[str, Any]:
    """Return rules or an extension as JSON-ready data; instants as ISO 8601 with their offset."""
    document: dict[str, Any] = _plain(asdict(rules))
    return document


def _plain(value: Any, zone: tzinfo | None = None) -> Any:
    """Return plain data with its instants as ISO 8601, on the clock of `zone` if given."""
    match value:
        case datetime():
            return (value if zone is None else value.astimezone(zone)).isoformat()
        case dict():
            return {name: _plain(one, zone) for name, one in value.items()}
        case list() | tuple():
            return [_plain(element, zone) for element in value]
        case _:
            return value


def from_document(document: dict[str, Any]) -> Rules:
    """Return the rules that `to_document` wrote. Raises ValueError: `to_document` wrote no such document."""
    if unknown := document.keys() - kinds_of(Rules).keys():  # msgspec ignores them in a dataclass
        raise ValueError(f"the rules have no field {min(unknown)}")
    return from_plain(Rules, document)


@lru_cache(maxsize=1_024)
def _read(document: str, zone: str | None) -> Rules:
    """Return stored rules, due dates on the clock of `zone`: by it days of lateness are counted."""
    rules, clock = from_document(json.loads(document)), ZoneInfo(zone or _UTC)
    due = None if rules.due is None else rules.due.astimezone(clock)
    sections = tuple(
        replace(section_rule, due=section_rule.due.astimezone(clock)) for section_rule in rules.by_section
    )
    return replace(rules, due=due, by_section=sections)


def _require(seen: Seen, before: Rules | Extension) -> None:
    if not seen.includes(tag(before)):
        raise ChangedMeanwhileError(
            "somebody else changed this meanwhile: look again", "刚刚有人改过：请重新查看后再改"
        )


def _extension(row: ExtensionRow) -> Extension:
    return Extension(due=row.due, extra_attempts=row.extra_attempts)
