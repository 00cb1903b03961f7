"""What endpoints read of a request before they do anything: who asks, in which language, which state was seen.

Who asks is told by a bearer token (`grader.use_cases.callers`). The language is that of ``?lang=``, else the one
that ``Accept-Language`` weighs most, else the service's default.
"""

import re
from collections.abc import AsyncIterator, Collection, Iterator, Sequence
from contextlib import ExitStack, contextmanager, nullcontext
from dataclasses import dataclass
from typing import Annotated, Any, Literal

from fastapi import Depends, Header, Path, Query, Request
from fastapi.dependencies.models import Dependant
from fastapi.exceptions import RequestValidationError
from fastapi.security import HTTPAuthorizationCredentials, HTTPBearer
from fastapi.sse import EventSourceResponse
from pydantic import BeforeValidator
from pydantic_core import PydanticCustomError
from starlette.datastructures import ImmutableMultiDict

from grader.contracts.assignment import Assignment
from grader.contracts.errors import RefusedError
from grader.contracts.identity import Caller, Seen, sections_of
from grader.contracts.notation import decimal, whole
from grader.contracts.text import LANGUAGES, Language, Text
from grader.contracts.validation_words import SENT_TWICE
from grader.use_cases.callers import PLOT_WEIGHT, name_of, require_instructor, require_staff
from grader.use_cases.people import members
from grader.use_cases.services import Services
from grader.use_cases.visibility import visible_submission

_LONGEST_HEADER = 1_000
_LANGUAGE = "lang"
_TAG = re.compile(r'(W/)?"([\x21\x23-\x7e\x80-\xff]*)"')  # RFC 9110, section 8.8.3

PEER = "grader.peer"
"""Key in a request's scope for address and port of the connection's peer, whatever proxies say."""

SUBMISSIONS = "/api/v1/submissions/"
"""A submission's address begins with it."""

Address = Annotated[str, BeforeValidator(lambda submission: SUBMISSIONS + submission)]
"""Address of a submission, from its id."""

SESSION_COOKIE = "grader_session"
"""Cookie by which a browser shows its session instead of a token."""

bearer = HTTPBearer(
    auto_error=False,
    scheme_name="Token",
    description="The token of a member of a course; without courses, the one the service prints when it starts.",
)
AssignmentId = Annotated[str, Path(max_length=64, examples=["square"])]
RegradeId = Annotated[str, Path(max_length=16, examples=["9f2c01aa77be"])]
SubmissionId = Annotated[
    str,
    Path(
        description="As the upload was answered with.",
        max_length=64,
        examples=["0197c2f0-8a1b-7c3d-9e4f-5a6b7c8d9e0f"],
    ),
]


async def _services(request: Request) -> Services:
    # a coroutine runs on the event loop; any other dependency would wait for a thread
    services: Services = request.app.state.services
    return services


ServicesDep = Annotated[Services, Depends(_services)]


@dataclass(frozen=True, slots=True)
class Errand:
    """What somebody asks for: who they are, and the services that answer. Endpoints are given one."""

    services: Services
    caller: Caller

    @property
    def assignments(self) -> dict[str, Assignment]:
        """What the caller's course is given, by id, in the order of the checklist."""
        every = self.services.assignments.of(self.caller.course).all()
        return {assignment.id: assignment for assignment in every}


CredentialsDep = Annotated[HTTPAuthorizationCredentials | None, Depends(bearer)]


def address_of(request: Request) -> str:
    """Return from which network address a request comes; where a trusted proxy says it, the one behind that."""
    return "" if request.client is None else request.client.host


def _identified(request: Request, services: ServicesDep, credentials: CredentialsDep) -> Caller:
    token = None if credentials is None else credentials.credentials
    caller = services.callers.identify(token, address_of(request))
    if caller is None:
        raise RefusedError("unauthorized")
    services.allowances.request(caller)
    return caller


