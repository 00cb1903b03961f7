"""The rules of assignments: instructors change them, and give single students more."""

from grader.contracts.errors import ChangedMeanwhileError, CourseError, RefusedError
from grader.contracts.identity import Caller, Seen
from grader.contracts.rules import Extension, Rules
from grader.contracts.text import Text
from grader.store.rules import ANY_STATE, CourseRules
from grader.use_cases.assignments import require_published
from grader.use_cases.callers import require_instructor, require_staff
from grader.use_cases.services import Services


def course_rules(services: Services, caller: Caller, assignment_id: str) -> CourseRules:
    """Return the rules of the caller's course, to change those of one assignment.

    Raises RefusedError: the caller is no instructor, there is no course, or the assignment is not published.
    """
    require_instructor(caller)
    require_published(services, caller, assignment_id)
    if caller.course is None:
        raise RefusedError("no_course")
    return services.rules.of(caller.course)


def change_rules(  # noqa: PLR0913
    services: Services,
    caller: Caller,
    assignment_id: str,
    rules: Rules,
    reason: str,
    *,
    seen: Seen | None,
) -> None:
    """Put new rules in place of the old ones. They hold for what was handed in before, too.

    `reason` goes into the audit log. `seen`: the rules that the caller had looked at; None: whatever they are.

    Raises RefusedError: as `course_rules`; or a hidden item does not exist, or somebody else changed the rules.
    """
    course_rules(services, caller, assignment_id)
    items = [item.id for item in services.assignments.of(caller.course).get(assignment_id).items]
    unknown = set(rules.hidden_items) - set(items)
    if unknown:
        detail = Text(zh=f"没有这个评分项：{min(unknown)}。", en=f"There is no rubric item {min(unknown)}.")
        raise RefusedError("invalid_rules", detail, field="hidden_items", allowed=items)
    try:
        services.rules.set(assignment_id, rules, services.signature(caller), reason, seen=seen or ANY_STATE)
    except ChangedMeanwhileError:
        raise RefusedError("changed_meanwhile") from None


def extensions(services: Services, caller: Caller, assignment_id: str) -> list[tuple[str, Extension]]:
    """Return who got more for an assignment, and what, in order of student.

    Raises RefusedError: the caller may not see the class, or the assignment is not published.
    """
    require_staff(caller)
    require_published(services, caller, assignment_id)
    extended = services.rules.of(caller.course).extended(assignment_id)
    return [(student, one) for student, one in extended if caller.looks_after(student)]


def extend(  # noqa: PLR0913, PLR0917
    services: Services,
    caller: Caller,
    assignment_id: str,
    student: str,
    extension: Extension,
    reason: str,
    *,
    seen: Seen | None,
) -> None:
    """Put an extension in place of what a student and the student's team had; an empty one takes it back.

    Raises as `course_rules`; or there is no such student, or somebody else changed what they have.
    """
    course_rules(services, caller, assignment_id)
    signed = services.signature(caller)
    team = services.teams.of_student(caller.course, assignment_id, student)
    try:
        services.rules.extend(assignment_id, student, extension, signed, reason, seen=seen or ANY_STATE)
        for mate in () if team is None else team.members:
            services.rules.extend(assignment_id, mate, extension, signed, reason)
    except ChangedMeanwhileError:
        raise RefusedError("changed_meanwhile") from None
    except CourseError:
        raise RefusedError("unknown_student", field="student") from None
