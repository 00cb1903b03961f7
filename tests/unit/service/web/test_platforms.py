"""Launches from a learning platform: 1EdTech's certification list for tools, and what else must not get in."""

import base64
import hashlib
import hmac
import json
from collections.abc import Callable
from dataclasses import replace
from datetime import timedelta
from typing import Any
from urllib.parse import parse_qsl, urlsplit

import httpx
import pytest
from fastapi import FastAPI
from joserfc import jws, jwt

from grader.contracts.assignment import Assignment
from grader.contracts.errors import RefusedError
from grader.contracts.identity import Role, RosterEntry
from grader.contracts.platform import Platform
from grader.outside.lti import Launches
from grader.outside.lti.launch import CLAIM
from grader.outside.signin import Providers
from grader.service.web.access import SESSION_COOKIE
from grader.service.web.platforms import COOKIE
from grader.store.audit import Signature
from grader.use_cases.services import Services
from tests.fakes.platforms import PLATFORM_CLIENT as CLIENT
from tests.fakes.platforms import PLATFORM_ID as ISSUER
from tests.fakes.platforms import new_platform
from tests.fakes.provider import RSA, FakeProvider
from tests.unit.service.web.conftest import Browser
from tests.unit.service.web.test_signing_in import OTHER_KEY

SCORES = "https://purl.imsglobal.org/spec/lti-ags/"
Claims = dict[str, Any]


@pytest.fixture
def moodle(listening: FakeProvider) -> FakeProvider:
    listening.keys, listening.sign = [RSA], listening.signed
    return listening


@pytest.fixture
def ready(
    running: tuple[FastAPI, str], client: httpx.Client, services: Services, tokens: dict[str, str]
) -> Services:
    """Services that know their own address; platforms may be on this machine."""
    made = replace(
        services,
        providers=Providers(public_url="https://grader.example.edu"),
        launches=Launches(lambda: services.clock().timestamp(), private=True),
    )
    running[0].state.services = made
    return made


@pytest.fixture
def platform(ready: Services, moodle: FakeProvider) -> Platform:
    return add_platform(ready, moodle)


def add_platform(
    services: Services, moodle: FakeProvider, course: str = "ros", by: str = "wang", **changed: str
) -> Platform:
    """Add the platform whose keys are those of `moodle`."""
    new = new_platform(**{"keys_url": f"{moodle.address}/keys", **changed})
    return services.platforms.add(new, Signature(services.clock(), course, by))


def login(client: httpx.Client, **changed: str | None) -> dict[str, str]:
    """Open an activity: return what the platform is asked."""
    said = {
        "iss": ISSUER,
        "target_link_uri": "https://grader.example.edu/",
        "login_hint": "3",
        "lti_message_hint": "7",
        "client_id": CLIENT,
        "lti_deployment_id": "1",
    }
    fields = {name: value for name, value in (said | changed).items() if value is not None}
    sent = client.post("/lti/login", data=fields, follow_redirects=False)
    assert sent.status_code == 303, sent.text
    cookie = sent.headers["set-cookie"].lower()
    assert "samesite=none" in cookie
    assert "secure" in cookie
    assert "httponly" in cookie
    where = sent.headers["Location"]
    assert where.startswith(f"{ISSUER}/mod/lti/auth.php?")
    # the client would not send a secure cookie over http, as a browser does to its own machine
    client.cookies.set(COOKIE, sent.cookies[COOKIE], domain="127.0.0.1", path="/lti")
    return dict(parse_qsl(urlsplit(where).query))


def message(asked: dict[str, str], now_s: float, **changed: Any) -> Claims:
    """What Moodle says of a student who opens an activity."""
    claims: Claims = {
        "iss": ISSUER,
        "aud": CLIENT,
        "sub": "3",
        "iat": int(now_s),
        "exp": int(now_s) + 60,
        "nonce": asked["nonce"],
        f"{CLAIM}version": "1.3.0",
        f"{CLAIM}deployment_id": "1",
        f"{CLAIM}message_type": "LtiResourceLinkRequest",
        f"{CLAIM}target_link_uri": "https://grader.example.edu/",
        f"{CLAIM}roles": ["http://purl.imsglobal.org/vocab/lis/v2/membership#Learner"],
        f"{CLAIM}resource_link": {"id": "1", "title": "走正方形", "description": ""},
        f"{CLAIM}custom": {"assignment": "square", "idnumber": "li"},
        f"{SCORES}claim/endpoint": {"scope": [f"{SCORES}scope/score"], "lineitem": f"{ISSUER}/li?type_id=1"},
    }
    for name, value in changed.items():
        key = {
            "version",
            "deployment_id",
            "message_type",
            "roles",
            "resource_link",
            "custom",
            "lis",
            "context",
        }
        claims[f"{CLAIM}{name}" if name in key else name] = value
    return {name: value for name, value in claims.items() if value is not ...}


