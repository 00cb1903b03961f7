"""Published assignments: what one caller sees of them, and which dates and attempts hold for that caller."""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime
from zoneinfo import ZoneInfo

from grader.contracts.assignment import Assignment
from grader.contracts.errors import RefusedError, UnknownAssignmentError
from grader.contracts.identity import Caller, Role
from grader.contracts.rules import NO_EXTENSION, Attempt, Counted, Extension, Refusal, Rules, Shown
from grader.contracts.text import Language
from grader.store.intake import as_attempts
from grader.store.rules import CourseRules
from grader.use_cases.services import Services
from grader.use_cases.visibility import shown_assignment, shown_assignments


@dataclass(frozen=True, slots=True, kw_only=True)
class Terms:
    """The rules of one assignment as they hold for one member of a course now.

    Attributes:
        due: the due date, with the member's extension.
        attempts_left: None: any number.
        counted: the attempt that counts; None while there is none, or while it would tell about hidden items.
        refusal: why the rules would refuse a file from this student now; None: they would take it.
        kept_share: the share of its points that a file handed in now would keep, after lateness.
        hides: whether some items are hidden from students now.
    """

    rules: Rules
    zone: ZoneInfo
    due: datetime | None
    attempts_used: int
    attempts_left: int | None
    counted: Counted | None
    refusal: Refusal | None
    kept_share: float
    hides: bool


def published(services: Services, caller: Caller, assignment_id: str) -> Assignment | None:
    """Return an assignment of the caller's course; None when it is not, or no longer, published."""
    try:
        return services.assignments.of(caller.course).get(assignment_id)
    except UnknownAssignmentError:
        return None


def is_own(services: Services, course: str | None, assignment_id: str) -> bool:
    """Return whether a published assignment is one of its course's own."""
    if course is None:
        return False
    try:
        services.assignments.of(None).get(assignment_id)
    except UnknownAssignmentError:
        return True
    return False


def require_published(
    services: Services,
    caller: Caller,
    assignment_id: str,
    code: str = "assignment_not_found",
    field: str | None = None,
) -> Assignment:
    """Return an assignment with all its items.

    Raises:
        RefusedError: the assignment is not published, or a draft, and the caller a student. The error has `code`
            and `field`, and lists what the caller sees.
    """
    assignment = published(services, caller, assignment_id)
    if assignment is None or _is_draft_to(services, caller, assignment_id):
        raise RefusedError(code, field=field, allowed=[one.id for one in checklist(services, caller)])
    return assignment


def _is_draft_to(services: Services, caller: Caller, assignment_id: str) -> bool:
    """Whether the caller is a student from whom a draft is hidden, its name as well."""
    if caller.role is not Role.STUDENT:
        return False
    return services.rules.of(caller.course).of(assignment_id).shown is Shown.DRAFT


def visible_assignment(services: Services, caller: Caller, assignment_id: str) -> Assignment:
    """Return a published assignment, without the items that the caller does not see now.

    Raises RefusedError: it is not published, or the caller does not see it now.
    """
    assignment = require_published(services, caller, assignment_id)
    if caller.role is Role.STUDENT:
        rules = services.rules.of(caller.course).of(assignment_id)
        if not rules.shown_at(services.clock()):
            raise RefusedError("assignment_not_found")
    return shown_assignment(services, caller, assignment)


def checklist(services: Services, caller: Caller) -> tuple[Assignment, ...]:
    """Return the published assignments that the caller sees now, without the items hidden from the caller."""
    course_rules, now = services.rules.of(caller.course), services.clock()
    is_student = caller.role is Role.STUDENT
    every = services.assignments.of(caller.course).all()
    visible = [
        assignment for assignment in every if not is_student or course_rules.of(assignment.id).shown_at(now)
    ]
    return shown_assignments(services, caller, visible)


def in_course(services: Services, caller: Caller) -> tuple[Assignment, ...]:
    """Return the assignments of the caller's course, except drafts, with all their items."""
    course_rules = services.rules.of(caller.course)
    every = services.assignments.of(caller.course).all()
    return tuple(
        assignment for assignment in every if course_rules.of(assignment.id).shown is not Shown.DRAFT
    )


def terms_of(services: Services, caller: Caller, assignment_id: str) -> Terms:
    """Return the rules of an assignment as they hold for the caller; without courses, the default ones."""
    person = caller.person
    attempts = () if person is None else services.intake.attempts(person, assignment_id, caller.course)
    return _terms(services.rules.of(caller.course), caller, assignment_id, attempts, services.clock())


def all_terms(services: Services, caller: Caller) -> dict[str, Terms]:
    """Return the terms of each published assignment for a member of a course; none without courses."""
    if caller.course is None:
        return {}
    course_rules, now = services.rules.of(caller.course), services.clock()
    submissions = (
        () if caller.person is None else services.submissions.of_student(caller.person, course=caller.course)
    )
    # In order of arrival, as `submissions.attempts` has those of one assignment.
    attempts = as_attempts(
        sorted(submissions, key=lambda submission: (submission.received_at, submission.id))
    )
    assignment_of = {submission.id: submission.assignment for submission in submissions}
    return {
        assignment.id: _terms(
            course_rules,
            caller,
            assignment.id,
            [attempt for attempt in attempts if assignment_of[attempt.id] == assignment.id],
            now,
        )
        for assignment in services.assignments.of(caller.course).all()
    }


def _terms(
    course_rules: CourseRules, caller: Caller, assignment_id: str, attempts: Sequence[Attempt], now: datetime
) -> Terms:
    is_student, person = caller.role is Role.STUDENT, caller.person
    rules = course_rules.of(assignment_id, person if is_student else None)
    extension = NO_EXTENSION if person is None else course_rules.extension(assignment_id, person)
    hides = bool(rules.hidden_at(now))
    return Terms(
        rules=rules,
        zone=course_rules.zone,
        due=rules.due_for(extension),
        attempts_used=sum(attempt.costs for attempt in attempts),
        attempts_left=rules.attempts_left(extension, attempts),
        counted=None if is_student and hides else rules.counting(extension, attempts),
        refusal=_refusal(course_rules, rules, extension, attempts, now) if is_student else None,
        kept_share=rules.kept_share(extension, now),
        hides=hides,
    )


def _refusal(
    course_rules: CourseRules, rules: Rules, extension: Extension, attempts: Sequence[Attempt], now: datetime
) -> Refusal | None:
    if course_rules.archived:
        return Refusal(code="course_archived")
    return rules.refusal(extension, attempts, now, course_rules.zone)


def item_title(assignment: Assignment | None, item_id: str, language: Language) -> str:
    """Return the title of a rubric item; its id when the assignment is not known."""
    return item_id if assignment is None else assignment.item_title(item_id, language)
