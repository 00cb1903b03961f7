"""Choosing what a learning platform makes activities of: 1EdTech's Deep Linking, as platforms ask for it."""

import re
from datetime import timedelta
from typing import Any

import httpx
import pytest
from joserfc import jwt
from joserfc.jwk import KeySet

from grader.contracts.identity import Role, RosterEntry
from grader.contracts.platform import Platform
from grader.outside.lti.launch import CLAIM
from grader.service.web.access import SESSION_COOKIE
from grader.service.web.picking import OPENED
from grader.store.audit import Signature
from grader.store.identities import Identities
from grader.use_cases.services import Services
from tests.fakes.platforms import PLATFORM_CLIENT as CLIENT
from tests.fakes.platforms import PLATFORM_ID as ISSUER
from tests.fakes.provider import FakeProvider
from tests.unit.service.web.test_platforms import (
    Claims,
    login,
    message,
    moodle,
    platform,
    ready,
)

__all__ = ("moodle", "platform", "ready")  # fixtures
DEEP = "https://purl.imsglobal.org/spec/lti-dl/claim/"
PICK = "https://grader.example.edu/lti/pick"
BACK = f"{ISSUER}/mod/lti/contentitem_return.php?course=2&sesskey=x"
SETTINGS = {
    "deep_link_return_url": BACK,
    "accept_types": ["link", "ltiResourceLink"],
    "accept_presentation_document_targets": ["frame", "iframe", "window"],
    "accept_multiple": True,
    "data": "csrf:7 ü",
}


def asked(
    client: httpx.Client, moodle: FakeProvider, services: Services, settings: Any = None, **changed: Any
) -> httpx.Response:
    """Come as somebody who is to choose, in a frame of the platform's page."""
    said = login(client, target_link_uri=PICK)
    claims = message(
        said,
        services.clock().timestamp(),
        message_type="LtiDeepLinkingRequest",
        resource_link=...,
        **{"custom": {}, "sub": "9"} | changed,
    )
    claims[f"{DEEP}deep_linking_settings"] = SETTINGS if settings is None else settings
    fields = {"id_token": moodle.sign(claims), "state": said["state"]}
    page = {"Accept": "text/html"}
    went = client.post("/lti/launch", data=fields, headers=page, follow_redirects=False)
    if went.status_code != 303:
        return went
    where = went.headers["Location"]
    # the client would not send a secure cookie over http, as a browser does to its own machine
    client.cookies.set(OPENED, went.cookies[OPENED], domain="127.0.0.1", path=where)
    return client.get(where, headers=page)


def token_of(services: Services, person: str) -> str:
    return services.tokens.issue("ros", person, timedelta(days=1), "test")[1]


def form_of(page: httpx.Response) -> tuple[str, dict[str, str]]:
    """Return where the form of a page goes, and its hidden fields."""
    (action,) = re.findall(r'<form method="post" action="([^"]*)"[^>]*data-send', page.text)
    return action.replace("&amp;", "&"), dict(
        re.findall(r'<input type="hidden" name="([^"]*)" value="([^"]*)"', page.text)
    )


@pytest.fixture
def at_desk(
    client: httpx.Client, moodle: FakeProvider, ready: Services, platform: Platform, tokens: dict[str, str]
) -> httpx.Response:
    """The page of an instructor who has shown their token."""
    first = asked(client, moodle, ready)
    path = first.url.path
    went = client.post(f"{path}/token", data={"token": tokens["wang"]}, follow_redirects=False)
    assert (went.status_code, went.headers["Location"]) == (303, path)
    return client.get(path)


def answered(services: Services, page: httpx.Response) -> Claims:
    """Return what the platform is told, checked by the keys that the service tells."""
    where, fields = form_of(page)
    assert where == BACK
    keys = KeySet.import_key_set(services.platform_channel.public_keys())
    return dict(jwt.decode(fields["JWT"], keys, algorithms=["RS256"]).claims)