@contextmanager
def under_way(request: Request, services: Services, caller: Caller) -> Iterator[None]:
    """Count `request` as one that the caller has under way; streams that one watches are counted elsewhere.

    Raises RefusedError: the caller has too many.
    """
    name = name_of(caller)
    is_events = getattr(request.scope["route"], "response_class", None) is EventSourceResponse
    is_stream = is_events and request.method == "GET"
    with nullcontext() if name is None or is_stream else services.allowances.requests_at_once.one_more(name):
        yield


def parameters(dependant: Dependant, kind: Literal["query_params", "body_params"]) -> dict[str, bool]:
    """Return all parameters of a kind that an endpoint and its dependencies read, and which must be sent."""
    own = {one.alias: one.field_info.is_required() for one in getattr(dependant, kind)}
    return own | {
        name: is_required
        for dependency in dependant.dependencies
        for name, is_required in parameters(dependency, kind).items()
    }


def unknown(given: ImmutableMultiDict[str, Any], known: Collection[str]) -> list[tuple[str, str]]:
    """Return a problem for each name that is not read, as `refuse` takes them."""
    return [("extra_forbidden", name) for name in given if name not in known]


def sent_twice(given: ImmutableMultiDict[str, Any]) -> list[tuple[str, str]]:
    """Return a problem for each name that was sent more than once, as `refuse` takes them."""
    return [(SENT_TWICE[0], name) for name in given if len(given.getlist(name)) > 1]


def refuse(where: Literal["query", "body"], problems: Sequence[tuple[str, str]]) -> None:
    """Refuse a request for `problems`, each the kind of a validation error and the name of what was sent.

    Raises RequestValidationError: there are any.
    """
    if problems:
        raise RequestValidationError(
            [{"type": kind, "loc": (where, name), "msg": ""} for kind, name in problems]
        )


def _refuse_unknown_parameters(request: Request) -> None:
    """Refuse an address with a parameter that is not read: a misspelt filter would show everything."""
    if given := request.query_params:
        names = {_LANGUAGE: False} | parameters(request.scope["route"].dependant, "query_params")
        refuse("query", unknown(given, names) + sent_twice(given))


async def _errand(
    request: Request, services: ServicesDep, caller: Annotated[Caller, Depends(_identified)]
) -> AsyncIterator[Errand]:
    """Dependency of every endpoint that shows or changes something of somebody.

    Raises:
        RefusedError: a token is needed and missing, unknown, expired or revoked; a student asks too often, or
            somebody for too much at once.
        RequestValidationError: the address has a parameter that the endpoint does not have, or one twice.
    """
    _refuse_unknown_parameters(request)
    with under_way(request, services, caller):
        yield Errand(services, caller)


@contextmanager
def on_one_snapshot(
    request: Request, services: Services, credentials: HTTPAuthorizationCredentials | None
) -> Iterator[tuple[Errand, ExitStack]]:
    """Do what `ErrandDep` does, and read whatever is read in the context on one snapshot, in one transaction.

    For an endpoint that is asked again and again. With `ErrandDep` who asks is found out in another thread, and so
    in another transaction.

    Yields:
        What is asked for, and the snapshot, to be closed once everything is read.
    """
    with ExitStack() as counted, ExitStack() as snapshot:
        snapshot.enter_context(services.snapshot())
        caller = _identified(request, services, credentials)
        _refuse_unknown_parameters(request)
        counted.enter_context(under_way(request, services, caller))
        yield Errand(services, caller), snapshot


ErrandDep = Annotated[Errand, Depends(_errand)]


async def _staff(errand: ErrandDep) -> Errand:
    require_staff(errand.caller)
    return errand


StaffDep = Annotated[Errand, Depends(_staff)]
"""Assistants and instructors; others are refused before the body of their request is looked at."""


async def _instructor(errand: ErrandDep) -> Errand:
    require_instructor(errand.caller)
    return errand


InstructorDep = Annotated[Errand, Depends(_instructor)]
"""Instructors; others are refused before the body of their request is looked at."""


