"""Problem documents (RFC 9457) for everything that goes wrong, in the reader's language.

A problem has a stable code. One table tells its status and headers; the messages have
``problem.<code>.title``, what it means, and ``problem.<code>.fix``, what the person who sees it can do.
"""

import json
import logging
import uuid
from collections.abc import Mapping
from dataclasses import dataclass, field
from http import HTTPStatus
from typing import Annotated, Any

from fastapi import APIRouter, FastAPI, Path, Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import JSONResponse
from pydantic import ConfigDict, Field
from starlette.exceptions import HTTPException as StarletteHTTPException
from starlette.routing import Match

from grader.contracts.errors import InfrastructureError, RefusedError
from grader.contracts.text import Language, Text
from grader.contracts.validation_words import said
from grader.messages import say
from grader.operation import logs
from grader.render.escape import visible, visible_line
from grader.service.requests.dependencies import LanguageDep, language_of
from grader.service.routes.views import View
from grader.use_cases.own_assignments import place_of

_log = logging.getLogger(__name__)
MEDIA_TYPE = "application/problem+json"
TYPE_PATH = "/api/v1/problems/"
_BY_STATUS = {
    400: "malformed_body",
    401: "unauthorized",
    403: "forbidden",
    404: "not_found",
    405: "method_not_allowed",
    413: "too_large",
    415: "unsupported_media_type",
    429: "too_many_requests",
    503: "unavailable",
}
_LONGEST_ECHO = 200
_RETRY_AFTER_S = 5
_METHODS = ("GET", "HEAD", "POST", "PUT", "PATCH", "DELETE")

router = APIRouter(prefix="/api/v1/problems", tags=["problems"])


@dataclass(frozen=True, slots=True)
class ProblemType:
    """One kind of problem.

    Attributes:
        status: HTTP's. headers: of every answer with this problem.
    """

    code: str
    status: int
    headers: Mapping[str, str] = field(default_factory=dict)

    @property
    def title(self) -> Text:
        """What it means, in a few words."""
        return say(f"problem.{self.code}.title")

    @property
    def fix(self) -> Text:
        """What the person who sees it can do."""
        return say(f"problem.{self.code}.fix")


