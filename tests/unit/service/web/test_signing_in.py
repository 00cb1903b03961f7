"""Signing in by OpenID Connect, CAS and a proxy's header: who gets in, as whom, and who does not."""

import asyncio
from collections.abc import Callable
from dataclasses import replace
from datetime import timedelta

import httpx
import pytest
from fastapi import FastAPI
from joserfc.jwk import RSAKey

from grader.api import behind_proxies
from grader.contracts.identity import Role, RosterEntry
from grader.outside.signin import Providers
from grader.outside.signin.config import SignInConfig
from grader.outside.signin.opening import opened
from grader.service.web.access import PEER, SESSION_COOKIE
from grader.service.web.signing_in import AWAY_COOKIE, HELD_COOKIE
from grader.use_cases.services import Services
from tests.fakes.provider import CAS_SUCCESS, CLIENT, SECRET, FakeProvider
from tests.unit.service.web.conftest import Browser

OTHER_KEY = RSAKey.generate_key(2048, parameters={"kid": "second", "use": "sig", "alg": "RS256"})


@pytest.fixture
def idp(listening: FakeProvider, services: Services) -> FakeProvider:
    address = listening.address
    listening.__init__()  # type: ignore[misc]
    listening.address, listening.now = address, services.clock().timestamp()
    return listening


def _providers(idp: FakeProvider, services: Services, **changed: object) -> Providers:
    oidc = {
        "kind": "oidc",
        "id": "campus",
        "title": "统一身份认证",
        "issuer": idp.address,
        "client_id": CLIENT,
        "client_secret": SECRET,
    }
    cas = {"kind": "cas", "id": "cas", "title": "CAS", "url": f"{idp.address}/cas", "attribute": "XH"}
    header = {
        "kind": "header",
        "id": "proxy",
        "title": "Proxy",
        "header": "X-Remote-User",
        "proxies": ["10.0.0.5"],
    }
    document = {"public_url": "http://127.0.0.1:1", "providers": [{**oidc, **changed}, cas, header]}
    return opened(SignInConfig.model_validate(document), lambda: services.clock().timestamp())


@pytest.fixture
def desk(
    client: httpx.Client,
    running: tuple[FastAPI, str],
    services: Services,
    idp: FakeProvider,
    tokens: dict[str, str],
) -> Browser:
    """A browser at a service with all three kinds of providers."""
    running[0].state.services = replace(services, providers=_providers(idp, services))
    return Browser(client)


def _go(desk: Browser, idp: FakeProvider, by: str = "campus", next: str = "/submissions") -> dict[str, str]:
    """Go to the provider and be recognised there; return what the browser brings back."""
    sent = desk.get(f"/enter/with/{by}", params={"next": next})
    assert sent.status_code == 303, sent.text
    return idp.authorize(sent.headers["Location"])


def _back(desk: Browser, answer: dict[str, str], by: str = "campus") -> httpx.Response:
    return desk.get(f"/enter/with/{by}/back", params=answer)


def _is_in(desk: Browser) -> bool:
    return desk.get("/submissions").status_code == 200


def test_the_page_of_entrance_offers_the_providers_and_the_token(desk: Browser) -> None:
    shown = desk.get("/enter?next=/submissions").text
    assert "统一身份认证" in shown
    assert "/enter/with/campus?next=/submissions" in shown
    assert 'name="token"' in shown


@pytest.mark.parametrize("by", ["campus", "cas"])
def test_a_student_whom_the_roster_knows_is_let_in(
    desk: Browser, idp: FakeProvider, services: Services, by: str
) -> None:
    arrived = _back(desk, _go(desk, idp, by), by)
    assert arrived.status_code == 200
    assert 'http-equiv="refresh" content="0;url=/submissions"' in arrived.text
    assert "samesite=strict" in arrived.headers["set-cookie"].lower()
    assert _is_in(desk)
    (bound,) = services.identities.of_member("ros", "li")
    assert (bound.provider, bound.by_token) == (by, False)
    # the second time the name alone is enough
    desk.client.cookies.clear()
    idp.claims = {"preferred_username": "somebody new"}
    _back(desk, _go(desk, idp, by), by)
    assert _is_in(desk)
    actions = [entry.action for entry in services.audit.entries("ros", 10)]
    assert actions.count("signin.bind") == 1