def launch(client: httpx.Client, token: str, state: str) -> httpx.Response:
    accept = {"Accept": "text/html"}
    return client.post("/lti/launch", data={"id_token": token, "state": state}, headers=accept)


def open_activity(
    client: httpx.Client, moodle: FakeProvider, services: Services, **changed: Any
) -> httpx.Response:
    asked = login(client)
    token = moodle.sign(message(asked, services.clock().timestamp(), **changed))
    return launch(client, token, asked["state"])


def test_a_student_comes_in_and_lands_at_the_assignment(
    client: httpx.Client, moodle: FakeProvider, ready: Services, platform: Platform
) -> None:
    asked = login(client)
    assert asked | {"state": "", "nonce": ""} == {
        "scope": "openid",
        "response_type": "id_token",
        "response_mode": "form_post",
        "prompt": "none",
        "client_id": CLIENT,
        "redirect_uri": "https://grader.example.edu/lti/launch",
        "login_hint": "3",
        "lti_message_hint": "7",
        "state": "",
        "nonce": "",
    }
    answer = launch(client, moodle.sign(message(asked, ready.clock().timestamp())), asked["state"])
    assert answer.status_code == 200
    assert 'content="0;url=/assignments/square"' in answer.text
    assert client.get("/submissions", follow_redirects=False).status_code == 200
    (link,) = ready.platforms.links("ros")
    assert (link.title, link.assignment, link.line_item) == ("走正方形", "square", f"{ISSUER}/li?type_id=1")
    (bound,) = ready.identities.of_member("ros", "li")
    assert (bound.provider, bound.subject, bound.by_token) == (platform.provider, "3", False)


ACCEPTED: dict[str, Claims] = {
    "several roles": {"roles": ["http://purl.imsglobal.org/vocab/lis/v2/membership#Learner", "x#Mentor"]},
    "short role": {"roles": ["Learner"]},
    "unknown role": {"roles": ["http://example.org/Unknown"]},
    "no roles": {"roles": []},
    "a teacher": {"roles": ["http://purl.imsglobal.org/vocab/lis/v2/membership#Instructor"]},
    "e-mail": {"email": "li@example.edu"},
    "names": {"name": "小明 王", "given_name": "小明", "family_name": "王"},
    "sourcedid": {"lis": {"person_sourcedid": "li"}, "custom": {}},
    "user name": {"custom": {"username": "li", "idnumber": ""}},
    "audience a list": {"aud": [CLIENT]},
    "several audiences": {"aud": [CLIENT, "x"], "azp": CLIENT},
    "nothing of the person": {"custom": {"assignment": "square", "username": "li"}, "roles": []},
    "a name of one part": {"family_name": "王"},
    "context": {"context": {"id": "2", "label": "ROS2", "title": "机器人", "type": ["CourseSection"]}},
    "e-mail without context": {"email": "li@example.edu", "context": ...},
    "no context": {"context": ...},
    "unknown claims": {"https://example.org/x": {"y": [1, None]}},
}


@pytest.mark.parametrize("how", ACCEPTED)
def test_who_is_a_student_of_the_list_is_let_in(
    client: httpx.Client, moodle: FakeProvider, ready: Services, platform: Platform, how: str
) -> None:
    assert open_activity(client, moodle, ready, **ACCEPTED[how]).status_code == 200
    assert client.get("/submissions", follow_redirects=False).status_code == 200
    assert client.get("/class", follow_redirects=False).status_code == 403  # a role is never believed


