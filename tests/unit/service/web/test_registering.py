"""Registering with a learning platform by one address: 1EdTech's Dynamic Registration, as Moodle does it."""

import re
from dataclasses import replace
from typing import Any

import httpx
import pytest
from fastapi import FastAPI

from grader.contracts.errors import InfrastructureError
from grader.contracts.identity import Role, RosterEntry
from grader.outside.lti.registration import _TOOL
from grader.store.audit import Signature
from grader.store.platforms import Platforms
from grader.use_cases.services import Services
from tests.fakes.provider import FakeProvider
from tests.unit.service.web.conftest import Browser
from tests.unit.service.web.test_platforms import moodle, ready

__all__ = ("moodle", "ready")  # fixtures
OURS = "https://grader.example.edu"
TOLD = {"client_id": "abc", _TOOL: {"deployment_id": "7"}}


@pytest.fixture
def platform(moodle: FakeProvider) -> FakeProvider:
    moodle.tools.clear()
    moodle.configured, moodle.registered = {}, (200, TOLD)
    return moodle


@pytest.fixture
def open_network(running: tuple[FastAPI, str], ready: Services) -> Services:
    """Services whose platforms may be on this machine."""
    made = replace(ready, providers=replace(ready.providers, private_platforms=True))
    running[0].state.services = made
    return made


@pytest.fixture
def path(client: httpx.Client, open_network: Services, tokens: dict[str, str]) -> str:
    """Where the address leads that an instructor makes on the page."""
    wang = Browser(client)
    wang.enter(token=tokens["wang"])
    page = wang.post("/class/platforms/invite", {}, page="/class/platforms")
    (address,) = re.findall(rf"<code>{OURS}(/lti/register/[A-Za-z0-9_-]{{43}})</code>", page.text)
    client.cookies.clear()  # the platform's frame has no session
    return str(address)


def asked(platform: FakeProvider, **changed: str) -> dict[str, str]:
    return {
        "openid_configuration": f"{platform.address}/lti-configuration",
        "registration_token": "x.y.z",
    } | changed


def register(client: httpx.Client, path: str, fields: dict[str, str]) -> httpx.Response:
    headers = {"Accept": "text/html", "Sec-Fetch-Dest": "iframe"}
    return client.post(path, data=fields, headers=headers, follow_redirects=False)


def test_one_address_adds_a_platform(
    client: httpx.Client, ready: Services, platform: FakeProvider, path: str
) -> None:
    page = client.get(path, params=asked(platform))
    assert page.status_code == 200
    assert platform.tools == []  # whoever only looks registers nothing
    assert f"frame-ancestors {platform.address}" in page.headers["Content-Security-Policy"]
    done = register(client, path, asked(platform))
    assert done.status_code == 200, done.text
    assert "Moodle 127.0.0.1 已经加到课程 ros" in done.text
    (added,) = ready.platforms.of_course("ros")
    assert (added.issuer, added.client_id, added.deployment) == (platform.address, "abc", "7")
    assert added.login_url == f"{platform.address}/authorization"
    assert added.token_url == f"{platform.address}/token"
    assert added.keys_url == f"{platform.address}/keys"
    ((authorization, tool),) = platform.tools
    assert authorization == "Bearer x.y.z"
    assert tool == {
        "application_type": "web",
        "response_types": ["id_token"],
        "grant_types": ["implicit", "client_credentials"],
        "initiate_login_uri": f"{OURS}/lti/login",
        "redirect_uris": [f"{OURS}/lti/launch"],
        "client_name": "ROS 2 自动评分",
        "jwks_uri": f"{OURS}/lti/keys",
        "token_endpoint_auth_method": "private_key_jwt",
        "scope": "https://purl.imsglobal.org/spec/lti-ags/scope/score "
        "https://purl.imsglobal.org/spec/lti-nrps/scope/contextmembership.readonly",
        _TOOL: {
            "domain": "grader.example.edu",
            "target_link_uri": f"{OURS}/",
            "custom_parameters": {"idnumber": "$Person.sourcedId", "username": "$User.username"},
            "claims": ["iss", "sub"],
            "messages": [
                {"type": "LtiResourceLinkRequest"},
                {
                    "type": "LtiDeepLinkingRequest",
                    "target_link_uri": f"{OURS}/lti/pick",
                    "label": "ROS 2 自动评分",
                },
            ],
        },
    }


def test_the_log_says_who_has_let_it_in(
    client: httpx.Client, ready: Services, platform: FakeProvider, path: str
) -> None:
    register(client, path, asked(platform))
    logged = {one.action: one.actor for one in ready.audit.entries("ros", limit=9)}
    assert logged["platform.invite"] == logged["platform.add"] == "wang"