def test_whoever_fits_nobody_shows_their_token_once(
    desk: Browser, idp: FakeProvider, services: Services, tokens: dict[str, str]
) -> None:
    idp.user = "unknown"
    asked = _back(desk, _go(desk, idp, next="/class"))
    assert 'action="/enter/bind"' in asked.text
    assert not _is_in(desk)
    page = "/enter"
    wrong = desk.post("/enter/bind", {"token": "grader_wrong", "next": "/class"}, page=page)
    assert (wrong.status_code, _is_in(desk)) == (403, False)
    done = desk.post("/enter/bind", {"token": tokens["wang"], "next": "/class"}, page=page)
    assert "url=/class" in done.text
    assert desk.get("/class").status_code == 200
    (bound,) = services.identities.of_member("ros", "wang")
    assert bound.by_token
    assert desk.post("/enter/bind", {"token": tokens["wang"]}, page=page).status_code == 403  # used up
    desk.client.cookies.clear()
    _back(desk, _go(desk, idp))
    assert desk.get("/class").status_code == 200


def test_a_role_is_never_believed(desk: Browser, idp: FakeProvider, services: Services) -> None:
    """Whoever can choose a name at the provider must not become an instructor by it."""
    idp.user = "wang"
    assert 'action="/enter/bind"' in _back(desk, _go(desk, idp)).text
    assert services.identities.of_member("ros", "wang") == ()


def test_a_second_account_does_not_become_a_student_who_has_one(desk: Browser, idp: FakeProvider) -> None:
    _back(desk, _go(desk, idp))
    desk.client.cookies.clear()
    idp.claims = {"sub": "another account", "preferred_username": "li"}
    assert 'action="/enter/bind"' in _back(desk, _go(desk, idp)).text


def test_an_account_stays_one_person(
    desk: Browser, idp: FakeProvider, services: Services, tokens: dict[str, str]
) -> None:
    _back(desk, _go(desk, idp))
    held = services.identities.hold("campus", "sub-of-li")
    desk.client.cookies.set(HELD_COOKIE, held, domain="127.0.0.1", path="/enter")
    refused = desk.post("/enter/bind", {"token": tokens["han"]}, page="/enter")
    assert refused.status_code == 403
    assert services.identities.of_member("ros", "han") == ()


def test_who_is_in_two_courses_chooses(desk: Browser, idp: FakeProvider, services: Services) -> None:
    services.courses.create("second", "Zweiter Kurs", "Asia/Shanghai", "setup")
    services.courses.import_roster(
        "second",
        [
            RosterEntry(id="li", name="", role=Role.STUDENT),
            RosterEntry(id="w", name="", role=Role.INSTRUCTOR),
        ],
        "setup",
    )
    asked = _back(desk, _go(desk, idp))
    assert "Zweiter Kurs" in asked.text
    assert not _is_in(desk)
    assert desk.post("/enter/course", {"course": "third"}, page="/enter").status_code == 403
    assert desk.post("/enter/course", {"course": "second"}, page="/enter").status_code == 200
    assert "Zweiter Kurs" in desk.get("/submissions").text


def test_who_comes_into_another_course_later_chooses(
    desk: Browser, idp: FakeProvider, services: Services
) -> None:
    """A name that is known from the last course is looked for in the new one's class list, too."""
    _back(desk, _go(desk, idp))
    desk.client.cookies.clear()
    services.courses.create("second", "Zweiter Kurs", "Asia/Shanghai", "setup")
    services.courses.import_roster("second", [RosterEntry(id="li", name="", role=Role.STUDENT)], "setup")
    assert "Zweiter Kurs" in _back(desk, _go(desk, idp)).text
    assert {one.course for one in services.identities.of_subject("campus", "sub-of-li")} == {"ros", "second"}