TEACHERS: dict[str, Claims] = {
    "plain": {},
    "several roles": {
        "roles": [
            "http://purl.imsglobal.org/vocab/lis/v2/membership#Instructor",
            "http://purl.imsglobal.org/vocab/lis/v2/institution/person#Faculty",
        ]
    },
    "short role": {"roles": ["Instructor"]},
    "unknown role": {"roles": ["http://example.org/Unknown"]},
    "no roles": {"roles": []},
    "called a student": {"roles": ["Learner"]},
    "only e-mail": {"email": "wang@example.edu"},
    "only names": {"name": "王", "given_name": "", "family_name": "王"},
    "e-mail without context": {"email": "wang@example.edu", "context": ...},
}


@pytest.mark.parametrize("how", TEACHERS)
def test_who_teaches_by_the_list_is_let_in_as_a_teacher(
    client: httpx.Client,
    moodle: FakeProvider,
    ready: Services,
    platform: Platform,
    tokens: dict[str, str],
    how: str,
) -> None:
    """Nobody becomes a teacher by what a platform says: who is one has shown a token once."""
    assert 'action="/enter/bind"' in open_activity(client, moodle, ready, custom={"idnumber": "wang"}).text
    Browser(client).post("/enter/bind", {"token": tokens["wang"], "next": "/class"}, page="/enter")
    client.cookies.clear()
    said = {"roles": ["http://purl.imsglobal.org/vocab/lis/v2/membership#Instructor"], "custom": {}}
    assert open_activity(client, moodle, ready, **(said | TEACHERS[how])).status_code == 200
    assert client.get("/class", follow_redirects=False).status_code == 200


@pytest.mark.parametrize("claimed", [("li", "han"), ("han", "li")])
def test_whoever_claims_to_be_two_students_shows_a_token(
    client: httpx.Client, moodle: FakeProvider, ready: Services, platform: Platform, claimed: tuple[str, str]
) -> None:
    """A platform may let people write one of the fields themselves, as Moodle does with the ID number."""
    number, name = claimed
    said = {"lis": {"person_sourcedid": number}, "custom": {"username": name}}
    assert 'action="/enter/bind"' in open_activity(client, moodle, ready, **said).text
    assert ready.identities.of_member("ros", "li") == ready.identities.of_member("ros", "han") == ()
    alone = {"lis": {"person_sourcedid": number}, "custom": {"username": "unknown"}}
    assert 'action="/enter/bind"' not in open_activity(client, moodle, ready, **alone).text


REFUSED: dict[str, Claims] = {
    "wrong version": {"version": "1.1"},
    "no version": {"version": ...},
    "no LTI message": {
        "version": ...,
        "message_type": ...,
        "deployment_id": ...,
        "roles": ...,
        "resource_link": ...,
    },
    "of the future": {"iat": 9_999_999_999},
    "expired": {"exp": 1},
    "issued long ago": {"iat": 1},
    "no iat": {"iat": ...},
    "no message type": {"message_type": ...},
    "another message type": {"message_type": "LtiSubmissionReviewRequest"},
    "no roles": {"roles": ...},
    "roles a text": {"roles": "Learner"},
    "no deployment": {"deployment_id": ...},
    "another deployment": {"deployment_id": "2"},
    "no resource link": {"resource_link": ...},
    "no resource link id": {"resource_link": {"title": "x"}},
    "no subject": {"sub": ...},
    "a subject that cannot be stored": {"sub": "3\0"},
    "a resource of 256 characters": {"resource_link": {"id": "x" * 256}},
    "no end": {"exp": ...},
    "an end that no calendar has": {"exp": 1e300},
    "an end that is no number": {"exp": float("nan")},
    "another nonce": {"nonce": "x" * 43},
    "no nonce": {"nonce": ...},
    "another issuer": {"iss": "https://evil.example"},
    "no issuer": {"iss": ...},
    "no audience": {"aud": ...},
    "another client": {"aud": "other"},
    "audiences without azp": {"aud": [CLIENT, "x"]},
    "authorized for another": {"azp": "other"},
}


@pytest.mark.parametrize("how", REFUSED)
def test_a_message_that_lacks_something_lets_nobody_in(
    client: httpx.Client, moodle: FakeProvider, ready: Services, platform: Platform, how: str
) -> None:
    refused = open_activity(client, moodle, ready, **REFUSED[how])
    assert refused.status_code == 403
    assert "登录结果不可信" in refused.text
    assert SESSION_COOKIE not in client.cookies
    assert ready.platforms.links("ros") == ()