_STATUS = {
    "malformed_body": 400,
    "unauthorized": 401,
    "not_open_yet": 403,
    "closed": 403,
    "no_attempts_left": 403,
    "no_attempts_today": 403,
    "appeals_closed": 403,
    "forbidden": 403,
    "foreign_form": 403,
    "not_found": 404,
    "submission_not_found": 404,
    "assignment_not_found": 404,
    "no_trajectory": 404,
    "regrade_not_found": 404,
    "appeal_not_found": 404,
    "item_not_found": 404,
    "problem_not_found": 404,
    "member_not_found": 404,
    "identity_not_found": 404,
    "platform_not_found": 404,
    "platform_tells_nobody": 409,
    "platform_people_refused": 502,
    "platform_unknown": 403,
    "picking_over": 410,
    "registration_over": 410,
    "not_a_registration": 422,
    "registration_failed": 409,
    "picking_by_instructors": 403,
    "nothing_picked": 422,
    "platform_differs": 409,
    "platform_exists": 409,
    "too_many_platforms": 409,
    "platforms_not_set_up": 409,
    "invalid_platform": 422,
    "webhook_not_found": 404,
    "invalid_webhook": 422,
    "mail_not_set_up": 409,
    "no_own_address": 409,
    "notice_not_taken": 502,
    "signin_refused": 403,
    "signin_failed": 403,
    "signin_expired": 403,
    "signin_other_course": 403,
    "signin_somebody_else": 403,
    "signin_unreachable": 503,
    "method_not_allowed": 405,
    "not_graded_yet": 409,
    "judged_meanwhile": 412,
    "changed_meanwhile": 412,
    "too_large": 413,
    "unsupported_media_type": 415,
    "wrong_file_type": 415,
    "invalid_request": 422,
    "invalid_points": 422,
    "points_unchanged": 422,
    "invalid_student": 422,
    "regrade_open": 409,
    "regrade_running": 409,
    "regrade_decided": 409,
    "regrade_not_applied": 409,
    "regrade_superseded": 409,
    "appeal_exists": 409,
    "appeal_decided": 409,
    "nothing_to_regrade": 422,
    "no_course": 409,
    "no_teams": 409,
    "team_not_found": 404,
    "false_receipt": 422,
    "team_full": 409,
    "team_fixed": 409,
    "only_students": 409,
    "not_the_same": 422,
    "course_archived": 409,
    "invalid_course": 422,
    "no_scripts": 409,
    "invalid_assignment": 422,
    "assignment_in_use": 409,
    "too_many_assignments": 409,
    "invalid_rules": 422,
    "invalid_roster": 422,
    "invalid_sheet": 422,
    "unknown_student": 422,
    "unknown_assignment": 422,
    "empty": 422,
    "not_utf8": 422,
    "contains_nul": 422,
    "bad_archive": 422,
    "no_package": 422,
    "syntax_error": 422,
    "key_reused": 422,
    "too_many_open": 429,
    "too_many_requests": 429,
    "too_many_at_once": 429,
    "too_many_streams": 429,
    "streams_full": 503,
    "live_off": 503,
    "live_full": 503,
    "live_not_found": 404,
    "practice_off": 503,
    "practice_full": 503,
    "practice_waits": 503,
    "practice_scripts_only": 409,
    "bags_not_installed": 501,
    "internal_error": 500,
    "unavailable": 503,
    "refused": 400,
}
_HEADERS = {
    "unauthorized": {"WWW-Authenticate": 'Bearer realm="grader"'},
    "unsupported_media_type": {"Accept": "multipart/form-data"},
}
PROBLEM_TYPES: Mapping[str, ProblemType] = {
    code: ProblemType(code, status, _HEADERS.get(code, {})) for code, status in _STATUS.items()
}


class FieldError(View):
    """One field that was not accepted."""

    field: str = Field(description="Where it stands: `query.lang`, `student`, ...", examples=["student"])
    detail: str = Field(description="What is wrong with it.", examples=["This field is missing."])


class Problem(View):
    """A problem document (RFC 9457). Members without a value are left out."""

    model_config = ConfigDict(
        json_schema_extra={
            "examples": [
                {
                    "type": "/api/v1/problems/syntax_error",
                    "title": "This is not valid Python",
                    "status": 422,
                    "detail": "Line 12 has a syntax error ('(' was never closed), so nothing ran. …",
                    "instance": "urn:uuid:0197c2f0-8a1b-7c3d-9e4f-5a6b7c8d9e0f",
                    "code": "syntax_error",
                    "field": "file",
                    "fix": "Correct that line (look at the one above, too), run it at home, then upload it.",
                    "line": 12,
                    "column": 21,
                    "text": "        self.publish(",
                }
            ]
        }
    )

    type: str = Field(description="Address that explains this kind of problem.")
    title: str = Field(description="This kind of problem in a few words.")
    status: int = Field(description="HTTP status.")
    detail: str = Field(description="What happened this time.")
    instance: str = Field(description="Names this occurrence, also in the log of the service.")
    request_id: str | None = Field(
        default=None, description="Of the request, as in the header X-Request-ID and in the log."
    )
    code: str = Field(description="Stable name of this kind of problem.")
    fix: str = Field(description="What to do about it.")
    field: str | None = Field(default=None, description="The field of the request that is meant.")
    line: int | None = Field(default=None, description="Line of the uploaded file, from 1.")
    column: int | None = Field(default=None, description="Column in that line, from 1.")
    text: str | None = Field(
        default=None, description="That line, with invisible characters shown as escapes."
    )
    allowed: list[str] | None = Field(default=None, description="The values that would be accepted.")
    errors: list[FieldError] | None = Field(default=None, description="Every field that was not accepted.")


