"""Who looks at a page, in which language, and what they may see. No other module of the pages decides that.

The browser keeps the session that a bearer token opened (`grader.use_cases.callers`), in a cookie that lasts as
long as the browser is open. While the service has no courses, a student says their id and is believed, as on
the JSON interface.
"""

from collections.abc import AsyncIterator
from dataclasses import dataclass
from typing import Annotated, Any
from urllib.parse import urlencode

from fastapi import Depends, Request, Response
from fastapi.responses import RedirectResponse

from grader.contracts.errors import RefusedError
from grader.contracts.identity import ANYBODY, Caller, is_person_id
from grader.contracts.submission import StoredReport, Submission
from grader.contracts.text import LANGUAGES, Language
from grader.service.requests.dependencies import (
    PEER,
    SESSION_COOKIE,
    AssignmentId,
    Errand,
    QueryWhole,
    RegradeId,
    ServicesDep,
    SubmissionId,
    address_of,
    under_way,
)
from grader.service.web.forms import set_private_cookie
from grader.use_cases.callers import PLOT_WEIGHT
from grader.use_cases.handing_in import checked_student
from grader.use_cases.services import Services
from grader.use_cases.visibility import found, visible_submission

# What pages read of a request as the JSON interface does.
__all__ = (
    "PEER",
    "SESSION_COOKIE",
    "AssignmentId",
    "QueryWhole",
    "RegradeId",
    "ServicesDep",
    "SubmissionId",
)
STUDENT_COOKIE = "grader_student"
LANGUAGE_COOKIE = "grader_language"
ENTER = "/enter"


@dataclass(frozen=True, slots=True, kw_only=True)
class Visitor:
    """Somebody at a browser.

    Attributes:
        caller: who it is to the rest of the service.
        student: whose attempts are their own: the member's id, or without courses what the visitor said.
        open: the service has no courses, so that a student only says an id.
        course: title of the visitor's course. zone: its IANA time zone, on whose clock every page is. None
            without one.
        archived: the course can only be read. name: of the member that the visitor is; else empty.
    """

    caller: Caller
    student: str | None
    open: bool
    course: str | None
    zone: str | None
    archived: bool = False
    name: str = ""

    @property
    def staff(self) -> bool:
        """Whether the visitor may see the class."""
        return self.caller.is_staff

    @property
    def known(self) -> bool:
        """Whether the visitor has said who they are."""
        return self.staff or self.student is not None


@dataclass(frozen=True, slots=True)
class PageErrand(Errand):
    """What a visitor of a page asks for."""

    request: Request
    visitor: Visitor

    @property
    def language(self) -> Language:
        """Return the language to answer in."""
        return language_of(self.request)


def language_of(request: Request) -> Language:
    """Return the language of a page: ``?lang=``, else the one chosen before, else the service's default."""
    for asked in (request.query_params.get("lang"), request.cookies.get(LANGUAGE_COOKIE)):
        for language in LANGUAGES:
            if asked == language:
                return language
    default: Language = request.app.state.default_language
    return default


class EnterFirstError(Exception):
    """The page shows something personal, and the visitor has not said who they are."""


def visitor_of(request: Request) -> Visitor:
    """Return who sends `request`, by its cookies. Looked up once per request."""
    known: Visitor | None = getattr(request.state, "visitor", None)
    if known is None:
        known = request.state.visitor = _visitor(request)
    return known


def _identified(request: Request) -> Visitor:
    visitor = visitor_of(request)
    services_of(request).allowances.request(visitor.caller)
    return visitor


async def present(
    request: Request, visitor: Annotated[Visitor, Depends(_identified)]
) -> AsyncIterator[PageErrand]:
    """Dependency of every page: what a visitor asks for.

    Raises RefusedError: a student of a course asks too often, or somebody for too much at once.
    """
    services = services_of(request)
    with under_way(request, services, visitor.caller):
        yield PageErrand(services, visitor.caller, request, visitor)


ErrandDep = Annotated[PageErrand, Depends(present)]


def _costly(weight: int) -> Any:
    async def counted(errand: ErrandDep) -> AsyncIterator[None]:
        otherwise = f"visitor {errand.visitor.student}"
        with errand.services.allowances.costly.one_more(errand.caller, otherwise, weight):
            yield

    return Depends(counted)


COSTLY, DRAWN = _costly(1), _costly(PLOT_WEIGHT)
"""Of pages that take time to make, and of plots: a student has few under way, and few in a minute."""


async def require_staff(errand: ErrandDep) -> PageErrand:
    """Dependency of the class's pages.

    Raises:
        EnterFirstError: nobody has said who they are.
        RefusedError: the visitor is a student.
    """
    if not errand.visitor.staff:
        if errand.caller.role is None:
            raise EnterFirstError
        raise RefusedError("forbidden")
    return errand