async def requested_language(  # on the event loop: what is no coroutine waits for a thread
    request: Request,
    lang: Annotated[
        Language | None, Query(description="Language of texts; goes before Accept-Language.")
    ] = None,
    accept_language: Annotated[
        str | None, Header(description="As browsers send it, e.g. `zh-CN,zh;q=0.9,en;q=0.8`.")
    ] = None,
) -> Language:
    """Return the language to answer in; a dependency of every endpoint that answers with text."""
    default: Language = request.app.state.default_language
    return lang or preferred(accept_language or "", default)


def language_of(request: Request) -> Language:
    """Return the language for an answer to a request that may itself be wrong."""
    asked = request.query_params.get(_LANGUAGE)
    for language in LANGUAGES:
        if asked == language:
            return language
    return preferred(request.headers.get("accept-language", ""), request.app.state.default_language)


def preferred(accept_language: str, default: Language) -> Language:
    """Return the language that the header `accept_language` weighs most; `default` if it names neither."""
    best, best_weight = default, 0.0
    for entry in accept_language[:_LONGEST_HEADER].split(","):
        tag, _, parameters = entry.strip().partition(";")
        primary, weight = tag.strip().lower().split("-")[0], _weight(parameters)
        for language in LANGUAGES:
            if primary == language and weight > best_weight:
                best, best_weight = language, weight
    return best


def _weight(parameters: str) -> float:
    name, _, value = parameters.strip().partition("=")
    if name.strip() != "q":
        return 1.0
    try:
        return decimal(value.strip())
    except ValueError:
        return 0.0


LanguageDep = Annotated[Language, Depends(requested_language)]


def _in_digits(value: object) -> object:
    """Read strictly: pydantic by itself also takes "1_0", " 10" and "1e1" for a number, as Python does."""
    if not isinstance(value, str):
        return value
    try:
        return whole(value)
    except ValueError:
        raise PydanticCustomError("int_parsing", "Input should be a whole number in digits") from None


def _costly(weight: int) -> Any:
    async def counted(request: Request, errand: ErrandDep) -> AsyncIterator[None]:
        otherwise = f"submission {request.path_params.get('submission_id')}"
        with errand.services.allowances.costly.one_more(errand.caller, otherwise, weight):
            yield

    return Depends(counted)


COSTLY, DRAWN = _costly(1), _costly(PLOT_WEIGHT)
"""Of endpoints whose answers take time to make, and of plots: students have few under way, and few in a minute."""


def _known_section(
    errand: StaffDep,
    section: Annotated[str, Query(max_length=64, description="Only students of this section.")] = "",
) -> str:
    sections = sections_of(members(errand.services, errand.caller)) if section else []
    if section and section not in sections:
        detail = Text(zh="没有这个分组。", en="There is no such section.")
        raise RefusedError("invalid_request", detail, field="section", allowed=sections)
    return section


SectionDep = Annotated[str, Depends(_known_section)]
"""The section that an address names, one of those of the caller's students; empty: all of them."""


def _require_sight(errand: ErrandDep, submission_id: SubmissionId) -> None:
    visible_submission(errand.services, errand.caller, submission_id)


SIGHT = Depends(_require_sight)
"""Of endpoints about one submission whose use case does not check by itself who may see it."""

QueryWhole = Annotated[int, BeforeValidator(_in_digits)]
"""A whole number in the query of an address."""


def seen(if_match: str | None) -> Seen | None:
    """Return which states the header If-Match names (RFC 9110, section 13.1.1); None without the header.

    Tags are compared strongly: weak ones (``W/"…"``) name no state, and neither does what is no tag.
    """
    if if_match is None:
        return None
    if if_match.strip() == "*":
        return Seen(None)
    return Seen(frozenset(tag for weak, tag in _TAG.findall(if_match) if not weak))


def is_held(if_none_match: str, etag: str) -> bool:
    """Whether a header If-None-Match names the ETag of an answer, be it weak or not (section 13.1.2)."""
    tags = {one.strip().removeprefix("W/") for one in if_none_match.split(",")}
    return bool(etag) and bool({"*", etag.removeprefix("W/")} & tags)


def etag(tag: str) -> str:
    """Return the strong ETag of the state named `tag`."""
    return f'"{tag}"'