class ProblemTypeView(View):
    """One kind of problem."""

    code: str = Field(examples=["not_utf8"])
    status: int = Field(examples=[422])
    title: str = Field(examples=["The file is not UTF-8"])
    fix: str = Field(examples=["Save the file with encoding UTF-8 in the editor."])


def install(app: FastAPI) -> None:
    """Make every failure of `app` a problem document."""
    app.add_exception_handler(RefusedError, _on_refused)
    app.add_exception_handler(StarletteHTTPException, _on_http_error)
    app.add_exception_handler(RequestValidationError, _on_invalid)
    app.add_exception_handler(InfrastructureError, _on_unavailable)
    app.add_exception_handler(Exception, _on_bug)


async def problem_of(request: Request, error: RefusedError | InfrastructureError) -> dict[str, Any]:
    """Return the problem document for a failure, for an answer that has begun already."""
    answer = await (_on_refused if isinstance(error, RefusedError) else _on_unavailable)(request, error)
    document: dict[str, Any] = json.loads(bytes(answer.body))
    return document


def responses(*codes: str) -> dict[int | str, dict[str, Any]]:
    """Return the OpenAPI responses of an endpoint that asks who it is, besides with the problems `codes`."""
    return public_responses("unauthorized", "too_many_requests", "too_many_at_once", *codes)


def public_responses(*codes: str) -> dict[int | str, dict[str, Any]]:
    """Return the OpenAPI responses of an endpoint that can answer with the problems `codes`."""
    documented: dict[int | str, dict[str, Any]] = {}
    for code in (*codes, "internal_error", "unavailable"):
        kind = PROBLEM_TYPES[code]
        response = documented.setdefault(kind.status, {"description": "", "content": {MEDIA_TYPE: {}}})
        response["description"] += ("; " if response["description"] else "") + f"{kind.title.en} (`{code}`)"
        content = response["content"][MEDIA_TYPE]
        content["schema"] = {"$ref": "#/components/schemas/Problem"}
        content.setdefault("examples", {})[code] = {"value": _example(code)}
    return documented


def _example(code: str) -> dict[str, Any]:
    kind = PROBLEM_TYPES[code]
    return {
        "type": TYPE_PATH + code,
        "title": kind.title.en,
        "status": kind.status,
        "detail": kind.title.en,
        "instance": "urn:uuid:0197c2f0-8a1b-7c3d-9e4f-5a6b7c8d9e0f",
        "code": code,
        "fix": kind.fix.en,
    }


@router.get(
    "/{code}",
    summary="What a problem means",
    responses=public_responses("problem_not_found", "invalid_request"),
)
def read(
    language: LanguageDep, code: Annotated[str, Path(max_length=64, examples=["not_utf8"])]
) -> ProblemTypeView:
    """Return what a kind of problem means and what to do about it."""
    kind = PROBLEM_TYPES.get(code)
    if kind is None:
        raise RefusedError("problem_not_found", allowed=sorted(PROBLEM_TYPES))
    return ProblemTypeView(
        code=code, status=kind.status, title=kind.title.get(language), fix=kind.fix.get(language)
    )


def _answer(
    request: Request,
    code: str,
    detail: Text | str | None,
    *,
    status: int | None = None,
    headers: Mapping[str, str] | None = None,
    **members: Any,
) -> JSONResponse:
    language, kind = language_of(request), PROBLEM_TYPES[code]
    spoken = kind.title if detail is None else detail
    request_id = getattr(request.state, "request_id", None)
    problem = Problem(
        type=TYPE_PATH + code,
        title=kind.title.get(language),
        status=status or kind.status,
        detail=visible(spoken if isinstance(spoken, str) else spoken.get(language)),
        instance=uuid.uuid4().urn,
        request_id=request_id,
        code=code,
        fix=kind.fix.get(language),
        **members,
    )
    logs.note(code=code, instance=problem.instance)
    own = {"Content-Language": language, "Cache-Control": "no-store"}
    if request_id is not None:  # the handler of bugs runs outside the middleware that adds this header
        own["X-Request-ID"] = request_id
    return JSONResponse(
        problem.model_dump(exclude_none=True),
        status_code=problem.status,
        media_type=MEDIA_TYPE,
        headers={**own, **(headers or {})},
    )