def parts_naming(algorithm: str, claims: Claims) -> str:
    """The first two parts of a message, which names a key that the platform has."""
    parts = (json.dumps(one).encode() for one in ({"alg": algorithm, "kid": "first"}, claims))
    return ".".join(base64.urlsafe_b64encode(one).decode().rstrip("=") for one in parts)


def signed_with(secret: bytes, claims: Claims) -> str:
    body = parts_naming("HS256", claims)
    mac = hmac.digest(secret, body.encode(), hashlib.sha256)
    return f"{body}.{base64.urlsafe_b64encode(mac).decode().rstrip('=')}"


def changed_after_signing(moodle: FakeProvider, claims: Claims) -> str:
    head, _, mac = moodle.signed(claims).split(".")
    said = base64.urlsafe_b64encode(json.dumps(claims | {"sub": "4"}).encode()).decode().rstrip("=")
    return f"{head}.{said}.{mac}"


SIGNED: dict[str, Callable[[FakeProvider, Claims], str]] = {
    "alg none": lambda moodle, claims: moodle.unsigned(claims),
    "HS256 with the public key": lambda moodle, claims: moodle.by_secret(claims),
    "a key of nobody's": lambda moodle, claims: moodle.signed(claims, OTHER_KEY),
    "a key of nobody's under a known id": lambda moodle, claims: jws.serialize_compact(
        {"alg": "RS256", "kid": "first"}, json.dumps(claims), OTHER_KEY
    ),
    "the right key under a wrong id": lambda moodle, claims: jws.serialize_compact(
        {"alg": "RS256", "kid": "third"}, json.dumps(claims), RSA
    ),
    "alg none with a known id": lambda moodle, claims: parts_naming("none", claims) + ".",
    "HS256 with the public key as bytes": lambda moodle, claims: signed_with(
        RSA.as_der(private=False), claims
    ),
    "a changed message": changed_after_signing,
    "no key id": lambda moodle, claims: jwt.encode({"alg": "RS256"}, claims, RSA),
    "another algorithm": lambda moodle, claims: jwt.encode(
        {"alg": "RS512", "kid": "first"}, claims, RSA, algorithms=["RS512"]
    ),
    "no message": lambda moodle, claims: "x.y.z",
}


@pytest.mark.parametrize("how", SIGNED)
def test_a_message_that_the_platform_did_not_sign_lets_nobody_in(
    client: httpx.Client, moodle: FakeProvider, ready: Services, platform: Platform, how: str
) -> None:
    asked = login(client)
    token = SIGNED[how](moodle, message(asked, ready.clock().timestamp()))
    assert launch(client, token, asked["state"]).status_code == 403
    assert SESSION_COOKIE not in client.cookies


def test_a_token_that_cannot_be_read_lets_nobody_in(
    client: httpx.Client, ready: Services, moodle: FakeProvider, platform: Platform
) -> None:
    deep = base64.urlsafe_b64encode(b'{"alg":"RS256","kid":"first","x":' + b"[" * 40_000).decode().rstrip("=")
    for token in (f"{deep}.e30.x", "\0", "\0.\0.\0", "é.é.é", "e30.e30.e30", "." * 1_000):
        asked = login(client)
        assert launch(client, token, asked["state"]).status_code == 403, token[:20]


@pytest.mark.parametrize(
    "changed",
    [{"nonce": "\ud800"}, {"aud": [["x"]]}, {"sub": "\ud800"}, {"exp": 10**30}, {"deployment_id": "\ud800"}],
)
def test_a_message_of_no_text_lets_nobody_in(
    client: httpx.Client,
    ready: Services,
    moodle: FakeProvider,
    platform: Platform,
    changed: dict[str, Any],
) -> None:
    assert open_activity(client, moodle, ready, **changed).status_code == 403


def test_a_message_counts_once(
    client: httpx.Client, moodle: FakeProvider, ready: Services, platform: Platform
) -> None:
    asked = login(client)
    kept = client.cookies[COOKIE]
    token = moodle.sign(message(asked, ready.clock().timestamp()))
    assert launch(client, token, asked["state"]).status_code == 200
    client.cookies.clear()
    client.cookies.set(COOKIE, kept, domain="127.0.0.1", path="/lti")
    assert launch(client, token, asked["state"]).status_code == 403
    assert SESSION_COOKIE not in client.cookies