StaffDep = Annotated[PageErrand, Depends(require_staff)]


async def require_instructor(errand: StaffDep) -> PageErrand:
    """Dependency of pages and forms that show or change what only instructors may.

    Raises RefusedError: the visitor is an assistant.
    """
    if not errand.caller.is_instructor:
        raise RefusedError("forbidden")
    return errand


InstructorDep = Annotated[PageErrand, Depends(require_instructor)]


async def require_known(errand: ErrandDep) -> PageErrand:
    """Dependency of what is personal: the visitor is asked for their name before anything is looked up.

    Raises EnterFirstError: the visitor has not said who they are.
    """
    if not errand.visitor.known:
        raise EnterFirstError
    return errand


KnownDep = Annotated[PageErrand, Depends(require_known)]


async def require_member(errand: ErrandDep) -> PageErrand:
    """Dependency of what rules show or hide: where there are courses, the visitor is asked for their name.

    Raises EnterFirstError: there are courses, and the visitor has not said who they are.
    """
    return errand if errand.visitor.open else await require_known(errand)


MemberDep = Annotated[PageErrand, Depends(require_member)]


def seen(errand: PageErrand, submission_id: str) -> tuple[Submission, StoredReport | None]:
    """Return a submission and its grading, if there is one yet, to somebody who may see it.

    Raises RefusedError: there is none of that id, or it is somebody else's: the visitor cannot tell which.
    """
    submission, stored = found(errand.services, errand.caller, submission_id)
    require_own(errand.visitor, submission)
    return submission, stored


def require_sight(errand: PageErrand, submission_id: str) -> Submission:
    """Return a submission, without its grading, to somebody who may see it. Raises as `seen`."""
    submission = visible_submission(errand.services, errand.caller, submission_id)
    require_own(errand.visitor, submission)
    return submission


def require_own(visitor: Visitor, submission: Submission) -> None:
    """Make sure that a student sees only their own submissions, also without courses, where an id opens any.

    Raises RefusedError: it is somebody else's; the same refusal as when there is none.
    """
    if not (visitor.staff or visitor.student == submission.student):
        raise RefusedError("submission_not_found")


def enter_student(request: Request, response: Response, student: str) -> None:
    """Remember on this browser who a visitor of a service without courses says to be.

    Raises:
        RefusedError: it is no student id.
        EnterFirstError: in a course, saying so is not enough.
    """
    if not visitor_of(request).open:
        raise EnterFirstError
    set_private_cookie(request, response, STUDENT_COOKIE, checked_student(student))


def enter_by_token(request: Request, response: Response, token: str) -> Caller | None:
    """Open a session on this browser by a token and return whose it is; a token of nobody opens none.

    Raises RefusedError: a student asks too often, or too many wrong tokens were shown.
    """
    services = services_of(request)
    caller = services.callers.identify(token, address_of(request))
    if caller is None:
        return None
    services.allowances.request(caller)
    session = services.callers.open_session(token)
    if session is None:
        return None
    set_private_cookie(request, response, SESSION_COOKIE, session)
    return caller


def leave(request: Request, response: Response) -> None:
    """Forget who used this browser."""
    session = request.cookies.get(SESSION_COOKIE)
    if session is not None:
        services_of(request).callers.close_session(session)
    for name in (STUDENT_COOKIE, SESSION_COOKIE):
        response.delete_cookie(name, httponly=True, samesite="strict")


def ask_to_enter(request: Request) -> RedirectResponse:
    """Return the way to the page that asks who it is, and back to where they were going."""
    wanted = f"{request.url.path}?{request.url.query}" if request.url.query else request.url.path
    return RedirectResponse(f"{ENTER}?{urlencode({'next': wanted})}", status_code=303)


def _visitor(request: Request) -> Visitor:
    services = services_of(request)
    is_open = services.callers.identify(None) is not None
    session = request.cookies.get(SESSION_COOKIE)
    caller = ANYBODY if session is None else services.callers.of_session(session) or ANYBODY
    said = request.cookies.get(STUDENT_COOKIE, "")
    student = said if is_open and is_person_id(said) else caller.person
    if caller.course is None:
        return Visitor(caller=caller, student=student, open=is_open, course=None, zone=None)
    course = services.courses.get(caller.course)
    member = None if caller.person is None else services.courses.member(caller.course, caller.person)
    return Visitor(
        caller=caller,
        student=student,
        open=is_open,
        course=course.title,
        zone=course.time_zone,
        archived=course.archived_at is not None,
        name="" if member is None else member.name,
    )


def services_of(request: Request) -> Services:
    """Return what use cases work with."""
    services: Services = request.app.state.services
    return services