def test_an_address_is_good_once_and_for_a_day(
    client: httpx.Client, ready: Services, platform: FakeProvider, path: str
) -> None:
    assert register(client, path, asked(platform)).status_code == 200
    assert register(client, path, asked(platform)).status_code == 410
    assert len(ready.platforms.of_course("ros")) == 1
    later = ready.platforms.invite(Signature(ready.clock(), "ros", "wang"))
    ready.clock.advance(86_401.0)  # type: ignore[attr-defined] - of a test
    over = register(client, f"/lti/register/{later}", asked(platform))
    assert over.status_code == 410
    assert "这个登记网址不能用了" in over.text
    assert client.get(f"/lti/register/{'x' * 43}", params=asked(platform)).status_code == 410


@pytest.mark.parametrize("fault", [RuntimeError("a bug"), InfrastructureError("the database is away")])
def test_no_secret_is_logged(
    client: httpx.Client,
    platform: FakeProvider,
    path: str,
    fault: Exception,
    monkeypatch: pytest.MonkeyPatch,
    caplog: pytest.LogCaptureFixture,
) -> None:
    fields = asked(platform, openid_configuration=f"{platform.address}/nowhere?token=of-the-platform")
    assert register(client, path, fields).status_code == 409

    def failing(*_: object) -> None:
        raise fault

    monkeypatch.setattr(Platforms, "invited", failing)
    assert register(client, path, fields).status_code >= 500
    assert "/nowhere" in caplog.text
    assert "of-the-platform" not in caplog.text
    assert path.rpartition("/")[2] not in caplog.text


@pytest.mark.parametrize("role", [None, Role.STUDENT, Role.ASSISTANT])
def test_whoever_is_no_instructor_any_more_lets_nobody_in(
    client: httpx.Client, ready: Services, platform: FakeProvider, path: str, role: Role | None
) -> None:
    ready.courses.import_roster("ros", [RosterEntry(id="zhao", name="", role=Role.INSTRUCTOR)], "operator")
    if role is None:
        ready.courses.remove("ros", ["wang"], "operator")
    else:
        ready.courses.import_roster("ros", [RosterEntry(id="wang", name="", role=role)], "operator")
    assert client.get(path, params=asked(platform)).status_code == 410
    assert register(client, path, asked(platform)).status_code == 410
    assert platform.tools == []


@pytest.mark.parametrize(
    "fields",
    [
        {"openid_configuration": ""},
        {"openid_configuration": "http://moodle.example.edu/config"},
        {"openid_configuration": "file:///etc/passwd"},
        {"openid_configuration": "https://moodle.example.edu/" + "x" * 2_000},
        {"registration_token": "a\nb"},
        {"registration_token": "ü"},
    ],
)
def test_what_no_platform_sends_is_refused(
    client: httpx.Client, ready: Services, platform: FakeProvider, path: str, fields: dict[str, str]
) -> None:
    refused = register(client, path, asked(platform, **fields))
    assert refused.status_code == 422
    assert platform.tools == []
    assert register(client, path, asked(platform)).status_code == 200  # the address is still good


WRONG: dict[str, dict[str, Any]] = {
    "another issuer": {"issuer": "https://evil.example"},
    "no registration": {"registration_endpoint": None},
    "registration elsewhere, in the open": {"registration_endpoint": "http://evil.example/register"},
    "keys without TLS": {"jwks_uri": "http://evil.example/keys"},
    "an address that is a number": {"token_endpoint": 7},
}


@pytest.mark.parametrize("how", WRONG)
def test_a_configuration_that_cannot_be_used_adds_nothing(
    client: httpx.Client, ready: Services, platform: FakeProvider, path: str, how: str
) -> None:
    platform.configured = WRONG[how]
    refused = register(client, path, asked(platform))
    assert refused.status_code in (409, 422)
    assert "frame-ancestors https: http:" in refused.headers["Content-Security-Policy"]
    assert ready.platforms.of_course("ros") == ()


@pytest.mark.parametrize(
    "answer",
    [(400, {"error": "x"}), (200, {}), (200, {"client_id": "abc"}), (200, [1]), (302, {}), (500, {})],
)
def test_an_answer_that_names_no_tool_adds_nothing(
    client: httpx.Client, ready: Services, platform: FakeProvider, path: str, answer: tuple[int, Any]
) -> None:
    platform.registered = answer
    refused = register(client, path, asked(platform))
    assert refused.status_code == 409
    assert "平台没有完成登记" in refused.text
    assert ready.platforms.of_course("ros") == ()
    platform.registered = (201, TOLD | {_TOOL: {"deployment_id": 7}})
    assert register(client, path, asked(platform)).status_code == 200  # the address is still good
    assert ready.platforms.of_course("ros")[0].deployment == "7"


def test_a_platform_in_the_private_network_is_not_asked(
    client: httpx.Client,
    ready: Services,
    platform: FakeProvider,
    path: str,
    running: tuple[FastAPI, str],
) -> None:
    running[0].state.services = ready
    refused = register(client, path, asked(platform))
    assert refused.status_code == 409
    assert platform.tools == []
