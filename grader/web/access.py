"""Who looks at a page, and what they may see. The only place of the pages that knows.

Until submissions are tied to identities, a student says their id and is believed, as on the JSON interface; an
instructor shows the token, which the browser then keeps for as long as it is open.
"""

from dataclasses import dataclass
from typing import Annotated
from urllib.parse import urlencode

from fastapi import Depends, Request, Response
from fastapi.responses import RedirectResponse

from grader.contracts.submission import Submission
from grader.routes.access import InstructorGate
from grader.routes.problems import ProblemError
from grader.routes.uploads import checked_student
from grader.web.forms import set_private_cookie

STUDENT_COOKIE = "grader_student"
INSTRUCTOR_COOKIE = "grader_instructor"
ENTER = "/enter"


@dataclass(frozen=True, slots=True, kw_only=True)
class Visitor:
    """Somebody at a browser: a student (`student` is their id), an instructor, both or neither."""

    student: str | None
    instructor: bool


class EnterFirstError(Exception):
    """The page shows something personal, and nobody has said who they are."""


def visitor_of(request: Request) -> Visitor:
    """Return who sends `request`, by its cookies."""
    gate: InstructorGate = request.app.state.services.gate
    token = request.cookies.get(INSTRUCTOR_COOKIE)
    return Visitor(
        student=_student(request.cookies.get(STUDENT_COOKIE)),
        instructor=token is not None and gate.admits(token),
    )


VisitorDep = Annotated[Visitor, Depends(visitor_of)]


def require_instructor(visitor: VisitorDep) -> None:
    """Dependency of the class's pages.

    Raises:
        EnterFirstError: the visitor is no instructor.
    """
    if not visitor.instructor:
        raise EnterFirstError


def require_student(visitor: Visitor) -> str:
    """Return the student's id.

    Raises:
        EnterFirstError: the visitor has not said who they are.
    """
    if visitor.student is None:
        raise EnterFirstError
    return visitor.student


def require_known(visitor: Visitor) -> None:
    """Ask for the visitor's name before anything is looked up.

    Raises:
        EnterFirstError: the visitor has not said who they are.
    """
    if visitor.student is None and not visitor.instructor:
        raise EnterFirstError


def require_sight(visitor: Visitor, submission: Submission) -> None:
    """Let instructors and the student who handed it in see a submission.

    Raises:
        ProblemError: the submission is somebody else's; it is not even admitted to exist.
    """
    if not (visitor.instructor or visitor.student == submission.student):
        raise ProblemError("submission_not_found")


def enter_student(request: Request, response: Response, student: str) -> None:
    """Remember the student on this browser.

    Raises:
        ProblemError: it is no student id.
    """
    set_private_cookie(request, response, STUDENT_COOKIE, checked_student(student))


def enter_instructor(request: Request, response: Response, token: str) -> bool:
    """Remember the instructor on this browser; False, and nothing changed, when the token is wrong."""
    gate: InstructorGate = request.app.state.services.gate
    if not gate.admits(token):
        return False
    set_private_cookie(request, response, INSTRUCTOR_COOKIE, token)
    return True


def leave(response: Response) -> None:
    """Forget who used this browser."""
    for name in (STUDENT_COOKIE, INSTRUCTOR_COOKIE):
        response.delete_cookie(name, httponly=True, samesite="strict")


def ask_to_enter(request: Request) -> RedirectResponse:
    """Return the way to the page that asks who it is, and back to where they were going."""
    wanted = f"{request.url.path}?{request.url.query}" if request.url.query else request.url.path
    return RedirectResponse(f"{ENTER}?{urlencode({'next': wanted})}", status_code=303)


def _student(cookie: str | None) -> str | None:
    try:
        return None if cookie is None else checked_student(cookie)
    except ProblemError:
        return None
