"""Who may see the dashboard. Until there are identities, one token per start of the service."""

import hashlib
import hmac
import secrets
from typing import Annotated

from fastapi import Depends, Request
from fastapi.security import HTTPAuthorizationCredentials, HTTPBearer

from grader.routes.problems import ProblemError

_TOKEN_BYTES = 24
_bearer = HTTPBearer(
    auto_error=False,
    scheme_name="InstructorToken",
    description="The token that the service prints when it starts, or the operator set.",
)


class InstructorGate:
    """Recognises the instructor token; keeps its digest only."""

    def __init__(self, token: str) -> None:
        self._digest = _digest(token)

    def admits(self, token: str) -> bool:
        """Whether `token` is the right one, in a time that does not tell how close it was."""
        return hmac.compare_digest(_digest(token), self._digest)


def new_token() -> str:
    """Return a fresh token nobody can guess."""
    return secrets.token_urlsafe(_TOKEN_BYTES)


def require_instructor(
    request: Request, credentials: Annotated[HTTPAuthorizationCredentials | None, Depends(_bearer)]
) -> None:
    """Dependency of what only instructors see.

    Raises:
        ProblemError: there is no token, or a wrong one.
    """
    gate: InstructorGate = request.app.state.services.gate
    if credentials is None or not gate.admits(credentials.credentials):
        raise ProblemError("unauthorized", headers={"WWW-Authenticate": 'Bearer realm="grader"'})


def _digest(token: str) -> bytes:
    return hashlib.sha256(token.encode()).digest()
