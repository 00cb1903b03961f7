"""A sentence of the teacher's that every student with a certain mistake reads above the hint."""

from grader.contracts.errors import RefusedError
from grader.contracts.identity import Caller
from grader.contracts.judgement import judged
from grader.contracts.text import Text
from grader.use_cases.assignments import require_published
from grader.use_cases.callers import require_instructor, require_staff
from grader.use_cases.concerned import Concern, concerned
from grader.use_cases.services import Services
from grader.use_cases.submissions import ShownSubmission

LONGEST_PINNED = 500
_LENGTH = Text(zh=f"最多 {LONGEST_PINNED} 个字符。", en=f"At most {LONGEST_PINNED} characters.")


def pinned(services: Services, caller: Caller, assignment_id: str) -> dict[str, str]:
    """Return what is pinned at an assignment, by the code of the mistake. For staff.

    Raises RefusedError: the caller may not see the class, or the assignment is not published.
    """
    require_staff(caller)
    require_published(services, caller, assignment_id)
    return services.pinned.of(caller.course, assignment_id)


def pin(services: Services, caller: Caller, assignment_id: str, mistake: str, text: str) -> None:
    """Pin a text to a mistake in place of what was there; an empty one takes it away.

    Raises:
        RefusedError: the caller is no instructor of a course; there is no such assignment or mistake; or the text
            is too long.
    """
    require_instructor(caller)
    require_published(services, caller, assignment_id)
    if caller.course is None:
        raise RefusedError("no_course")
    concerned(services, caller, assignment_id, Concern(mistake=mistake))
    plain = " ".join(text.split())
    if len(plain) > LONGEST_PINNED:
        raise RefusedError("invalid_request", _LENGTH, field="text")
    services.pinned.pin(assignment_id, mistake, plain, services.signature(caller))


def pinned_to(services: Services, shown: ShownSubmission) -> tuple[str, ...]:
    """Return what is pinned to the mistakes that the caller is told of in a submission."""
    if shown.grading is None or shown.told is None:
        return ()
    texts = services.pinned.of(shown.submission.course, shown.submission.assignment)
    if not texts:
        return ()
    codes = {*judged(shown.grading).mistakes, *shown.told.report.mistakes}
    return tuple(text for code, text in texts.items() if code in codes)