SPOILT: dict[str, Callable[[FakeProvider], None]] = {
    "wrong nonce": lambda idp: idp.claims.update(nonce="x" * 43),
    "no nonce": lambda idp: idp.claims.update(nonce=None),
    "wrong issuer": lambda idp: idp.claims.update(iss="https://evil.example"),
    "another client": lambda idp: idp.claims.update(aud="other"),
    "several clients": lambda idp: idp.claims.update(aud=[CLIENT, "other"]),
    "authorized for another": lambda idp: idp.claims.update(azp="other"),
    "expired": lambda idp: idp.claims.update(exp=int(idp.now) - 61),
    "of the future": lambda idp: idp.claims.update(iat=int(idp.now) + 61),
    "no end": lambda idp: idp.claims.update(exp=None),
    "no subject": lambda idp: idp.claims.update(sub=""),
    "long subject": lambda idp: idp.claims.update(sub="s" * 256),
    "a subject with a NUL": lambda idp: idp.claims.update(sub="s\0"),
    "subject a number": lambda idp: idp.claims.update(sub=7),
    "alg none": lambda idp: setattr(idp, "sign", idp.unsigned),
    "HS256 with the public key": lambda idp: setattr(idp, "sign", idp.by_secret),
    "a key of nobody's": lambda idp: setattr(idp, "sign", lambda claims: idp.signed(claims, OTHER_KEY)),
    "no token": lambda idp: setattr(idp, "sign", lambda claims: "x"),
}


@pytest.mark.parametrize("how", SPOILT)
def test_a_token_that_is_not_to_be_believed_lets_nobody_in(
    desk: Browser, idp: FakeProvider, how: str
) -> None:
    SPOILT[how](idp)
    refused = _back(desk, _go(desk, idp))
    assert refused.status_code == 403
    assert "登录结果不可信" in refused.text
    assert SESSION_COOKIE not in desk.client.cookies
    assert not _is_in(desk)


@pytest.mark.parametrize("passed_s", [61.0, -3_600.0])  # the clock was ahead, and was set back
def test_a_new_key_is_fetched(desk: Browser, idp: FakeProvider, services: Services, passed_s: float) -> None:
    _back(desk, _go(desk, idp))
    desk.client.cookies.clear()
    idp.keys, idp.sign = [OTHER_KEY], lambda claims: idp.signed(claims, OTHER_KEY)
    services.clock.advance(passed_s)
    idp.now = services.clock().timestamp()
    _back(desk, _go(desk, idp))
    assert _is_in(desk)
    assert idp.asked.count("/keys") == 2


def test_a_key_that_was_withdrawn_is_believed_for_a_day(
    desk: Browser, idp: FakeProvider, services: Services
) -> None:
    """Also where nobody names another one: whoever stole it names this one."""
    _back(desk, _go(desk, idp))
    desk.client.cookies.clear()
    idp.keys = [OTHER_KEY]
    services.clock.advance(24 * 3600.0)
    idp.now = services.clock().timestamp()
    assert _back(desk, _go(desk, idp)).status_code == 403
    assert not _is_in(desk)


@pytest.mark.parametrize("spoil", [{"state": "x" * 43}, {"state": ""}, {"iss": "https://evil.example"}])
def test_an_answer_of_another_attempt_is_refused(
    desk: Browser, idp: FakeProvider, spoil: dict[str, str]
) -> None:
    assert _back(desk, _go(desk, idp) | spoil).status_code == 403
    assert not _is_in(desk)
    assert "/token" not in idp.asked


def test_an_answer_without_its_browser_is_refused(desk: Browser, idp: FakeProvider) -> None:
    answer = _go(desk, idp)
    desk.client.cookies.clear()
    assert _back(desk, answer).status_code == 403


def test_an_answer_of_another_provider_is_refused(desk: Browser, idp: FakeProvider) -> None:
    assert _back(desk, _go(desk, idp, "cas"), "campus").status_code == 403


