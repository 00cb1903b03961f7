"""Coming in by a provider's word: who that is in which course, and what is asked of those it does not tell.

A provider names a person, never a role. A name that was bound before opens a session. One that is new is bound to
the student whose id or address the provider vouches for; anybody else shows their token once.
"""

import logging
from collections.abc import Mapping
from dataclasses import dataclass

from grader.contracts.errors import RefusedError
from grader.contracts.identity import Caller, Identity
from grader.contracts.platform import platform_of
from grader.outside.signin import Person, Provider, SignInAttempt, SignInError
from grader.use_cases.callers import require_instructor, require_staff
from grader.use_cases.services import Services

_log = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True, kw_only=True)
class Arrival:
    """Somebody whom a provider recognised.

    Attributes:
        session: what their browser keeps, where it is clear who they are; else None.
        held: else, the secret by which they go on: with a token, or by the choice of a course.
        courses: ids and titles to choose from; empty: a token is needed.
    """

    session: str | None = None
    held: str = ""
    courses: tuple[tuple[str, str], ...] = ()


def send_away(services: Services, provider: Provider, attempt: SignInAttempt) -> str:
    """Return where a browser goes to be recognised. Raises RefusedError: nobody can sign in now."""
    _require_courses(services)
    with services.allowances.sign_ins.one_more(provider.id):
        try:
            return provider.login_address(attempt, _back(services, provider))
        except SignInError as error:
            raise _refused(provider.id, error) from None


def come_back(
    services: Services, provider: Provider, attempt: SignInAttempt, answer: Mapping[str, str]
) -> Arrival:
    """Take in whom a provider has recognised.

    Raises RefusedError: it has not, cannot be asked, or says what is not to be believed.
    """
    _require_courses(services)
    with services.allowances.sign_ins.one_more(provider.id):
        try:
            person = provider.recognised(attempt, _back(services, provider), answer)
        except SignInError as error:
            raise _refused(provider.id, error) from None
    return arrive(services, provider.id, person)


def arrive(services: Services, provider: str, person: Person) -> Arrival:
    """Take in whom `provider` vouches for.

    Raises RefusedError: there are no courses, or the provider was taken away meanwhile.
    """
    _require_courses(services)
    identities, within = services.identities, _within(services, provider)
    claimed = (person.claimed,) if person.claimed else ()
    identities.bind_claimed(provider, person.subject, persons=claimed, email=person.email, within=within)
    held_identities = identities.of_subject(provider, person.subject)
    if len(held_identities) == 1 and (session := identities.open_session(held_identities[0])) is not None:
        return Arrival(session=session)
    return Arrival(held=identities.hold(provider, person.subject), courses=_titled(services, held_identities))


def show_token(services: Services, held: str, token: str) -> str | None:
    """Bind whom a provider recognised to the member whose token they show; return their session.

    None: the token is nobody's.

    Raises:
        RefusedError: that was too long ago, they are another member of that course, or it is not the course of
            the platform that they came from.
    """
    provider, subject = _recognised(services, held)
    caller = services.tokens.caller(token)
    if caller is None or caller.course is None or caller.person is None:
        return None
    if _within(services, provider) not in (None, caller.course):
        raise RefusedError("signin_other_course")
    if not services.identities.bind(provider, subject, caller.course, caller.person, by_token=True):
        raise RefusedError("signin_somebody_else")
    return _enter(services, held, caller.course)


def choose(services: Services, held: str, course: str) -> str:
    """Open a session in one of the courses of whom a provider recognised.

    Raises RefusedError: that was too long ago, or they are in no such course.
    """
    return _enter(services, held, course)


def ways_of(services: Services, caller: Caller, person: str) -> tuple[Identity, ...]:
    """Return by which names a member of the caller's course signs in. For staff."""
    require_staff(caller)
    return () if caller.course is None else services.identities.of_member(caller.course, person)


def unbind(services: Services, caller: Caller, person: str, identity: str) -> None:
    """End a binding, and the sessions that it opened.

    Raises RefusedError: the caller is no instructor, or there is no such binding.
    """
    require_instructor(caller)
    ended = caller.course is not None and services.identities.unbind(
        identity, caller.course, person, caller.signature
    )
    if not ended:
        raise RefusedError("identity_not_found")


def _enter(services: Services, held: str, course: str) -> str:
    provider, subject = _recognised(services, held)
    for identity in services.identities.of_subject(provider, subject):
        if identity.course == course and (session := services.identities.open_session(identity)) is not None:
            services.identities.let_go(held)
            return session
    raise RefusedError("signin_expired")


def _recognised(services: Services, held: str) -> tuple[str, str]:
    arrival = services.identities.held(held)
    if arrival is None:
        raise RefusedError("signin_expired")
    return arrival


def _within(services: Services, provider: str) -> str | None:
    """Return the only course that `provider` opens; None: it opens any.

    An instructor can set up a platform that says anything, so it must not name members of another course.
    """
    id_ = platform_of(provider)
    if id_ is None:
        return None
    platform = services.platforms.get(id_)
    if platform is None:
        raise RefusedError("signin_expired")
    return platform.course


def _titled(services: Services, identities: tuple[Identity, ...]) -> tuple[tuple[str, str], ...]:
    return tuple((identity.course, services.courses.get(identity.course).title) for identity in identities)


def _require_courses(services: Services) -> None:
    if not services.courses.exist():
        raise RefusedError("no_course")


def _back(services: Services, provider: Provider) -> str:
    return f"{services.providers.public_url}/enter/with/{provider.id}/back"


def _refused(provider: str, error: SignInError) -> RefusedError:
    _log.warning("sign-in by %s: %s: %s", provider, error.code, error.reason)
    return RefusedError(error.code)