@pytest.mark.parametrize("state", ["", "x" * 43])
def test_a_foreign_state_is_refused(
    client: httpx.Client, moodle: FakeProvider, ready: Services, platform: Platform, state: str
) -> None:
    token = moodle.sign(message(login(client), ready.clock().timestamp()))
    assert launch(client, token, state).status_code == 403


def test_a_message_answers_its_own_login_alone(
    client: httpx.Client, moodle: FakeProvider, ready: Services, platform: Platform
) -> None:
    """Whoever took a message cannot bring it with a login, a state and a cookie that are all good."""
    taken = moodle.sign(message(login(client), ready.clock().timestamp()))
    client.cookies.clear()
    asked = login(client)
    assert launch(client, taken, asked["state"]).status_code == 403
    assert SESSION_COOKIE not in client.cookies


@pytest.mark.parametrize("with_login", [True, False])
def test_another_browser_is_refused(
    client: httpx.Client, moodle: FakeProvider, ready: Services, platform: Platform, *, with_login: bool
) -> None:
    asked = login(client)
    token = moodle.sign(message(asked, ready.clock().timestamp()))
    client.cookies.clear()
    if with_login:
        login(client)
    assert launch(client, token, asked["state"]).status_code == 403
    assert SESSION_COOKIE not in client.cookies


def test_a_key_that_the_platform_withdrew_counts_no_more(
    client: httpx.Client, moodle: FakeProvider, ready: Services, platform: Platform
) -> None:
    assert open_activity(client, moodle, ready).status_code == 200
    moodle.keys, moodle.sign = [OTHER_KEY], lambda claims: moodle.signed(claims, OTHER_KEY)
    ready.clock.advance(61.0)
    assert open_activity(client, moodle, ready).status_code == 200
    client.cookies.clear()
    moodle.sign = moodle.signed
    assert open_activity(client, moodle, ready).status_code == 403


def test_unknown_key_ids_ask_for_keys_once_a_minute(
    client: httpx.Client, moodle: FakeProvider, ready: Services, platform: Platform
) -> None:
    moodle.sign = lambda claims: moodle.signed(claims, OTHER_KEY)
    moodle.asked.clear()
    assert [open_activity(client, moodle, ready).status_code for _ in range(3)] == [403] * 3
    assert moodle.asked == ["/keys"]
    ready.clock.advance(61.0)
    assert open_activity(client, moodle, ready).status_code == 403
    assert moodle.asked == ["/keys"] * 2


def test_new_keys_of_the_platform_are_fetched(
    client: httpx.Client, moodle: FakeProvider, ready: Services, platform: Platform
) -> None:
    assert open_activity(client, moodle, ready).status_code == 200
    moodle.keys, moodle.sign = [OTHER_KEY], lambda claims: moodle.signed(claims, OTHER_KEY)
    ready.clock.advance(61.0)
    assert open_activity(client, moodle, ready).status_code == 200


def test_the_same_name_on_two_platforms_is_two_people(
    client: httpx.Client, moodle: FakeProvider, ready: Services, platform: Platform
) -> None:
    second = add_platform(ready, moodle, issuer="https://canvas.example.edu")
    assert open_activity(client, moodle, ready).status_code == 200
    assert ready.identities.of_subject(second.provider, "3") == ()


def test_whoever_fits_nobody_is_asked_for_a_token_once(
    client: httpx.Client, moodle: FakeProvider, ready: Services, platform: Platform, tokens: dict[str, str]
) -> None:
    asked = open_activity(client, moodle, ready, custom={"assignment": "square", "idnumber": "nobody"})
    assert 'action="/enter/bind"' in asked.text
    desk = Browser(client)
    done = desk.post("/enter/bind", {"token": tokens["wang"], "next": "/class"}, page="/enter")
    assert "url=/class" in done.text
    client.cookies.clear()
    again = open_activity(client, moodle, ready, custom={"idnumber": "nobody"})
    assert 'http-equiv="refresh"' in again.text
    assert client.get("/class").status_code == 200


