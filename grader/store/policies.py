"""Rules of assignments per course, and extensions of single students."""

import hashlib
import json
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from functools import lru_cache
from typing import Any
from zoneinfo import ZoneInfo

from sqlalchemy import and_, bindparam, literal, outerjoin, select
from sqlmodel import Session, col

from grader.contracts.errors import ChangedMeanwhileError
from grader.contracts.identity import no_course, unknown_course, unknown_members
from grader.contracts.policy import (
    NO_EXTENSION,
    NO_POLICY,
    AssignmentPolicy,
    Counts,
    Extension,
    LateRule,
    LateStep,
)
from grader.contracts.seen import Seen
from grader.store.audit import Signature, record
from grader.store.course_tables import CourseRow, ExtensionRow, MemberRow, PolicyRow
from grader.store.database import Database
from grader.store.locks import one_at_a_time
from grader.store.tables import table_of

_INSTANTS = ("opens", "due", "hidden_until")
_UTC = "UTC"
_TAG_LENGTH = 16
ANY_STATE = Seen(None)

_course_of, _policy_of, _extension_of = (table_of(row).c for row in (CourseRow, PolicyRow, ExtensionRow))
ABOUT = (_course_of.time_zone, _policy_of.document, _extension_of.due, _extension_of.extra_attempts)
"""What `rules_about` takes: columns of `ABOUT_FROM`."""

_ASKED = select(literal(1).label("asked")).subquery()  # so that there is one row whatever is missing
ABOUT_FROM = (
    outerjoin(_ASKED, table_of(CourseRow), _course_of.id == bindparam("course"))
    .outerjoin(
        table_of(PolicyRow),
        and_(_policy_of.course == _course_of.id, _policy_of.assignment == bindparam("assignment")),
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
"""One row: what rules the work of a student for an assignment. Takes `course`, `assignment` and `student`."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Rules:
    """Everything that decides about submissions of a course. Without courses nothing is ruled."""

    zone: ZoneInfo
    policies: dict[str, AssignmentPolicy]
    extensions: dict[tuple[str, str], Extension]

    def policy(self, assignment: str) -> AssignmentPolicy:
        """Return the rules of one assignment."""
        return self.policies.get(assignment, NO_POLICY)

    def extension(self, assignment: str, person: str) -> Extension:
        """Return what one student gets beyond them."""
        return self.extensions.get((assignment, person), NO_EXTENSION)


class Policies:
    """Reads and changes rules; every change is in the audit log. Safe to share between threads."""

    def __init__(self, database: Database) -> None:
        self._database = database

    def rules(self, course: str | None) -> Rules:
        """Return all rules of a course as they are at one instant."""
        with self._database.reading() as session:
            return rules_of(session, course)

    def set(
        self,
        assignment: str,
        policy: AssignmentPolicy,
        signed: Signature,
        reason: str = "",
        *,
        seen: Seen = ANY_STATE,
    ) -> AssignmentPolicy:
        """Make `policy` the rules of an assignment in the course of `signed`; return the rules before.

        Raises:
            CourseError: there is no such course.
            ChangedMeanwhileError: the rules, by their `tag`, are none of `seen`; they stay.
        """
        course = _course(signed)
        with self._database.writing() as session:
            one_at_a_time(session, "course", course)
            if session.get(CourseRow, course) is None:
                raise unknown_course(course)
            row = session.get(PolicyRow, (course, assignment))
            before = NO_POLICY if row is None else _read(row.document)
            _require(seen, before)
            document = json.dumps(to_document(policy), sort_keys=True)
            session.merge(
                PolicyRow(course=course, assignment=assignment, document=document, changed_at=signed.at)
            )
            if policy != before:
                record(
                    session,
                    signed,
                    "policy.change",
                    f"assignment {assignment}",
                    before=to_document(before),
                    after=to_document(policy),
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
            ChangedMeanwhileError: what they had, by its `tag`, is none of `seen`; it stays.
        """
        course = _course(signed)
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


def tag(rules: AssignmentPolicy | Extension) -> str:
    """Return what names these rules, or this extension: others have another.

    The same instants have the same tag, whatever offset they are written with: databases give back UTC.
    """
    told = {
        name: one.astimezone(UTC).isoformat() if isinstance(one, datetime) else one
        for name, one in asdict(rules).items()
    }
    return hashlib.sha256(json.dumps(told, sort_keys=True).encode()).hexdigest()[:_TAG_LENGTH]


def rules_of(session: Session, course: str | None) -> Rules:
    """Return all rules of a course in the transaction of `session`."""
    if course is None:
        return Rules(zone=ZoneInfo(_UTC), policies={}, extensions={})
    row = session.get(CourseRow, course)
    ruled = select(PolicyRow).where(col(PolicyRow.course) == course)
    extended = select(ExtensionRow).where(col(ExtensionRow.course) == course)
    policies, extensions = session.execute(ruled).scalars(), session.execute(extended).scalars()
    return Rules(
        zone=ZoneInfo(_UTC if row is None else row.time_zone),
        policies={one.assignment: _read(one.document) for one in policies},
        extensions={(one.assignment, one.person): _extension(one) for one in extensions},
    )


def rules_about(
    zone: str | None, document: str | None, due: datetime | None, extra_attempts: int | None
) -> tuple[AssignmentPolicy, Extension, ZoneInfo]:
    """Return what rules the work of a student for an assignment, from a row of `ABOUT`."""
    policy = NO_POLICY if document is None else _read(document)
    extension = NO_EXTENSION if extra_attempts is None else Extension(due=due, extra_attempts=extra_attempts)
    return policy, extension, ZoneInfo(zone or _UTC)


def to_document(rules: AssignmentPolicy | Extension) -> dict[str, Any]:
    """Return rules or an extension as JSON-ready data; instants as ISO 8601 with their offset."""
    return {
        name: one.isoformat() if isinstance(one, datetime) else one for name, one in asdict(rules).items()
    }


def from_document(document: dict[str, Any]) -> AssignmentPolicy:
    """Return the policy that `to_document` wrote.

    Raises:
        ValueError: it is not one.
    """
    values = dict(document)
    late = dict(values.pop("late"))
    steps = tuple(LateStep(**step) for step in late.pop("steps"))
    for name in _INSTANTS:
        if values[name] is not None:
            values[name] = datetime.fromisoformat(values[name])
    values["hidden_items"] = tuple(values["hidden_items"])
    values["counts"] = Counts(values["counts"])
    return AssignmentPolicy(late=LateRule(steps=steps, **late), **values)


@lru_cache(maxsize=1_024)
def _read(document: str) -> AssignmentPolicy:
    return from_document(json.loads(document))


def _require(seen: Seen, before: AssignmentPolicy | Extension) -> None:
    if not seen.includes(tag(before)):
        raise ChangedMeanwhileError(
            "somebody else changed this meanwhile: look again", "刚刚有人改过：请重新查看后再改"
        )


def _extension(row: ExtensionRow) -> Extension:
    return Extension(due=row.due, extra_attempts=row.extra_attempts)


def _course(signed: Signature) -> str:
    if signed.course is None:
        raise no_course()
    return signed.course
