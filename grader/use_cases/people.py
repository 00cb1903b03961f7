"""Who is in the course, and what was changed by whom."""

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import timedelta

from grader.contracts.assignment import Distro, RunsAs
from grader.contracts.errors import CourseError, RefusedError
from grader.contracts.identity import (
    AuditEntry,
    Caller,
    Course,
    Member,
    Role,
    RosterEntry,
    Seen,
    checked_entry,
    folded_id,
)
from grader.contracts.text import Text
from grader.formats.sheets.roster import Roster, read_roster
from grader.store.courses import Courses, RosterChange
from grader.use_cases.callers import require_instructor, require_staff, taught_course
from grader.use_cases.services import Services

TOKEN_COLUMNS = ("id", "name", "role", "section", "email", "token")
"""Of a table of tokens, for mail merge."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ImportPlan:
    """A class list that was read, and what importing it does."""

    roster: Roster
    change: RosterChange

    @property
    def tag(self) -> str:
        """Return a name of this plan that changes with the list and with the course's people."""
        return hashlib.sha256(repr(self.change).encode()).hexdigest()[:16]


def myself(services: Services, caller: Caller) -> tuple[Course | None, Member | None]:
    """Return the caller's course and the caller as its member; None while nobody's identity is known."""
    if caller.course is None or caller.person is None:
        return None, None
    return services.courses.get(caller.course), services.courses.member(caller.course, caller.person)


def members(services: Services, caller: Caller, role: Role | None = None) -> Sequence[Member]:
    """Return who is in the caller's course, of one role or of all; nobody while there are no courses.

    Of students those that the caller looks after. For staff.
    """
    require_staff(caller)
    members_of_role = services.courses.members(caller.course, role)
    return tuple(
        member
        for member in members_of_role
        if member.role is not Role.STUDENT or caller.looks_after(member.id)
    )


def change_course(  # noqa: PLR0913
    services: Services,
    caller: Caller,
    reason: str,
    *,
    distro: Distro | None = None,
    runs_as: RunsAs | None = None,
    session_hours: int | None = None,
    title: str | None = None,
    time_zone: str | None = None,
) -> Course:
    """Change what the caller's course is like, and return it; None: stays. What is graded already stays, too.

    Raises RefusedError: the caller is no instructor, there is no course, or title or time zone do not fit.
    """
    taught_course(caller)
    signed = services.signature(caller)
    try:
        return services.courses.change(
            signed,
            reason,
            distro=distro,
            runs_as=runs_as,
            session_hours=session_hours,
            title=title,
            time_zone=time_zone,
        )
    except CourseError as error:
        raise RefusedError("invalid_course", error.text, field=error.field) from None


def plan_import(services: Services, caller: Caller, content: bytes) -> ImportPlan:
    """Return what importing a list, as `grader.formats.sheets.roster` reads them, would do; nothing is changed.

    Raises RefusedError: the caller is no instructor, there is no course, or the list cannot be read or imported.
    """
    course = taught_course(caller)
    try:
        roster = fitting(services.courses, course, read_roster(content))
        return ImportPlan(roster=roster, change=services.courses.preview_roster(course, roster.entries))
    except CourseError as error:
        raise RefusedError("invalid_roster", error.text, field="file") from None


def fitting(courses: Courses, course: str, roster: Roster) -> Roster:
    """Return a list in which ids that lost zeros at their beginning have them again if it is sure whose they are.

    Other rows whose ids are probably other spellings of members' ids are wrong rows.
    """
    restored = roster.restoring(_whole_ids(courses.members(course), roster.entries))
    return restored.without(courses.alike(course, restored.entries))


def _whole_ids(members: Sequence[Member], entries: Sequence[RosterEntry]) -> dict[str, str]:
    """Return by shortened id the whole one: that of the row's e-mail address, or of a member of the row's name."""
    taken = {one.id for one in entries}
    known = {one.id for one in members}
    by_number = {(folded_id(one.id), one.name): one.id for one in members if one.id.isdecimal()}
    whole: dict[str, str] = {}
    for entry in entries:
        if entry.id in known or not entry.id.isdecimal():
            continue
        mailbox = (entry.email or "").partition("@")[0]
        meant = mailbox if mailbox.isdecimal() and mailbox.lstrip("0") == entry.id else ""
        meant = by_number.get((folded_id(entry.id), entry.name), meant)
        if len(meant) > len(entry.id) and meant not in taken:
            whole[entry.id] = meant
    return whole


def import_list(  # noqa: PLR0913
    services: Services,
    caller: Caller,
    content: bytes,
    *,
    skip: bool,
    remove: bool = False,
    seen: Seen | None = None,
) -> ImportPlan:
    """Import a class list as `plan_import` reads it; return what that did.

    `skip`: import the other rows if some are wrong. `remove`: take students who are not in the list out of the
    course. `seen`: the plan that the caller had looked at; None: whatever it is.

    Raises RefusedError: as `plan_import`; rows are wrong and shall not be skipped; or the plan has changed.
    """
    plan = plan_import(services, caller, content)
    if seen is not None and not seen.includes(plan.tag):
        raise RefusedError("changed_meanwhile")
    course, actor = taught_course(caller), caller.signature
    try:
        entries = plan.roster.entries if skip else plan.roster.checked()
        change = services.courses.import_roster(course, entries, actor)
        if remove and change.gone:
            services.courses.remove(course, [member.id for member in change.gone], actor)
    except CourseError as error:
        raise RefusedError("invalid_roster", error.text, field="file") from None
    return ImportPlan(roster=plan.roster, change=change)