@pytest.mark.parametrize("by", ["campus", "cas"])
def test_an_answer_counts_once(desk: Browser, idp: FakeProvider, by: str) -> None:
    answer = _go(desk, idp, by)
    kept = desk.client.cookies.get(AWAY_COOKIE)
    assert kept is not None
    _back(desk, answer, by)
    desk.client.cookies.clear()
    desk.client.cookies.set(AWAY_COOKIE, kept, domain="127.0.0.1", path="/enter")
    refused = _back(desk, answer, by)
    assert refused.status_code == 403
    assert "登录没有成功" in refused.text


def test_a_provider_that_says_no_is_told(desk: Browser, idp: FakeProvider) -> None:
    answer = _go(desk, idp)
    refused = _back(desk, {"state": answer["state"], "error": "access_denied"})
    assert refused.status_code == 403
    assert "登录没有成功" in refused.text


def test_a_ticket_for_another_address_is_refused(desk: Browser, idp: FakeProvider) -> None:
    answer = _go(desk, idp, "cas")
    idp.tickets[answer["ticket"]] = "https://elsewhere.example/"
    assert _back(desk, answer, "cas").status_code == 403


CAS_DECLARED = '<!DOCTYPE x [<!ENTITY e "li">]>' + CAS_SUCCESS.format(user="&e;", number="li")
CAS_ANSWERS = {
    "document type": CAS_DECLARED,
    "document type in UTF-16": "".join(f"{letter}\0" for letter in CAS_DECLARED.replace("王小明", "x")),
    "no XML": "yes\nli\n",
    "HTML": "<html></html>",
    "no user": CAS_SUCCESS.format(user="", number="li"),
    "another namespace": CAS_SUCCESS.format(user="li", number="li").replace("yale", "evil"),
    "both": CAS_SUCCESS.format(user="li", number="li").replace(
        "<cas:authenticationSuccess>",
        '<cas:authenticationFailure code="INVALID_TICKET"/><cas:authenticationSuccess>',
    ),
    "long": CAS_SUCCESS.format(user="li", number="li") + " " * 70_000,
}


@pytest.mark.parametrize("how", CAS_ANSWERS)
def test_a_cas_answer_that_is_none_lets_nobody_in(desk: Browser, idp: FakeProvider, how: str) -> None:
    idp.cas_answer = CAS_ANSWERS[how]
    assert _back(desk, _go(desk, idp, "cas"), "cas").status_code == 403
    assert not _is_in(desk)


def test_a_provider_that_is_down_leaves_the_token(
    desk: Browser, idp: FakeProvider, tokens: dict[str, str]
) -> None:
    idp.down = True
    refused = desk.get("/enter/with/campus")
    assert refused.status_code == 503
    assert "令牌一直有效" in refused.text
    assert desk.enter(token=tokens["li"]).status_code == 303
    assert _is_in(desk)


@pytest.mark.parametrize("next", ["//evil.example", "https://evil.example", "/\\evil", "javascript:x"])
def test_nobody_is_led_elsewhere(desk: Browser, idp: FakeProvider, next: str) -> None:
    assert 'content="0;url=/"' in _back(desk, _go(desk, idp, next=next)).text


def test_an_address_counts_when_it_is_verified(
    desk: Browser, idp: FakeProvider, services: Services, running: tuple[FastAPI, str]
) -> None:
    services.courses.import_roster("ros", [RosterEntry(id="li", name="", email="Li@Example.edu")], "setup")
    running[0].state.services = replace(services, providers=_providers(idp, services, claim="email"))
    idp.claims = {"email": "li@example.edu", "email_verified": False}
    assert 'action="/enter/bind"' in _back(desk, _go(desk, idp)).text
    idp.claims["email_verified"] = True
    _back(desk, _go(desk, idp))
    assert _is_in(desk)


def test_an_address_that_only_looks_alike_is_another_one(services: Services, tokens: dict[str, str]) -> None:
    """`\u212a` is the Kelvin sign, whose small letter is k: a mailbox that somebody else may have."""
    services.courses.import_roster("ros", [RosterEntry(id="li", name="", email="kai@example.edu")], "setup")
    services.identities.bind_claimed("campus", "another", email="\u212aai@example.edu")
    assert services.identities.of_member("ros", "li") == ()
    services.identities.bind_claimed("campus", "own", email="Kai@example.edu")
    assert [one.subject for one in services.identities.of_member("ros", "li")] == ["own"]