def test_a_platform_opens_no_other_course(
    client: httpx.Client, moodle: FakeProvider, ready: Services, platform: Platform
) -> None:
    """Who teaches a course can sign what its platform says, so also in the name of whoever is bound there."""
    ready.courses.create("second", "Zweiter Kurs", "Asia/Shanghai", "setup")
    ready.courses.import_roster("second", [RosterEntry(id="w", name="", role=Role.INSTRUCTOR)], "setup")
    _, token = ready.tokens.issue("second", "w", timedelta(days=1), "setup")
    open_activity(client, moodle, ready, custom={"idnumber": "nobody"})
    refused = Browser(client).post("/enter/bind", {"token": token, "next": "/class"}, page="/enter")
    assert refused.status_code == 403
    assert SESSION_COOKIE not in client.cookies
    assert ready.identities.of_subject(platform.provider, "3") == ()


def test_who_is_away_while_the_platform_is_removed_begins_again(
    client: httpx.Client, moodle: FakeProvider, ready: Services, platform: Platform, tokens: dict[str, str]
) -> None:
    open_activity(client, moodle, ready, custom={"idnumber": "nobody"})
    assert ready.platforms.remove(platform.id, Signature(ready.clock(), "ros", "wang"))
    refused = Browser(client).post("/enter/bind", {"token": tokens["wang"]}, page="/enter")
    assert refused.status_code == 403
    assert ready.identities.of_subject(platform.provider, "3") == ()


def test_a_title_of_several_lines_is_one_line(
    client: httpx.Client, moodle: FakeProvider, ready: Services, platform: Platform
) -> None:
    resource = {"id": "1", "title": "走\u3000正方\n形\0"}
    assert open_activity(client, moodle, ready, resource_link=resource).status_code == 200
    assert [one.title for one in ready.platforms.links("ros")] == ["走 正方 形"]


def test_a_platform_knows_an_unknown_assignment_leads_to_all(
    client: httpx.Client, moodle: FakeProvider, ready: Services, platform: Platform
) -> None:
    answer = open_activity(client, moodle, ready, custom={"assignment": "//evil", "idnumber": "li"})
    assert 'content="0;url=/"' in answer.text


def test_an_unknown_platform_and_its_refusal_are_pages(client: httpx.Client, ready: Services) -> None:
    accept = {"Accept": "text/html"}
    unknown = client.post("/lti/login", data={"iss": ISSUER, "login_hint": "3"}, headers=accept)
    assert (unknown.status_code, "不认识这个学习平台" in unknown.text) == (403, True)


def test_a_refusal_of_the_platform_is_a_page(
    client: httpx.Client, moodle: FakeProvider, ready: Services, platform: Platform
) -> None:
    asked = login(client)
    said = {"error": "login_required", "state": asked["state"]}
    refused = client.post("/lti/launch", data=said, headers={"Accept": "text/html"})
    assert (refused.status_code, "登录没有成功" in refused.text) == (403, True)


def test_platforms_may_leave_out_whom_they_ask(client: httpx.Client, platform: Platform) -> None:
    assert login(client, client_id=None, lti_deployment_id=None, lti_message_hint=None)["client_id"] == CLIENT


def test_in_a_frame_a_window_is_offered(client: httpx.Client, platform: Platform) -> None:
    asked = {"iss": ISSUER, "login_hint": "3", "lti_message_hint": '"><script>'}
    shown = client.get(
        "/lti/login", params=asked, headers={"Sec-Fetch-Dest": "iframe", "Accept": "text/html"}
    )
    assert shown.status_code == 200
    assert '<base target="_blank">' in shown.text  # nothing else of ours opens in a frame
    assert "<script>" not in shown.text
    assert f"frame-ancestors {ISSUER}" in shown.headers["Content-Security-Policy"]
    assert COOKIE not in shown.cookies


def test_whoever_has_no_token_is_told_to_come_by_the_platform(
    client: httpx.Client, ready: Services, platform: Platform
) -> None:
    assert "重新点开活动" in client.get("/enter").text
    assert ready.platforms.remove(platform.id, Signature(ready.clock(), "ros", "wang"))
    assert "重新点开活动" not in client.get("/enter").text