def add_member(services: Services, caller: Caller, entry: RosterEntry) -> Member:
    """Add somebody who is not in the course; return the member.

    Raises as `set_member`, or there is such a member.
    """
    course = taught_course(caller)
    if services.courses.member(course, entry.id) is not None:
        reason = Text(
            zh=f"已经有成员 {entry.id}：要修改，请打开这个人的页面。",
            en=f"There is a member {entry.id} already; to change what is known of them, open their page.",
        )
        raise RefusedError("invalid_roster", reason, field="person")
    return set_member(services, caller, entry)


def set_member(services: Services, caller: Caller, entry: RosterEntry) -> Member:
    """Add somebody to the course, or change what `entry` says of them; return the member.

    Raises RefusedError: the caller is no instructor, there is no course, or `entry` does not fit.
    """
    course = taught_course(caller)
    try:
        services.courses.import_roster(course, [checked_entry(entry)], caller.signature)
    except CourseError as error:
        raise _refused(error) from None
    return member_of(services, caller, entry.id)


def renumber(services: Services, caller: Caller, person: str, new: str, reason: str) -> None:
    """Give a student another id, under which everything of theirs stays.

    Raises RefusedError: the caller is no instructor, there is no such student, or the id is taken or none.
    """
    require_instructor(caller)
    member_of(services, caller, person)
    try:
        services.course_life.renumber(person, new.strip(), services.signature(caller), reason)
    except CourseError as error:
        raise _refused(error) from None


def remove_member(services: Services, caller: Caller, person: str, reason: str) -> None:
    """Take somebody out of the course; what they handed in stays stored.

    Raises RefusedError: the caller is no instructor, there is no such member, or no instructor would be left.
    """
    member = member_of(services, caller, person)
    require_instructor(caller)
    try:
        services.courses.remove(member.course, [person], caller.signature, reason)
    except CourseError as error:
        raise _refused(error) from None


def give_token(services: Services, caller: Caller, person: str, days: int) -> str:
    """Make a token for a member, which is shown this once. Older ones work on.

    Assistants can do so for the students they look after: a lost slip must not wait for an instructor.

    Raises RefusedError: there is no such member, or it is no student and the caller no instructor.
    """
    member = member_of(services, caller, person)
    if member.role is not Role.STUDENT:
        require_instructor(caller)
    return services.tokens.issue(member.course, person, timedelta(days=days), caller.signature)[1]


def token_cells(member: Member, token: str) -> tuple[str, ...]:
    """Return a member's row in a table of tokens."""
    sections = ", ".join(member.sections)
    return member.id, member.name, member.role.value, sections, member.email, token


def without_token(services: Services, caller: Caller) -> list[Member]:
    """Return the members who have no token that works, in order of id.

    For instructors of a course.
    """
    course = taught_course(caller)
    served = services.tokens.holders(course)
    return [member for member in services.courses.members(course) if member.id not in served]


def give_tokens(
    services: Services, caller: Caller, days: int, *, section: str = "", everybody: bool = False
) -> list[tuple[Member, str]]:
    """Make tokens for members of a section, or of all, in order of id; older ones work on.

    For those who have none that works, or for `everybody`. For instructors of a course.
    """
    course = taught_course(caller)
    members = services.courses.members(course) if everybody else without_token(services, caller)
    chosen = [member for member in members if not section or section in member.sections]
    ids = [member.id for member in chosen]
    tokens = services.tokens.issue_all(course, ids, timedelta(days=days), caller.signature)
    return [(member, token) for member, (_, token) in zip(chosen, tokens, strict=True)]


def member_of(services: Services, caller: Caller, person: str) -> Member:
    """Return a member of the caller's course.

    Raises RefusedError: the caller may not see the class, or there is no such member.
    """
    require_staff(caller)
    member = None if caller.course is None else services.courses.member(caller.course, person)
    if member is None or (member.role is Role.STUDENT and not caller.looks_after(person)):
        raise RefusedError("member_not_found")
    return member


def _refused(error: CourseError) -> RefusedError:
    """Return the refusal; doors call a member's id `person`."""
    field = "person" if error.field == "id" else error.field
    return RefusedError("invalid_roster", error.text, field=field)


def changes(
    services: Services, caller: Caller, before: int | None, limit: int
) -> tuple[Sequence[AuditEntry], int | None]:
    """Return `limit` changes older than the id `before`, newest first, and the `before` of the next page.

    For instructors.
    """
    require_instructor(caller)
    entries = services.audit.entries(caller.course, limit + 1, before)
    page = entries[:limit]
    return page, page[-1].id if len(entries) > limit else None


def names(services: Services, caller: Caller) -> dict[str, str]:
    """Return id and name of every student of the course, in order of id; nobody while there is no course.

    For staff.
    """
    return {member.id: member.name for member in members(services, caller, Role.STUDENT)}


def named(names: Mapping[str, str], student: str) -> str:
    """Return a student's name if there is one that says more than the id, else nothing."""
    name = names.get(student, "")
    return "" if name == student else name


def person(names: Mapping[str, str], student: str) -> str:
    """Return a student's id with the name behind it, if there is one that says more."""
    return f"{student} {named(names, student)}".rstrip()
