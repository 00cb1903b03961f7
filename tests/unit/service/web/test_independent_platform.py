"""A platform that others wrote (lti1p3platform): login, launch, choice, score and class list."""

import json
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from datetime import UTC, datetime
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from threading import Thread
from types import SimpleNamespace
from typing import Any
from urllib.parse import parse_qsl, urlsplit

import httpx
import pytest
from fastapi import FastAPI
from lti1p3platform.exceptions import LtiException
from lti1p3platform.ltiplatform import LTI1P3PlatformConfAbstract
from lti1p3platform.message_launch import LTIAdvantageMessageLaunchAbstract
from lti1p3platform.oidc_login import OIDCLoginAbstract
from lti1p3platform.registration import Registration

from grader.contracts.identity import Caller, Role, Seen
from grader.contracts.platform import Platform
from grader.outside.lti import Launches
from grader.outside.lti.roster import ROSTER_SCOPE
from grader.outside.lti.scores import SCORE_SCOPE, PlatformChannel
from grader.outside.signin import Providers
from grader.store.audit import Signature
from grader.use_cases import platform_people
from grader.use_cases.score_sending import send_scores
from grader.use_cases.services import Services
from tests.fakes.platforms import new_platform
from tests.fakes.provider import RSA
from tests.unit.service.web.test_picking import OPENED, form_of
from tests.unit.service.web.test_platform_scores import key, signer
from tests.unit.service.web.test_platforms import COOKIE

OURS = "https://grader.example.edu"
ISSUER = "https://campus.example.edu"
LEARNER = "http://purl.imsglobal.org/vocab/lis/v2/membership#Learner"


class Login(OIDCLoginAbstract):  # type: ignore[misc]
    def set_lti_message_hint(self, **_: Any) -> None:
        self._lti_message_hint = "7"

    def get_redirect(self, url: str) -> str:
        return url


class Message(LTIAdvantageMessageLaunchAbstract):  # type: ignore[misc]
    def render_launch_form(self, launch_data: dict[str, Any], **_: Any) -> dict[str, Any]:
        return launch_data


class Campus(LTI1P3PlatformConfAbstract):  # type: ignore[misc]
    """The platform; its services are at `address`."""

    def init_platform_config(self, **_: Any) -> None:
        self.address = ""
        self.scores: list[dict[str, Any]] = []
        self.members: list[dict[str, Any]] = []
        public, private = (RSA.as_pem(private=each).decode() for each in (False, True))
        made = Registration().set_iss(ISSUER).set_client_id("c-1").set_deployment_id("1")
        made.set_oidc_login_url(f"{OURS}/lti/login").set_launch_url(f"{OURS}/")
        made.set_platform_public_key(public).set_platform_private_key(private)
        self._registration = made

    def get_registration_by_params(self, **_: Any) -> Registration:
        return self._registration

    def answer(self, path: str, headers: Any, body: bytes) -> tuple[int, Any]:
        """Answer as the library says; a token without the right scope is refused."""
        bearer = headers.get("Authorization", "").removeprefix("Bearer ")
        if path == "/keys":
            return 200, self.get_jwks()
        if path == "/access":
            return 200, self.get_access_token(dict(parse_qsl(body.decode())))
        scope = {"/items/7/scores": SCORE_SCOPE, "/people": ROSTER_SCOPE}[path]
        try:
            allowed = self.validate_token(bearer, [scope])
        except LtiException:
            allowed = False
        if not allowed:
            return 403, {}
        if path == "/people":
            return 200, {"id": "x", "members": self.members}
        self.scores.append(json.loads(body))
        return 200, {}


