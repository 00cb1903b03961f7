"""Saying who one is, and leaving."""

from typing import Annotated, Literal

from fastapi import APIRouter, Form, Query, Request, Response
from fastapi.responses import RedirectResponse
from pydantic import BaseModel, Field

from grader.contracts.errors import RefusedError
from grader.messages import on_page
from grader.service.web import access
from grader.service.web.access import language_of
from grader.service.web.errors import form_problem
from grader.service.web.forms import OWN_FORM
from grader.service.web.pages import page

router = APIRouter(include_in_schema=False)
_LONGEST = 2_000


class EnterForm(BaseModel):
    """What somebody says about themselves: a token, or a student's id where that is enough; then where they go."""

    student: str = Field(default="", max_length=200)
    token: str = Field(default="", max_length=1_000)
    next: str = Field(default="", max_length=_LONGEST)


class Wrong(BaseModel):
    """Which field was not accepted, and what to do about it."""

    field: Literal["student", "token"]
    text: str


@router.get(access.ENTER)
def read(request: Request, next: Annotated[str, Query(max_length=_LONGEST)] = "") -> Response:
    """Ask who it is.

    A link on another site brings no session along: whoever follows one is led on once, as by a link of ours,
    before they are asked.
    """
    wanted = own_address(next)
    if wanted and request.headers.get("sec-fetch-site") == "cross-site":
        return page(request, "enter_back.html", next=wanted)
    return _ask(request, EnterForm(next=next))


@router.post(access.ENTER, dependencies=OWN_FORM)
def enter(request: Request, entry: Annotated[EnterForm, Form()]) -> Response:
    """Remember a student or an instructor on this browser and lead to where they wanted."""
    language = language_of(request)
    if entry.token:
        response = RedirectResponse("/", status_code=303)
        caller = access.enter_by_token(request, response, entry.token.strip())
        if caller is not None:
            home = "/class" if caller.is_staff else "/"
            response.headers["Location"] = own_address(entry.next) or home
            return response
        return _ask(request, entry, 403, Wrong(field="token", text=on_page(language, "enter.wrong_token")))
    response = RedirectResponse(own_address(entry.next) or "/submissions", status_code=303)
    try:
        access.enter_student(request, response, entry.student.strip())
    except RefusedError as problem:
        refused = form_problem(problem, language)
        return _ask(request, entry, refused.status, Wrong(field="student", text=refused.fix))
    return response


@router.post("/leave", dependencies=OWN_FORM)
def leave(request: Request) -> Response:
    """Forget who used this browser."""
    response = RedirectResponse("/", status_code=303)
    access.leave(request, response)
    return response


def own_address(path: str) -> str:
    """Return `path` if it leads to one of our own pages, or an empty string."""
    own = path.startswith("/") and not path.startswith("//") and "\\" not in path and path.isprintable()
    return path if own and path.isascii() else ""


def _ask(request: Request, entry: EnterForm, status: int = 200, wrong: Wrong | None = None) -> Response:
    wanted = own_address(entry.next)
    services, is_open = access.services_of(request), access.visitor_of(request).open
    return page(
        request,
        "enter.html",
        status=status,
        next=wanted,
        given=entry.student,
        refusal=wrong,
        providers=() if is_open else tuple(services.providers),
        by_platform=not is_open and services.platforms.exist(),
    )