def test_the_instructors_page(
    client: httpx.Client, ready: Services, tokens: dict[str, str], moodle: FakeProvider
) -> None:
    desk = Browser(client)
    desk.enter(token=tokens["wang"])
    fields = {
        "title": "Moodle",
        "issuer": ISSUER,
        "client_id": CLIENT,
        "deployment": "1",
        "login_url": f"{ISSUER}/auth",
        "token_url": f"{ISSUER}/token",
        "keys_url": "http://moodle.example.edu/keys",
    }
    page = "/class/platforms"
    wrong = desk.post(page, fields)
    assert wrong.status_code == 422
    assert 'id="keys_url" name="keys_url" value="http://moodle.example.edu/keys"' in wrong.text
    fields["keys_url"] = f"{ISSUER}/keys"
    assert desk.post(page, fields).status_code == 303
    assert desk.post(page, fields).status_code == 409
    shown = desk.get(page).text
    assert "https://grader.example.edu/lti/login" in shown
    (known,) = ready.platforms.of_course("ros")
    assert desk.post(page + "/remove", {"platform": known.id}, page=page).status_code == 303
    assert desk.post(page + "/remove", {"platform": known.id}, page=page).status_code == 404
    actions = [entry.action for entry in ready.audit.entries("ros", 10)]
    assert actions[:2] == ["platform.remove", "platform.add"]


def test_who_came_by_a_removed_platform_is_out(
    client: httpx.Client, moodle: FakeProvider, ready: Services, platform: Platform
) -> None:
    open_activity(client, moodle, ready)
    assert ready.platforms.remove(platform.id, Signature(ready.clock(), "ros", "wang"))
    assert client.get("/submissions", follow_redirects=False).status_code == 303


def test_a_platform_in_a_private_network_is_asked_nothing(
    client: httpx.Client,
    running: tuple[FastAPI, str],
    moodle: FakeProvider,
    ready: Services,
    platform: Platform,
) -> None:
    launches = Launches(lambda: ready.clock().timestamp(), private=False)
    running[0].state.services = replace(ready, launches=launches)
    moodle.asked.clear()
    assert open_activity(client, moodle, ready).status_code == 503
    assert moodle.asked == []


class WithOwn:
    """Assignments where one course has one more than the shipped ones: what it uploaded itself."""

    def __init__(self, shipped: Any, course: str, own: Assignment) -> None:
        self._shipped, self._course, self._own = shipped, course, own

    def of(self, course: str | None) -> Any:
        return self if course == self._course else self._shipped

    def all(self) -> tuple[Assignment, ...]:
        return (*self._shipped.all(), self._own)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._shipped, name)


@pytest.mark.parametrize(("course", "leads_to"), [("ros", "walk"), ("other", "")])
def test_a_link_leads_to_what_its_own_course_uploaded(
    running: tuple[FastAPI, str],
    client: httpx.Client,
    moodle: FakeProvider,
    ready: Services,
    platform: Platform,
    course: str,
    leads_to: str,
) -> None:
    own = replace(ready.assignments.get("square"), id="walk")
    made = replace(ready, assignments=WithOwn(ready.assignments, course, own))
    running[0].state.services = made
    open_activity(client, moodle, made, custom={"assignment": "walk", "idnumber": "li"})
    assert [link.assignment for link in made.platforms.links("ros")] == [leads_to]


def test_another_course_may_use_the_same_platform_and_cannot_be_in_the_way(
    client: httpx.Client, moodle: FakeProvider, ready: Services, platform: Platform
) -> None:
    """Moodle names no deployment at the login. The other course has one of its own, added by its instructor."""
    ready.courses.create("other", "Other", "UTC", "zhao")
    add_platform(ready, moodle, "other", "zhao", deployment="2")
    asked = login(client, lti_deployment_id=None)
    token = moodle.sign(message(asked, ready.clock().timestamp()))
    assert 'content="0;url=/assignments/square"' in launch(client, token, asked["state"]).text
    assert [link.title for link in ready.platforms.links("ros")] == ["走正方形"]
    asked = login(client, lti_deployment_id=None)
    launch(client, moodle.sign(message(asked, ready.clock().timestamp(), deployment_id="2")), asked["state"])
    assert len(ready.platforms.links("ros")) == 1  # that activity is the other course's
    assert len(ready.platforms.links("other")) == 1


@pytest.mark.parametrize("name", ["login_url", "token_url", "keys_url"])
def test_another_deployment_cannot_lead_elsewhere(
    ready: Services, moodle: FakeProvider, platform: Platform, name: str
) -> None:
    changed = {"deployment": "2", name: "https://elsewhere.example.edu/"}
    with pytest.raises(RefusedError) as refused:
        add_platform(ready, moodle, "other", "zhao", **changed)
    assert refused.value.code == "platform_differs"
