"""Measurements for Prometheus, for whoever runs the service: never open to everybody."""

import hmac
from typing import Annotated

from fastapi import APIRouter, Depends, Response
from fastapi.security import HTTPAuthorizationCredentials

from grader.contracts.errors import RefusedError
from grader.operation.metrics import MEDIA_TYPE
from grader.service.requests.dependencies import ServicesDep, bearer
from grader.service.routes.problems import public_responses
from grader.use_cases.services import Services

router = APIRouter(tags=["health"])


def require_reader(
    services: ServicesDep, credentials: Annotated[HTTPAuthorizationCredentials | None, Depends(bearer)]
) -> None:
    """Dependency: the token of GRADER_METRICS_TOKEN, or one that may see the class.

    Not even this machine is let in without: a proxy on it would let everybody in.

    Raises RefusedError: no token, or one that opens nothing; or a student's.
    """
    token = None if credentials is None else credentials.credentials
    if token is not None and _is_own(services, token):
        return
    caller = services.callers.identify(token)
    if caller is None or caller.role is None:
        raise RefusedError("unauthorized")
    if not caller.is_staff:
        raise RefusedError("forbidden")


@router.get(
    "/metrics",
    summary="Measurements for Prometheus",
    dependencies=[Depends(require_reader)],
    response_class=Response,
    responses={
        200: {
            "description": "Prometheus' text format.",
            "content": {"text/plain": {"schema": {"type": "string"}}},
        },
        **public_responses("unauthorized", "forbidden"),
    },
)
def read(services: ServicesDep) -> Response:
    """Return what this process counted, and what the rows say about queue and workers."""
    content = services.metrics.exposition()
    return Response(content, media_type=MEDIA_TYPE, headers={"Cache-Control": "no-store"})


def _is_own(services: Services, token: str) -> bool:
    own = services.settings.metrics_token
    return own is not None and hmac.compare_digest(own.get_secret_value().encode(), token.encode())
