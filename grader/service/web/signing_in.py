"""Redirecting a browser to a sign-in provider, and taking it back.

A cookie of the browser holds what the provider's answer must match (`SignInAttempt`), so nobody can be sent back
with somebody else's answer. A browser does not send the session's cookie with the redirect back, because another
site makes that request. So the redirect ends at a page that goes on by itself, which is a request of our own site.
"""

import hmac
import ipaddress
import re
from typing import Annotated
from urllib.parse import parse_qsl, urlencode

from fastapi import APIRouter, Form, Path, Query, Request, Response
from fastapi.responses import RedirectResponse

from grader.contracts.errors import RefusedError
from grader.messages import on_page
from grader.outside.signin import Person, SignInAttempt, is_subject
from grader.service.web.access import ENTER, PEER, SESSION_COOKIE, ServicesDep, language_of
from grader.service.web.entrance import own_address
from grader.service.web.forms import OWN_FORM, set_private_cookie
from grader.service.web.pages import page
from grader.use_cases import signing_in
from grader.use_cases.signing_in import Arrival

router = APIRouter(prefix=ENTER, include_in_schema=False)
AWAY_COOKIE, HELD_COOKIE = "grader_away", "grader_held"
_PATIENCE_S = 600
_LONGEST = 2_000
_SECRET = re.compile(r"[A-Za-z0-9_-]{43}")
_SECRETS = ("state", "nonce", "verifier")
_ANSWER = ("code", "state", "iss", "error", "error_description", "ticket")
ProviderId = Annotated[str, Path(max_length=32)]
Next = Annotated[str, Query(max_length=_LONGEST)]


@router.get("/with/{provider_id}")
def go(request: Request, services: ServicesDep, provider_id: ProviderId, next: Next = "") -> Response:
    """Send a browser to a provider; if a proxy signs people in, open the session at once."""
    provider = services.providers.sending(provider_id)
    if provider is None:
        said = _person_by_proxy(request, services, provider_id)
        return arrived(request, signing_in.arrive(services, provider_id, said), own_address(next))
    attempt = SignInAttempt()
    response = RedirectResponse(signing_in.send_away(services, provider, attempt), status_code=303)
    kept = {"by": provider_id, "next": own_address(next), "state": attempt.state, "nonce": attempt.nonce}
    _keep(request, response, AWAY_COOKIE, urlencode(kept | {"verifier": attempt.verifier}))
    return response


@router.get("/with/{provider_id}/back")
def come_back(request: Request, services: ServicesDep, provider_id: ProviderId) -> Response:
    """Take in a browser that a provider sends back."""
    provider = services.providers.sending(provider_id)
    if provider is None:
        raise RefusedError("not_found")
    answer = {name: value for name in _ANSWER if (value := request.query_params.get(name)) is not None}
    kept = kept_by(request.cookies.get(AWAY_COOKIE, "")[: 2 * _LONGEST], _SECRETS, answer.get("state", ""))
    if kept.get("by") != provider_id:
        raise RefusedError("signin_expired")
    attempt = SignInAttempt(**{name: kept[name] for name in _SECRETS})
    arrival = signing_in.come_back(services, provider, attempt, answer)
    response = arrived(request, arrival, own_address(kept.get("next", "")))
    response.delete_cookie(AWAY_COOKIE, path=ENTER, httponly=True, samesite="lax")
    return response


@router.post("/bind", dependencies=OWN_FORM)
def bind(
    request: Request,
    services: ServicesDep,
    token: Annotated[str, Form(max_length=1_000)] = "",
    next: Annotated[str, Form(max_length=_LONGEST)] = "",
) -> Response:
    """Bind somebody who signed in at a provider to the member whose token they enter; later none is asked for."""
    session = signing_in.show_token(services, request.cookies.get(HELD_COOKIE, ""), token.strip())
    if session is None:
        wrong = on_page(language_of(request), "enter.wrong_token")
        return page(request, "enter_bind.html", status=403, courses=(), next=own_address(next), wrong=wrong)
    return _let_in(request, session, own_address(next))


@router.post("/course", dependencies=OWN_FORM)
def choose(
    request: Request,
    services: ServicesDep,
    course: Annotated[str, Form(max_length=64)] = "",
    next: Annotated[str, Form(max_length=_LONGEST)] = "",
) -> Response:
    """Open a session in that course which somebody who signed in at a provider has chosen."""
    session = signing_in.choose(services, request.cookies.get(HELD_COOKIE, ""), course)
    return _let_in(request, session, own_address(next))


def kept_by(cookie: str, secrets: tuple[str, ...], state: str) -> dict[str, str]:
    """Return what a browser kept while it was away, if it comes back with the state that it went with.

    Raises RefusedError: it was another browser, or one of the `secrets` is none of ours.
    """
    kept = dict(parse_qsl(cookie))
    ours = all(_SECRET.fullmatch(kept.get(name, "")) for name in secrets)
    if not ours or not hmac.compare_digest(kept["state"].encode(), state.encode()):
        raise RefusedError("signin_expired")
    return kept


def arrived(request: Request, arrival: Arrival, next_: str) -> Response:
    """Open a session for somebody who signed in and lead to `next_`; ask for a token or course first if needed."""
    if arrival.session is not None:
        return _let_in(request, arrival.session, next_)
    response = page(request, "enter_bind.html", courses=arrival.courses, next=next_, wrong="")
    _keep(request, response, HELD_COOKIE, arrival.held)
    return response


def _let_in(request: Request, session: str, next_: str) -> Response:
    response = page(request, "enter_done.html", next=next_ or "/")
    set_private_cookie(request, response, SESSION_COOKIE, session)
    response.delete_cookie(HELD_COOKIE, path=ENTER, httponly=True, samesite="lax")
    return response


def _keep(request: Request, response: Response, name: str, value: str) -> None:
    """Set a cookie that also comes with a step from another site, to these addresses alone."""
    secure = request.url.scheme == "https"
    response.set_cookie(
        name, value, max_age=_PATIENCE_S, path=ENTER, httponly=True, samesite="lax", secure=secure
    )


def _person_by_proxy(request: Request, services: ServicesDep, provider_id: str) -> Person:
    entry = services.providers.header(provider_id)
    if entry is None:
        raise RefusedError("not_found")
    peer, values = request.scope.get(PEER), request.headers.getlist(entry.header)
    if peer is None or not _is_among(peer[0], entry.proxies) or len(values) != 1:
        raise RefusedError("signin_refused")
    name = values[0].strip()
    if not is_subject(name):
        raise RefusedError("signin_failed")
    return Person(subject=name, claimed=name)


def _is_among(address: str, networks: tuple[str, ...]) -> bool:
    try:
        found = ipaddress.ip_address(address)
    except ValueError:
        return False
    if isinstance(found, ipaddress.IPv6Address) and found.ipv4_mapped is not None:
        found = found.ipv4_mapped  # so says a socket that listens for both
    return any(found in ipaddress.ip_network(network) for network in networks)
