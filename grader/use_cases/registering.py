"""Adding a platform by one address, which an instructor makes and the platform opens (`outside.lti.registration`).

It is opened in a frame of the platform's page, by somebody who may have no account here: the secret in the address
says for which course. It adds one platform, and is good for a day.
"""

import logging

from grader.contracts.errors import RefusedError
from grader.contracts.identity import Caller, Role
from grader.contracts.platform import Platform
from grader.messages import on_page
from grader.outside.lti.registration import RegistrationError, register
from grader.outside.signin.channel import is_confidential
from grader.store.audit import Signature
from grader.use_cases.callers import taught_course
from grader.use_cases.platforms import add_signed, public_url
from grader.use_cases.services import Services

_log = logging.getLogger(__name__)
_LONGEST_ADDRESS, _LONGEST_TOKEN = 2_000, 8_000


def invite(services: Services, caller: Caller) -> str:
    """Return an address by which a platform is added to the caller's course.

    Raises:
        RefusedError: the caller is no instructor, there is no course, or the service does not know
            its own address.
    """
    taught_course(caller)
    address = public_url(services)
    return f"{address}/lti/register/{services.platforms.invite(services.signature(caller))}"


def check(services: Services, secret: str, configuration: str) -> None:
    """Look at what a platform opened an address with; nothing is asked yet.

    Raises RefusedError: the address is not good, or not any more; or no platform's configuration came with it.
    """
    _invited(services, secret)
    if len(configuration) > _LONGEST_ADDRESS or not is_confidential(configuration):
        raise RefusedError("not_a_registration")


def add_by_registration(services: Services, secret: str, configuration: str, token: str) -> Platform:
    """Register with the platform of a `configuration`, which knows its request by `token`, and add it.

    Raises as `check`; the platform cannot be registered with, or is there already.
    """
    check(services, secret, configuration)
    signed = _invited(services, secret)
    if len(token) > _LONGEST_TOKEN or not (token.isascii() and token.isprintable()):
        raise RefusedError("not_a_registration")
    name = on_page(services.settings.default_language, "site")
    try:
        with services.allowances.sign_ins.one_more("lti register"):
            new = register(
                configuration,
                token,
                public_url(services),
                name,
                private=services.providers.private_platforms,
            )
    except RegistrationError as error:
        place = configuration.partition("?")[0]  # what follows may be a secret of the platform's
        _log.warning("no registration with %s: %s", place, str(error).replace(configuration, place))
        raise RefusedError.saying("registration_failed", zh=str(error), en=str(error)) from None
    if not services.platforms.end_invitation(secret):
        raise RefusedError("registration_over")
    return add_signed(services, new, signed)


def _invited(services: Services, secret: str) -> Signature:
    """Return for whom: who is an instructor no more lets nobody in."""
    signed = services.platforms.invited(secret)
    member = None if signed is None else services.courses.member(signed.course or "", signed.actor)
    if signed is None or member is None or member.role is not Role.INSTRUCTOR:
        raise RefusedError("registration_over")
    return signed
