"""What endpoints depend on: the services, and who asks by their bearer token (`grader.use_cases.callers`)."""

from typing import Annotated

from fastapi import Depends, Request
from fastapi.security import HTTPAuthorizationCredentials, HTTPBearer

from grader.contracts.errors import RefusedError
from grader.contracts.identity import Caller, Role
from grader.use_cases.services import Services

ENTRY_PROBLEMS = ("unauthorized", "too_many_requests")
"""Problems of every endpoint that asks who it is."""

bearer = HTTPBearer(
    auto_error=False,
    scheme_name="Token",
    description="The token of a member of a course; without courses, the one the service prints when it starts.",
)


async def _services(request: Request) -> Services:
    # a coroutine runs on the event loop; any other dependency would wait for a thread
    services: Services = request.app.state.services
    return services


ServicesDep = Annotated[Services, Depends(_services)]


def caller_of(
    services: ServicesDep, credentials: Annotated[HTTPAuthorizationCredentials | None, Depends(bearer)]
) -> Caller:
    """Dependency of every endpoint that shows or changes something of somebody.

    Raises:
        RefusedError: a token is needed and missing, unknown, expired or revoked; or a student asks too often.
    """
    caller = services.callers.identify(None if credentials is None else credentials.credentials)
    if caller is None:
        raise RefusedError("unauthorized")
    if caller.role is Role.STUDENT:
        services.request_limit.take(f"{caller.course}/{caller.person}")
    return caller


CallerDep = Annotated[Caller, Depends(caller_of)]


async def require_staff(caller: CallerDep) -> Caller:
    """Dependency of what assistants and instructors see.

    Raises:
        RefusedError: the caller is neither.
    """
    if caller.is_staff:
        return caller
    raise RefusedError("forbidden" if caller.role is not None else "unauthorized")


StaffDep = Annotated[Caller, Depends(require_staff)]


async def require_instructor(caller: StaffDep) -> Caller:
    """Dependency of what changes settings or grades.

    Raises:
        RefusedError: the caller is no instructor.
    """
    if not caller.is_instructor:
        raise RefusedError("forbidden")
    return caller


InstructorDep = Annotated[Caller, Depends(require_instructor)]