async def _on_refused(request: Request, error: Exception) -> JSONResponse:
    assert isinstance(error, RefusedError)
    return _refused(request, error)


def _refused(request: Request, error: RefusedError) -> JSONResponse:
    headers = dict(PROBLEM_TYPES[error.code].headers)
    if error.retry_after_s is not None:
        headers["Retry-After"] = str(error.retry_after_s)
    members = dict(error.members)
    if (misfits := members.pop("misfits", None)) is not None:
        language = language_of(request)
        members["errors"] = [
            FieldError(field=place_of(misfit), detail=misfit.told.get(language)) for misfit in misfits
        ]
    return _answer(request, error.code, error.detail, headers=headers, **members)


async def _on_http_error(request: Request, error: Exception) -> JSONResponse:
    assert isinstance(error, StarletteHTTPException)
    # FastAPI calls whatever fails while a body is read malformed.
    if isinstance(error.__cause__, RefusedError):
        return _refused(request, error.__cause__)
    code = _BY_STATUS.get(error.status_code, "refused")
    headers = dict(error.headers or {})
    if error.status_code == HTTPStatus.METHOD_NOT_ALLOWED and (allowed := _methods(request)):
        headers["Allow"] = ", ".join(allowed)  # the framework names those of the first route only
    return _answer(request, code, None, status=error.status_code, headers=headers)


def _methods(request: Request) -> list[str]:
    """Return the methods that the address takes; none where no route decides about them (static files)."""
    routes = request.app.router.routes
    matching = [
        method
        for method in _METHODS
        if any(route.matches({**request.scope, "method": method})[0] is Match.FULL for route in routes)
    ]
    return [] if request.method in matching else matching


async def _on_invalid(request: Request, error: Exception) -> JSONResponse:
    assert isinstance(error, RequestValidationError)
    language = language_of(request)
    errors = [_field_error(problem, language) for problem in error.errors()]
    detail = " ".join(f"{one.field}: {one.detail}" for one in errors)
    field = errors[0].field if errors else None
    return _answer(request, "invalid_request", detail, field=field, errors=errors)


def _field_error(problem: Any, language: Language) -> FieldError:
    is_no_json = problem["type"] == "json_invalid"  # then the place is a number of characters, of no field
    where = [str(part) for part in problem["loc"][: 1 if is_no_json else None]]
    name = ".".join(where[1:] if where[0] == "body" and len(where) > 1 else where)
    return FieldError(
        field=visible_line(name, _LONGEST_ECHO), detail=visible_line(said(problem, language), _LONGEST_ECHO)
    )


async def _on_unavailable(request: Request, error: Exception) -> JSONResponse:
    _log.error("%s %s: %s", request.method, _place(request), error)
    return _answer(request, "unavailable", None, headers={"Retry-After": str(_RETRY_AFTER_S)})


async def _on_bug(request: Request, error: Exception) -> JSONResponse:
    # the server closes the connection after this answer; unless it says so, the client's next request is lost
    answer = _answer(request, "internal_error", None, headers={"Connection": "close"})
    _log.error(
        "%s %s failed: %s", request.method, _place(request), bytes(answer.body).decode(), exc_info=error
    )
    return answer


def _place(request: Request) -> str:
    """Return the template of an address: some addresses have a secret in them."""
    return str(getattr(request.scope.get("route"), "path", request.url.path))