@pytest.mark.parametrize(
    ("peer", "headers", "status"),
    [
        ("10.0.0.5", [("X-Remote-User", "li")], 200),
        ("10.0.0.6", [("X-Remote-User", "li"), ("X-Forwarded-For", "10.0.0.5")], 403),
        ("10.0.0.5", [("X-Remote-User", "li"), ("X-Remote-User", "wang")], 403),
        ("10.0.0.5", [], 403),
        (None, [("X-Remote-User", "li")], 403),
    ],
)
def test_a_header_counts_from_the_proxy_alone(
    desk: Browser, running: tuple[FastAPI, str], peer: str | None, headers: list[tuple[str, str]], status: int
) -> None:
    async def app(scope, receive, send):
        await running[0]({**scope, **({} if peer is None else {PEER: (peer, 1)})}, receive, send)

    async def ask() -> httpx.Response:
        transport = httpx.ASGITransport(app=app)
        async with httpx.AsyncClient(transport=transport, base_url="http://127.0.0.1:1") as client:
            return await client.get("/enter/with/proxy", headers=[*headers, ("Accept", "text/html")])

    answer = asyncio.run(ask())
    assert answer.status_code == status
    assert (SESSION_COOKIE in answer.cookies) == (status == 200)


def test_a_binding_ends_with_its_sessions(
    desk: Browser, idp: FakeProvider, services: Services, tokens: dict[str, str]
) -> None:
    _back(desk, _go(desk, idp))
    (bound,) = services.identities.of_member("ros", "li")
    teacher = Browser(httpx.Client(base_url=desk.client.base_url, trust_env=False))
    teacher.enter(token=tokens["wang"])
    assert "sub-of-li" in teacher.get("/class/people/li").text
    asked = {"identity": bound.id}
    assert teacher.post("/class/people/li/unbind", asked, page="/class/people/li").status_code == 303
    assert not _is_in(desk)
    assert teacher.post("/class/people/li/unbind", asked, page="/class/people/li").status_code == 404
    teacher.client.close()


def test_a_removed_member_is_not_known_any_more(desk: Browser, idp: FakeProvider, services: Services) -> None:
    _back(desk, _go(desk, idp))
    services.courses.remove("ros", ["li"], "wang")
    assert not _is_in(desk)
    assert 'action="/enter/bind"' in _back(desk, _go(desk, idp)).text


def test_a_service_without_courses_sends_nobody_away(
    client: httpx.Client, running: tuple[FastAPI, str], services: Services, idp: FakeProvider
) -> None:
    running[0].state.services = replace(services, providers=_providers(idp, services))
    browser = Browser(client)
    assert browser.get("/enter/with/campus").status_code == 409
    assert "统一身份认证" not in browser.get("/enter").text


def test_who_was_recognised_is_forgotten_after_ten_minutes(
    desk: Browser, idp: FakeProvider, services: Services, tokens: dict[str, str]
) -> None:
    idp.user = "unknown"
    _back(desk, _go(desk, idp))
    services.clock.advance(timedelta(minutes=11).total_seconds())
    late = desk.post("/enter/bind", {"token": tokens["li"]}, page="/enter")
    assert late.status_code == 403
    assert "已经失效" in late.text


def test_the_server_knows_its_peer_whatever_proxies_say() -> None:
    seen = []

    async def app(scope, receive, send):
        seen.append((scope[PEER], scope["client"][0], scope["scheme"]))

    scope = {
        "type": "http",
        "client": ("127.0.0.1", 5),
        "scheme": "http",
        "headers": [(b"x-forwarded-for", b"10.0.0.5"), (b"x-forwarded-proto", b"https")],
    }
    asyncio.run(behind_proxies(app)(scope, None, None))
    asyncio.run(behind_proxies(app)({**scope, "client": ("192.0.2.1", 5)}, None, None))
    assert seen == [(("127.0.0.1", 5), "10.0.0.5", "https"), (("192.0.2.1", 5), "192.0.2.1", "http")]
