"""Published assignments."""

from grader.contracts.assignment import Assignment
from grader.contracts.errors import RefusedError, UnknownAssignmentError
from grader.contracts.text import Language
from grader.use_cases.services import Services


def published(services: Services, assignment_id: str) -> Assignment | None:
    """Return an assignment; None when it is not, or no longer, published."""
    try:
        return services.assignments.get(assignment_id)
    except UnknownAssignmentError:
        return None


def require_published(
    services: Services, assignment_id: str, code: str = "assignment_not_found", field: str | None = None
) -> Assignment:
    """Return an assignment.

    Raises:
        RefusedError: of the kind `code`, about `field` of the request: it is not published. Names those that are.
    """
    assignment = published(services, assignment_id)
    if assignment is None:
        raise RefusedError(code, field=field, allowed=[one.id for one in services.assignments.all()])
    return assignment


def item_title(assignment: Assignment | None, item_id: str, language: Language) -> str:
    """Return the title of a rubric item; its id when the assignment is not known."""
    return item_id if assignment is None else assignment.item_title(item_id, language)
