"""Who the class is, for its pages: everybody of the roster, also those who handed in nothing."""

from collections.abc import Mapping

from grader.contracts.identity import Caller, Role
from grader.use_cases.services import Services


def names(services: Services, caller: Caller) -> dict[str, str]:
    """Return id and name of every student of the course, in order of id; nobody while there is no course."""
    return {member.id: member.name for member in services.courses.members(caller.course, Role.STUDENT)}


def named(known: Mapping[str, str], student: str) -> str:
    """Return a student's name if there is one that says more than the id, else nothing."""
    name = known.get(student, "")
    return "" if name == student else name


def person(known: Mapping[str, str], student: str) -> str:
    """Return a student's id with the name behind it, if there is one that says more."""
    return f"{student} {named(known, student)}".rstrip()
