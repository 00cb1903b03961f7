"""Who is in the course, and what was changed by whom."""

from collections.abc import Mapping, Sequence

from grader.contracts.identity import AuditEntry, Caller, Course, Member, Role
from grader.use_cases.callers import require_instructor, require_staff
from grader.use_cases.services import Services


def myself(services: Services, caller: Caller) -> tuple[Course | None, Member | None]:
    """Return the caller's course and the caller as its member; None while nobody's identity is known."""
    if caller.course is None or caller.person is None:
        return None, None
    return services.courses.get(caller.course), services.courses.member(caller.course, caller.person)


def members(services: Services, caller: Caller, role: Role | None = None) -> Sequence[Member]:
    """Return who is in the caller's course, of one role or of all; nobody while there are no courses.

    Raises:
        RefusedError: the caller may not see the class.
    """
    require_staff(caller)
    return services.courses.members(caller.course, role)


def changes(
    services: Services, caller: Caller, before: int | None, limit: int
) -> tuple[Sequence[AuditEntry], int | None]:
    """Return `limit` changes older than the id `before`, newest first, and the `before` of the next page.

    Raises:
        RefusedError: the caller is no instructor.
    """
    require_instructor(caller)
    entries = services.audit.entries(caller.course, limit + 1, before)
    page = entries[:limit]
    return page, page[-1].id if len(entries) > limit else None


def names(services: Services, caller: Caller) -> dict[str, str]:
    """Return id and name of every student of the course, in order of id; nobody while there is no course.

    Raises:
        RefusedError: the caller may not see the class.
    """
    return {member.id: member.name for member in members(services, caller, Role.STUDENT)}


def named(known: Mapping[str, str], student: str) -> str:
    """Return a student's name if there is one that says more than the id, else nothing."""
    name = known.get(student, "")
    return "" if name == student else name


def person(known: Mapping[str, str], student: str) -> str:
    """Return a student's id with the name behind it, if there is one that says more."""
    return f"{student} {named(known, student)}".rstrip()