@contextmanager
def serving(campus: Campus) -> Iterator[str]:
    class Handler(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            body = self.rfile.read(int(self.headers.get("Content-Length", "0")))
            status, document = campus.answer(urlsplit(self.path).path, self.headers, body)
            content = json.dumps(document).encode()
            self.send_response(status)
            self.send_header("Content-Length", str(len(content)))
            self.end_headers()
            self.wfile.write(content)

        do_POST = do_GET

        def log_message(self, *_: object) -> None:
            """Keep quiet."""

    server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    thread = Thread(target=server.serve_forever, args=(0.01,), daemon=True)
    thread.start()
    try:
        yield f"http://127.0.0.1:{server.server_port}"
    finally:
        server.shutdown()
        thread.join()
        server.server_close()


@pytest.fixture(scope="module")
def listening() -> Iterator[Campus]:
    campus = Campus()
    with serving(campus) as address:
        campus.address = address
        yield campus


@pytest.fixture
def campus(listening: Campus) -> Campus:
    listening.scores, listening.members = [], []
    listening.get_registration().set_tool_key_set(signer().public())
    return listening


@pytest.fixture
def ready(
    running: tuple[FastAPI, str], client: httpx.Client, services: Services, tokens: dict[str, str]
) -> Services:
    services.platforms.keys(key)
    made = replace(
        services,
        providers=Providers(public_url=OURS),
        launches=Launches(time.time, private=True),
        platform_channel=PlatformChannel(signer, time.time, private=True),
        clock=lambda: datetime.now(UTC),  # by which the platform checks what it is told
    )
    running[0].state.services = made
    return made


@pytest.fixture
def platform(ready: Services, campus: Campus) -> Platform:
    served = {"token_url": f"{campus.address}/access", "keys_url": f"{campus.address}/keys"}
    new = new_platform(issuer=ISSUER, client_id="c-1", **served)
    return ready.platforms.add(new, Signature(ready.clock(), "ros", "wang"))


def come(client: httpx.Client, campus: Campus, *, picks: bool = False) -> httpx.Response:
    """Open an activity, or the choice of activities, as the platform leads a browser."""
    hinted = Login(None, campus)
    hinted.set_lti_message_hint()
    if picks:
        hinted.set_launch_url(f"{OURS}/lti/pick")
    address = hinted.initiate_login("3").removeprefix(OURS)
    went = client.get(address, follow_redirects=False)
    assert went.status_code == 303, went.text
    client.cookies.set(COOKIE, went.cookies[COOKIE], domain="127.0.0.1", path="/lti")
    asked = dict(parse_qsl(urlsplit(went.headers["Location"]).query))
    message = Message(SimpleNamespace(get_data=asked, form_data={}), campus)
    who = "9" if picks else "3"
    message.set_user_data(who, [LEARNER], full_name="李", email_address="li@example.edu")
    message.set_resource_link_claim("7", title="走正方形")
    message.set_launch_context_claim("2", ["CourseSection"], "ROS 2", "ros")
    message.set_custom_parameters_claim({"assignment": "square", "idnumber": "" if picks else "li"})
    message.set_ags(f"{campus.address}/items", f"{campus.address}/items/7?type_id=1")
    message.set_nrps(f"{campus.address}/people?of=2")
    if picks:
        campus.get_registration().set_deeplink_launch_url(f"{OURS}/lti/pick")
        message.set_dl(f"{ISSUER}/back", extra_data={"csrf": "x"})
    said = message.lti_launch()
    assert said["launch_url"] == f"{OURS}/lti/launch"
    fields = {name: said[name] for name in ("state", "id_token")}
    return client.post("/lti/launch", data=fields, headers={"Accept": "text/html"}, follow_redirects=False)


def test_launch_score_and_class_list(
    client: httpx.Client, campus: Campus, ready: Services, platform: Platform, put: Callable[..., str]
) -> None:
    opened = come(client, campus)
    assert (opened.status_code, "/assignments/square" in opened.text) == (200, True)
    put(course="ros", student="li")
    assert send_scores(ready) == 1
    (told,) = campus.scores
    assert (told["userId"], told["scoreGiven"], told["scoreMaximum"]) == ("3", 5.0, 100.0)
    campus.members = [
        {"user_id": "3", "status": "Active", "roles": [LEARNER], "lis_person_sourcedid": "li"},
        {
            "user_id": "4",
            "status": "Active",
            "roles": [LEARNER],
            "lis_person_sourcedid": "new1",
            "name": "新",
        },
    ]
    wang = Caller(course="ros", person="wang", role=Role.INSTRUCTOR)
    added = platform_people.add(ready, wang, platform.id, Seen(None))
    assert ([one.id for one in added.added], added.known) == (["new1"], 1)


def test_the_choice_of_activities(
    client: httpx.Client, campus: Campus, ready: Services, platform: Platform, tokens: dict[str, str]
) -> None:
    went = come(client, campus, picks=True)
    where = went.headers["Location"]
    client.cookies.set(OPENED, went.cookies[OPENED], domain="127.0.0.1", path=where)
    page = {"Accept": "text/html"}
    client.post(f"{where}/token", data={"token": tokens["wang"]}, headers=page)
    chosen = client.post(where, data={"assignment": ["square", "hello"]}, headers=page)
    back, fields = form_of(chosen)
    assert back == f"{ISSUER}/back"
    items = campus.validate_deeplinking_resp(fields)
    said = campus.tool_validate_and_decode(fields["JWT"])
    assert said["https://purl.imsglobal.org/spec/lti-dl/claim/data"] == {"csrf": "x"}
    assert [one["custom"]["assignment"] for one in items] == ["hello", "square"]
    assert {one["type"] for one in items} == {"ltiResourceLink"}


def test_a_tool_that_is_another_gets_no_token(campus: Campus, ready: Services, platform: Platform) -> None:
    other = Registration().set_tool_key_set({"keys": []}).get_tool_key_set()
    campus.get_registration().set_tool_key_set(other)
    with pytest.raises(Exception, match=r"127\.0\.0\.1"):
        ready.platform_channel.people(replace(platform, people_url=f"{campus.address}/people"))
