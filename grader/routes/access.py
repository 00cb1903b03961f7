"""Who asks, and what they may. `CallerDep` is the one way in for every endpoint.

While no course exists the service is open: nobody is asked who they are, a submission's unguessable id is what
opens it, and the token printed at the start opens the class. As soon as there is a course, everything personal
needs the bearer token of one of its members.
"""

import hashlib
import hmac
import secrets
from typing import TYPE_CHECKING, Annotated

from fastapi import Depends, Request
from fastapi.security import HTTPAuthorizationCredentials, HTTPBearer

from grader.contracts.identity import ANYBODY, OPERATOR, Caller, Role
from grader.routes.problems import ProblemError

if TYPE_CHECKING:
    from grader.routes.services import Services

ENTRY_PROBLEMS = ("unauthorized", "too_many_requests")
"""Problems of every endpoint that asks who it is."""

_TOKEN_BYTES = 24
bearer = HTTPBearer(
    auto_error=False,
    scheme_name="Token",
    description="The token of a member of a course; without courses, the one the service prints when it starts.",
)


class InstructorGate:
    """Recognises the instructor token of a service without courses; keeps its digest only."""

    def __init__(self, token: str) -> None:
        self._digest = _digest(token)

    def admits(self, token: str) -> bool:
        """Whether `token` is the right one, in a time that does not tell how close it was."""
        return hmac.compare_digest(_digest(token), self._digest)


def new_token() -> str:
    """Return a fresh token nobody can guess."""
    return secrets.token_urlsafe(_TOKEN_BYTES)


def identify(services: "Services", token: str | None) -> Caller | None:
    """Return who shows `token` (None: shows nothing); None for those who may not come in."""
    if services.courses.exist():
        return None if token is None else services.tokens.caller(token)
    if token is None:
        return ANYBODY
    return OPERATOR if services.gate.admits(token) else None


def caller_of(
    request: Request, credentials: Annotated[HTTPAuthorizationCredentials | None, Depends(bearer)]
) -> Caller:
    """Dependency of every endpoint that shows or changes something of somebody.

    Raises:
        ProblemError: a token is needed and missing, unknown, expired or revoked; or a student asks too often.
    """
    services: Services = request.app.state.services
    caller = identify(services, None if credentials is None else credentials.credentials)
    if caller is None:
        raise unauthorized()
    if caller.role is Role.STUDENT:
        services.request_limit.take(f"{caller.course}/{caller.person}")
    return caller


CallerDep = Annotated[Caller, Depends(caller_of)]


async def require_staff(caller: CallerDep) -> Caller:
    """Dependency of what assistants and instructors see.

    Raises:
        ProblemError: the caller is neither.
    """
    if caller.is_staff:
        return caller
    raise ProblemError("forbidden") if caller.role is not None else unauthorized()


StaffDep = Annotated[Caller, Depends(require_staff)]


async def require_instructor(caller: StaffDep) -> Caller:
    """Dependency of what changes settings or grades.

    Raises:
        ProblemError: the caller is no instructor.
    """
    if not caller.is_instructor:
        raise ProblemError("forbidden")
    return caller


InstructorDep = Annotated[Caller, Depends(require_instructor)]


def unauthorized() -> ProblemError:
    """Return the problem of a caller who must show a token first."""
    return ProblemError("unauthorized", headers={"WWW-Authenticate": 'Bearer realm="grader"'})


def _digest(token: str) -> bytes:
    return hashlib.sha256(token.encode()).digest()
