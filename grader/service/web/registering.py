"""The page that a learning platform opens to register this service (LTI Dynamic Registration).

It stands in a frame of the platform's page, as that of `grader.service.web.picking`: the secret in its address
says for which course, and no cookie is needed.
"""

from typing import Annotated

from fastapi import APIRouter, Form, Path, Query, Request, Response

from grader.service.web.access import ServicesDep
from grader.service.web.pages import page
from grader.service.web.picking import framed_by
from grader.use_cases import registering

router = APIRouter(prefix="/lti/register", include_in_schema=False)
Secret = Annotated[str, Path(min_length=43, max_length=43)]
_LONGEST = 8_000


@router.get("/{secret}")
def read(
    request: Request,
    services: ServicesDep,
    secret: Secret,
    openid_configuration: Annotated[str, Query(max_length=_LONGEST)] = "",
    registration_token: Annotated[str, Query(max_length=_LONGEST)] = "",
) -> Response:
    """Ask whether to register; a program that only looks at the address does not."""
    registering.check(services, secret, openid_configuration)
    asked = {"openid_configuration": openid_configuration, "registration_token": registration_token}
    return framed_by(page(request, "lti_register.html", asked=asked, added=None), openid_configuration)


@router.post("/{secret}")
def register(
    request: Request,
    services: ServicesDep,
    secret: Secret,
    openid_configuration: Annotated[str, Form(max_length=_LONGEST)] = "",
    registration_token: Annotated[str, Form(max_length=_LONGEST)] = "",
) -> Response:
    """Register, and say what to do next."""
    added = registering.add_by_registration(services, secret, openid_configuration, registration_token)
    return framed_by(page(request, "lti_register.html", asked={}, added=added), openid_configuration)
