"""Errors for browsers: failures as pages, refusals beside the form. Other clients get problem documents."""

import json
from collections.abc import Awaitable, Callable
from dataclasses import dataclass
from typing import Any, cast

from fastapi import FastAPI, Request, Response

from grader.contracts.errors import RefusedError
from grader.contracts.text import Language
from grader.service.routes.problems import PROBLEM_TYPES
from grader.service.web.access import EnterFirstError, ask_to_enter, language_of
from grader.service.web.pages import keep_language, page

_Handler = Callable[[Request, Exception], Awaitable[Response]]
_MACHINES = ("/api/", "/healthz")
FRAMES = ("iframe", "frame")
"""What a browser says it fetches for (``Sec-Fetch-Dest``) where a page is to stand inside another one."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FormProblem:
    """Why something was refused, in the visitor's language: what a form shows.

    Attributes:
        field: which field of the form is wrong; empty: none in particular.
        fix: what to do about it. line, text: the line of the file that is wrong.
    """

    code: str
    status: int
    title: str
    fix: str
    detail: str | None
    field: str
    line: int | None
    text: str | None


def form_problem(error: RefusedError, language: Language, field: str = "") -> FormProblem:
    """Return what a form says about a refusal, which is about `field` unless it names another."""
    kind = PROBLEM_TYPES[error.code]
    return FormProblem(
        code=error.code,
        status=kind.status,
        title=kind.title.get(language),
        fix=kind.fix.get(language),
        detail=None if error.detail is None else error.detail.get(language),
        field=error.members.get("field") or field,
        line=error.members.get("line"),
        text=error.members.get("text"),
    )


def install(app: FastAPI) -> None:
    """Wrap every handler that `app` has so far; to be called after those are installed."""
    for kind, handler in list(app.exception_handlers.items()):
        if isinstance(kind, type):
            app.add_exception_handler(kind, _for_people(cast(_Handler, handler)))
    app.add_exception_handler(EnterFirstError, _on_enter_first)


def _for_people(handler: _Handler) -> _Handler:
    async def answer(request: Request, error: Exception) -> Response:
        if not _is_person(request):
            return await handler(request, error)
        language = language_of(request).encode()
        headers = [header for header in request.scope["headers"] if header[0] != b"accept-language"]
        spoken = Request({**request.scope, "headers": [*headers, (b"accept-language", language)]})
        said = await handler(spoken, error)
        problem: dict[str, Any] = json.loads(bytes(said.body))
        framed = request.headers.get("sec-fetch-dest") in FRAMES and request.url.path.startswith("/lti/")
        shown = page(request, "problem.html", status=said.status_code, problem=problem, framed=framed)
        if framed:  # nothing can be done on it, and the platform may be one that we do not know
            policy = shown.headers["Content-Security-Policy"]
            everybody = policy.replace("frame-ancestors 'none'", "frame-ancestors https: http:")
            shown.headers["Content-Security-Policy"] = everybody
        for name in ("retry-after", "allow", "connection"):
            if name in said.headers:
                shown.headers[name] = said.headers[name]
        return shown

    return answer


def _is_person(request: Request) -> bool:
    """Whether a browser asks for a page; its scripts and other programs do not name text/html."""
    wants_page = "text/html" in request.headers.get("accept", "").lower()
    return wants_page and not request.url.path.startswith(_MACHINES)


async def _on_enter_first(request: Request, error: Exception) -> Response:
    answer = ask_to_enter(request)
    keep_language(request, answer)
    return answer