def test_an_instructor_makes_three_activities(
    client: httpx.Client, ready: Services, at_desk: httpx.Response
) -> None:
    assert 'type="checkbox" name="assignment" value="square"' in at_desk.text
    chosen = {"assignment": ["square", "hello", "spin"]}
    page = client.post(at_desk.url.path, data=chosen, headers={"Accept": "text/html"})
    claims = answered(ready, page)
    items = claims.pop(f"{DEEP}content_items")
    now_s = int(ready.clock().timestamp())
    assert claims.pop("nonce")
    assert claims == {
        "iss": CLIENT,
        "aud": [ISSUER],
        "iat": now_s,
        "exp": now_s + 300,
        f"{CLAIM}message_type": "LtiDeepLinkingResponse",
        f"{CLAIM}version": "1.3.0",
        f"{CLAIM}deployment_id": "1",
        f"{DEEP}data": "csrf:7 ü",
    }
    assert {item["custom"]["assignment"] for item in items} == {"square", "hello", "spin"}
    square = next(item for item in items if item["custom"]["assignment"] == "square")
    title = ready.assignments.get("square").title.zh
    assert square == {
        "type": "ltiResourceLink",
        "title": title,
        "url": "https://grader.example.edu/",
        "custom": {"assignment": "square"},
        "window": {"targetName": "_blank"},
        "lineItem": {"scoreMaximum": 100.0, "label": title, "resourceId": "square"},
    }


def test_the_frame_is_the_platforms_alone_and_opens_nothing_else(
    client: httpx.Client, at_desk: httpx.Response
) -> None:
    assert f"frame-ancestors {ISSUER};" in at_desk.headers["Content-Security-Policy"] + ";"
    page = client.post(at_desk.url.path, data={"assignment": "hello"}, headers={"Accept": "text/html"})
    policy = page.headers["Content-Security-Policy"]
    assert f"frame-ancestors {ISSUER}" in policy
    assert f"form-action {ISSUER}" in policy
    assert SESSION_COOKIE not in client.cookies
    assert client.get("/submissions", follow_redirects=False).status_code in (303, 401)


@pytest.mark.parametrize("data", ["\ud800", "x" * 8_000, [0] * 4_001])
def test_what_cannot_be_given_back_is_not_asked_for(
    client: httpx.Client, moodle: FakeProvider, ready: Services, platform: Platform, data: object
) -> None:
    assert asked(client, moodle, ready, SETTINGS | {"data": data}).status_code == 403


@pytest.mark.parametrize("data", ["\0", 7, {"csrf": ["x", None]}, [], False])
def test_whatever_else_was_sent_along_is_given_back(
    client: httpx.Client, moodle: FakeProvider, ready: Services, at_desk: httpx.Response, data: object
) -> None:
    page = asked(client, moodle, ready, SETTINGS | {"data": data})
    claims = answered(ready, client.post(page.url.path, data={"assignment": "square"}))
    assert claims[f"{DEEP}data"] == data


def test_who_comes_to_choose_while_the_platform_is_removed_is_refused(
    client: httpx.Client,
    moodle: FakeProvider,
    ready: Services,
    platform: Platform,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    whole = Identities.bind_claimed

    def removed(*args: Any, **named: Any) -> None:
        assert ready.platforms.remove(platform.id, Signature(ready.clock(), "ros", "wang"))
        whole(*args, **named)

    monkeypatch.setattr(Identities, "bind_claimed", removed)
    assert asked(client, moodle, ready).status_code == 403


def test_in_a_frame_only_the_choice_stays_there(client: httpx.Client, platform: Platform) -> None:
    framed = {"Sec-Fetch-Dest": "iframe", "Accept": "text/html"}
    fields = {"iss": ISSUER, "login_hint": "3", "client_id": CLIENT, "target_link_uri": PICK}
    chosen = client.post("/lti/login", data=fields, headers=framed, follow_redirects=False)
    assert chosen.status_code == 303
    assert "Partitioned" in chosen.headers["Set-Cookie"]
    fields["target_link_uri"] = "https://grader.example.edu/"
    opened = client.post("/lti/login", data=fields, headers=framed, follow_redirects=False)
    assert opened.status_code == 200
    assert 'target="_blank"' in opened.text


def test_a_token_is_shown_once(
    client: httpx.Client, moodle: FakeProvider, ready: Services, at_desk: httpx.Response
) -> None:
    again = asked(client, moodle, ready)
    assert 'name="assignment"' in again.text
    assert 'name="token"' not in again.text


@pytest.mark.parametrize(
    ("settings", "field"),
    [({"accept_lineitem": False}, "lineItem"), ({"data": ""}, "")],
)
def test_what_the_platform_does_not_take_is_left_out(
    client: httpx.Client,
    moodle: FakeProvider,
    ready: Services,
    at_desk: httpx.Response,
    settings: dict[str, Any],
    field: str,
) -> None:
    page = asked(client, moodle, ready, SETTINGS | settings)
    claims = answered(ready, client.post(page.url.path, data={"assignment": "square"}))
    (item,) = claims[f"{DEEP}content_items"]
    assert field not in item
    assert (f"{DEEP}data" in claims) == bool(field)


@pytest.mark.parametrize("chosen", [[], ["square", "hello"], ["nothing_of_ours"], ["square", "x"]])
def test_no_more_is_chosen_than_there_is_or_than_is_taken(
    client: httpx.Client,
    moodle: FakeProvider,
    ready: Services,
    at_desk: httpx.Response,
    chosen: list[str],
) -> None:
    page = asked(client, moodle, ready, SETTINGS | {"accept_multiple": False})
    assert 'type="radio" name="assignment"' in page.text
    refused = client.post(page.url.path, data={"assignment": chosen}, headers={"Accept": "text/html"})
    assert refused.status_code == 422
    assert "没有选作业，或选得太多" in refused.text
    assert "JWT" not in refused.text


@pytest.mark.parametrize("role", [Role.STUDENT, Role.ASSISTANT])
def test_only_an_instructor_of_the_class_list_chooses(
    client: httpx.Client,
    moodle: FakeProvider,
    ready: Services,
    platform: Platform,
    role: Role,
) -> None:
    """Whatever the platform calls them."""
    ready.courses.import_roster("ros", [RosterEntry(id="zhou", name="", role=role)], "test")
    roles = ["http://purl.imsglobal.org/vocab/lis/v2/membership#Instructor"]
    page = asked(client, moodle, ready, roles=roles)
    framed = {"Sec-Fetch-Dest": "iframe", "Accept": "text/html"}
    data = {"token": token_of(ready, "zhou")}
    refused = client.post(f"{page.url.path}/token", data=data, headers=framed)
    assert (
        ready.identities.of_member("ros", "zhou") == ()
    )  # the account at the platform is not theirs for ever
    assert ready.identities.bind(platform.provider, "9", "ros", "zhou", by_token=True)
    for answer in (refused, client.get(page.url.path, headers=framed)):
        assert answer.status_code == 403
        assert "只有任课教师能选作业" in answer.text
        assert "frame-ancestors https: http:" in answer.headers["Content-Security-Policy"]
    chosen = client.post(page.url.path, data={"assignment": "square"})
    assert chosen.status_code == 403


def test_a_refusal_is_read_in_the_frame_of_a_platform_that_is_not_known(client: httpx.Client) -> None:
    framed = {"Sec-Fetch-Dest": "iframe", "Accept": "text/html"}
    fields = {"iss": "https://unknown.example.edu", "login_hint": "3"}
    shown = client.post("/lti/login", data=fields, headers=framed)
    assert shown.status_code >= 400
    assert "frame-ancestors https: http:" in shown.headers["Content-Security-Policy"]
    assert '<base target="_blank">' in shown.text
    elsewhere = client.get("/nothing", headers=framed)
    assert "frame-ancestors 'none'" in elsewhere.headers["Content-Security-Policy"]


def test_a_token_of_nobody_or_of_another_course_is_refused(
    client: httpx.Client, moodle: FakeProvider, ready: Services, platform: Platform
) -> None:
    page = asked(client, moodle, ready)
    for token in ("", "x" * 43, token_of_other_course(ready)):
        refused = client.post(f"{page.url.path}/token", data={"token": token})
        assert refused.status_code == 403
        assert 'name="token"' in refused.text
        assert client.post(page.url.path, data={"assignment": "square"}).status_code == 422


def token_of_other_course(services: Services) -> str:
    services.courses.create("other", "Other", "UTC", "test")
    services.courses.import_roster("other", [RosterEntry(id="hu", name="", role=Role.INSTRUCTOR)], "test")
    return services.tokens.issue("other", "hu", timedelta(days=1), "test")[1]


def test_a_link_to_somebody_elses_choice_takes_nobodys_token(
    client: httpx.Client, moodle: FakeProvider, ready: Services, platform: Platform, tokens: dict[str, str]
) -> None:
    """Whoever sends an instructor such a link would else come in from the platform as that instructor."""
    where = asked(client, moodle, ready).url.path
    client.cookies.clear()  # another browser
    page = {"Accept": "text/html"}
    for answer in (
        client.get(where, headers=page),
        client.post(f"{where}/token", data={"token": tokens["wang"]}, headers=page),
    ):
        assert answer.status_code == 410
        assert "这次选择已经过期" in answer.text
    assert ready.identities.of_member("ros", "wang") == ()


def test_the_cookie_of_a_choice_is_for_its_frame_and_its_address_alone(
    client: httpx.Client, moodle: FakeProvider, ready: Services, platform: Platform
) -> None:
    said = login(client, target_link_uri=PICK)
    claims = message(said, ready.clock().timestamp(), message_type="LtiDeepLinkingRequest", custom={})
    claims[f"{DEEP}deep_linking_settings"] = SETTINGS
    went = client.post(
        "/lti/launch",
        data={"id_token": moodle.sign(claims), "state": said["state"]},
        headers={"Sec-Fetch-Dest": "iframe"},
        follow_redirects=False,
    )
    (cookie,) = [one for one in went.headers.get_list("Set-Cookie") if one.startswith(f"{OPENED}=")]
    for wanted in ("HttpOnly", "Secure", "SameSite=none", "Partitioned", f"Path={went.headers['Location']}"):
        assert wanted in cookie


def test_a_choice_ends(
    client: httpx.Client, ready: Services, platform: Platform, at_desk: httpx.Response
) -> None:
    ready.clock.advance(3_601)  # type: ignore[attr-defined] - of a test
    over = client.get(at_desk.url.path, headers={"Accept": "text/html"})
    assert over.status_code == 410
    assert "这次选择已经过期" in over.text
    assert client.post(at_desk.url.path, data={"assignment": "square"}).status_code == 410
    assert client.get(f"/lti/pick/{'x' * 43}").status_code == 410


def test_a_choice_ends_with_its_platform(
    client: httpx.Client, ready: Services, platform: Platform, at_desk: httpx.Response
) -> None:
    assert ready.platforms.remove(platform.id, Signature(ready.clock(), "ros", "wang"))
    assert client.get(at_desk.url.path).status_code == 410


WRONG: dict[str, Any] = {
    "none": None,
    "no object": [BACK],
    "no address": {name: value for name, value in SETTINGS.items() if name != "deep_link_return_url"},
    "an address without TLS": SETTINGS | {"deep_link_return_url": "http://evil.example/back"},
    "a script": SETTINGS | {"deep_link_return_url": "javascript:alert(1)"},
    "an address in two lines": SETTINGS | {"deep_link_return_url": f"{BACK}\n"},
    "an address of 3,000 characters": SETTINGS | {"deep_link_return_url": f"{BACK}{'x' * 3_000}"},
    "links alone": SETTINGS | {"accept_types": ["link"]},
    "types a text": SETTINGS | {"accept_types": "ltiResourceLink"},
    "data of 9,000 characters": SETTINGS | {"data": "x" * 9_000},
}


@pytest.mark.parametrize("how", WRONG)
def test_settings_that_cannot_be_answered_are_refused(
    client: httpx.Client, moodle: FakeProvider, ready: Services, platform: Platform, how: str
) -> None:
    wrong = WRONG[how]
    refused = asked(client, moodle, ready, {} if wrong is None else wrong)
    assert refused.status_code == 403
    assert "登录结果不可信" in refused.text
