"""Every request that changes something, at both doors, sent by everybody: what it answers, what it leaves.

All of the application's own routes are asked: one without a row in `ROWS` fails. First come those to whom nothing
of it belongs. Whoever is refused changes not a single value of the database; whoever may send the request for
themselves changes nothing that is not theirs. Then the student to whom it belongs and the course's staff send the
same, which must change something: else its row would say nothing.
"""

import shutil
import sqlite3
from collections.abc import Sequence
from contextlib import closing
from dataclasses import asdict, dataclass, field, replace
from datetime import datetime, timedelta
from pathlib import Path
from typing import Any

import httpx
import pytest
from fastapi import FastAPI
from fastapi.routing import APIRoute

from grader.contracts.grading import AssignmentSource
from grader.contracts.identity import Caller, Role, RosterEntry
from grader.contracts.notice import NewWebhook, Outlet, Vendor
from grader.contracts.regrade import Wanted
from grader.contracts.rules import Extension, Rules
from grader.outside.notices.bots import example_address
from grader.service.web.access import SESSION_COOKIE
from grader.service.web.forms import COOKIE, FIELD
from grader.store.appeals import Asked
from grader.store.audit import Signature
from grader.store.own_assignments import NewOwnAssignment
from grader.use_cases import judging, people
from grader.use_cases.services import Services
from tests.fakes import server
from tests.fakes.clock import FakeClock
from tests.fakes.courses import PreparedCourses
from tests.fakes.platforms import new_platform
from tests.unit.service.web.conftest import PAGE, grade_all, put_in

FORM_TOKEN = "t" * 32
FOREIGN = ("nobody", "bound", "classmate", "outsider", "stranger")
"""Without a token; an assistant of another section; another student; student and instructor of another course."""
STAFF = ("assistant", "instructor")
"""Of the first course."""
PEOPLE = {"classmate": "han", "assistant": "ta", "instructor": "wang"}

HOME = {"bound": "ros", "classmate": "ros", "outsider": "other", "stranger": "other"}
WALK = {"assignment_id": "walk"}
DISCARD = "POST /class/regrades/{regrade_id}"
BOT = example_address(Vendor.WECOM).replace("…", "x")
SCRIPT = {"file": ("square.py", b"x = 1\n")}
LIST = {"file": ("class.csv", b"id,name,section\nli,Nobody,2\n")}
SHEET = {"file": ("s.csv", b"id,points\nli,\n")}
REGRADE, JUDGED = {"reason": "x"}, {"items": [{"item": "closed", "points": 1}], "comment": "x"}
MEMBER = {"person": "li", "name": "Nobody", "role": "student", "sections": "2"}
PLATFORM = asdict(new_platform(deployment="2"))


@dataclass(frozen=True)
class Row:
    """A request, and the answers to it in the order of `FOREIGN` and `STAFF`.

    Attributes:
        answers: statuses; ``enter`` is the way to the page that asks who it is, and ``ok`` any that is no refusal.
        data: fields of a page's form. json: of a request to the interface.
        owner: who makes it first; empty: it changes no row, and stands here because of its answers.
        first: the route of a request that the owner sends before all others.
        ids: in the place of those of `Things`.
    """

    answers: str
    data: dict[str, Any] | None = None
    json: Any = None
    files: dict[str, Any] | None = None
    params: dict[str, str] = field(default_factory=dict)
    owner: str = "instructor"
    first: str = ""
    ids: dict[str, str] = field(default_factory=dict)


INSTRUCTORS = "enter 403 403 403 ok"  # the other one acts on the course of their own
ROWS: dict[str, Row] = {
    # anybody may ask for these pages
    "POST /enter": Row("403 403 403 403 403 403 403", {"token": "x" * 30}, owner=""),
    "POST /leave": Row("ok ok ok ok ok ok ok", {}, owner=""),
    "POST /enter/bind": Row("403 403 403 403 403 403 403", {"token": "x" * 30}, owner=""),
    "POST /enter/course": Row("403 403 403 403 403 403 403", {"course": "ros"}, owner=""),
    "POST /lti/login": Row(
        "409 409 409 409 409 409 409",
        {"iss": "https://a.example", "login_hint": "3", "target_link_uri": "/"},
        owner="",
    ),
    "POST /lti/launch": Row("403 403 403 403 403 403 403", {"id_token": "x", "state": "x"}, owner=""),
    "POST /lti/pick/{secret}": Row("410 410 410 410 410 410 410", {"assignment": "square"}, owner=""),
    "POST /lti/pick/{secret}/token": Row("410 410 410 410 410 410 410", {"token": "x" * 30}, owner=""),
    "POST /lti/register/{secret}": Row(
        "410 410 410 410 410 410 410", {"openid_configuration": "https://a.example/x"}, owner=""
    ),
    # work, on pages
    "POST /assignments/{assignment_id}/practice": Row("enter ok ok ok ok ok ok", {}, files=SCRIPT, owner=""),
    "POST /assignments/{assignment_id}/practice/draft": Row(
        "enter ok ok ok ok ok ok", {}, files=SCRIPT, owner=""
    ),
    "POST /assignments/{assignment_id}": Row(
        "enter ok ok ok ok ok ok", {"student": "li"}, files=SCRIPT, owner="li"
    ),
    "POST /submissions/{submission_id}/comments": Row(
        "enter 404 404 404 404 ok ok", {"text": "x"}, owner="li"
    ),
    "POST /submissions/{submission_id}/appeals": Row(
        "enter 404 404 404 404 403 403", {"item": "sides", "reason": "x"}, owner="li"
    ),
    "POST /submissions/{submission_id}/appeals/withdraw": Row(
        "enter 404 404 404 404 403 403", {"item": "closed"}, owner="li"
    ),
    # the class, on pages
    "POST /class/appeals/{submission_id}": Row(
        "enter 404 403 403 404 ok 409", {"item": "closed", "decision": "refused", "text": "x"}
    ),
    "POST /class/assignments/{assignment_id}/pinned": Row(
        "enter 403 403 403 ok 403 ok", {"mistake": "rate_off", "text": "x"}, owner=""
    ),
    "PUT /api/v1/assignments/{assignment_id}/pinned/{mistake}": Row(
        "401 403 403 403 ok 403 ok", json={"text": "x"}, ids={"mistake": "rate_off"}, owner=""
    ),
    "POST /class/receipts": Row("enter 422 403 403 422 422 422", {"receipt": "x"}, owner=""),
    "POST /class/teams/{assignment_id}": Row("enter 403 403 403 ok 403 ok", {}, owner=""),
    "POST /assignments/{assignment_id}/team": Row(
        "enter 409 409 409 409 409 409", {"action": "start"}, owner=""
    ),
    "POST /class/judgements/phrases": Row("enter ok 403 403 ok ok ok", {"phrases": "k {caller}"}, owner=""),
    "POST /class/judgements/{submission_id}/whole": Row("enter 404 403 403 404 404 404", {}, owner=""),
    "POST /class/judgements/{submission_id}": Row(
        "enter 404 403 403 404 403 ok", {"item": "closed", "points": "1", "comment": "x"}
    ),
    "POST /class/judgements/{submission_id}/several": Row(
        "enter 404 403 403 404 403 ok", {"item": "closed", "points": "1", "seen": "{seen}", "comment": "x"}
    ),
    "POST /class/gradebook/fill": Row(
        "enter ok 403 403 ok ok ok", {"column": "points"}, files=SHEET, owner=""
    ),
    "POST /class/regrades": Row("enter 403 403 403 422 403 ok", {"assignment": "straight", "students": "li"}),
    "POST /class/regrades/{regrade_id}": Row(
        "enter 403 403 403 404 403 ok", {"decision": "discard", "reason": "x"}
    ),
    "POST /class/rules": Row("enter 403 403 403 ok 403 ok", {"assignment": "square", "shown": "draft"}),
    "POST /class/rubric/{assignment_id}": Row("enter 403 403 403 412 403 412", {}, owner=""),
    "POST /class/rules/{assignment_id}": Row("enter 403 403 403 ok 403 ok", {"shown": "draft"}),
    "POST /class/rules/{assignment_id}/extensions": Row(
        "enter 403 403 403 422 403 ok", {"student": "li", "extra_attempts": "1"}
    ),
    "POST /class/rules/{assignment_id}/section": Row(
        "enter 403 403 403 ok 403 ok", {"due": "2026-09-01T08:00"}, params={"name": "1"}
    ),
    "POST /class/people": Row("enter 403 403 403 ok 403 ok", {**MEMBER, "person": "fresh"}),
    "POST /class/people/preview": Row("enter 403 403 403 ok 403 ok", {}, files=LIST, owner=""),
    "POST /class/people/import": Row(
        "enter 403 403 403 ok 403 ok", {"entries": LIST["file"][1].decode(), "seen": "{tag}"}
    ),
    "POST /class/people/tokens": Row("enter 403 403 403 ok 403 ok", {"form": "csv"}),
    "POST /class/people/{person}": Row("enter 403 403 403 404 403 ok", MEMBER),
    "POST /class/people/{person}/renumber": Row("enter 403 403 403 404 403 ok", {"new": "sun2"}),
    "POST /class/people/{person}/remove": Row("enter 403 403 403 404 403 ok", {}),
    "POST /class/people/{person}/token": Row("enter 404 403 403 404 ok ok", {}),
    "POST /class/people/{person}/unbind": Row("enter 403 403 403 404 403 ok", {"identity": "{identity}"}),
    "POST /class/own": Row(
        "enter 403 403 403 422 403 422", {}, files={"file": ("walk.zip", b"none")}, owner=""
    ),
    "POST /class/own/{assignment_id}/adopt": Row("enter 403 403 403 404 403 404", {}, ids=WALK, owner=""),
    "POST /class/own/{assignment_id}/remove": Row("enter 403 403 403 404 403 ok", {}, ids=WALK),
    "POST /class/course": Row("enter 403 403 403 ok 403 ok", {"distro": "jazzy"}),
    "POST /class/course/settings": Row("enter 403 403 403 ok 403 ok", {"title": "x", "time_zone": "UTC"}),
    "POST /class/course/copy": Row("enter 403 403 403 ok 403 ok", {"id": "{caller}"}),
    "POST /class/course/archive": Row("enter 403 403 403 ok 403 ok", {"archived": "true"}, first=DISCARD),
    "POST /class/course/erase": Row("enter 403 403 403 ok 403 ok", {"older_than": "1"}),
    "POST /class/course/forget": Row("enter 403 403 403 404 403 ok", {"person": "li", "again": "li"}),
    "POST /class/platforms": Row("enter 403 403 403 409 403 409", PLATFORM, owner=""),
    "POST /class/platforms/invite": Row("enter 403 403 403 409 403 409", {}, owner=""),
    "POST /class/platforms/remove": Row("enter 403 403 403 404 403 ok", {"platform": "{platform}"}),
    "POST /class/platforms/people": Row(
        "enter 403 403 403 404 403 409", {"platform": "{platform}"}, owner=""
    ),
    "POST /class/platforms/people/add": Row(
        "enter 403 403 403 404 403 409", {"platform": "{platform}", "seen": "x"}, owner=""
    ),
    "POST /class/notices/webhook": Row(
        "enter 403 403 403 ok 403 ok", {"outlet": "staff", "vendor": "wecom", "address": BOT}
    ),
    "POST /class/notices/remove": Row("enter 403 403 403 404 403 ok", {"outlet": "class"}),
    "POST /class/notices/test": Row("enter 403 403 403 404 403 502", {"outlet": "class"}, owner=""),
    "POST /class/notices/mail": Row(
        "enter 403 403 403 409 403 409", {"due": "true", "graded": "true"}, owner=""
    ),
    # work, by the interface
    "POST /api/v1/submissions": Row(
        "401 403 403 403 422 403 ok", {"assignment": "square", "student": "li"}, files=SCRIPT, owner="li"
    ),
    "POST /api/v1/submissions/{submission_id}/comments": Row(
        "401 404 404 404 404 ok ok", json={"text": "x"}, owner="li"
    ),
    "POST /api/v1/submissions/{submission_id}/appeals": Row(
        "401 404 404 404 404 403 403", json={"item": "sides", "reason": "x"}, owner="li"
    ),
    "PUT /api/v1/submissions/{submission_id}/appeals/{item:path}": Row(
        "401 404 404 404 404 ok 409", json={"state": "refused", "text": "x"}
    ),
    "DELETE /api/v1/submissions/{submission_id}/appeals/{item:path}": Row(
        "401 404 404 404 404 403 403", owner="li"
    ),
    "PUT /api/v1/submissions/{submission_id}/judgements": Row("401 404 404 404 404 403 ok", json=JUDGED),
    "PUT /api/v1/submissions/{submission_id}/judgements/{item:path}": Row(
        "401 404 404 404 404 403 ok", json={"points": 1, "comment": "x"}
    ),
    "POST /api/v1/practice": Row("401 ok ok ok ok ok ok", {"assignment": "square"}, files=SCRIPT, owner=""),
    "POST /api/v1/practice/events": Row(
        "401 ok ok ok ok ok ok", {"assignment": "square"}, files=SCRIPT, owner=""
    ),
    "POST /playground/car": Row("enter ok ok ok ok ok ok", {}, owner=""),
    "POST /api/v1/live": Row("401 ok ok ok ok ok ok", owner=""),
    "DELETE /api/v1/live": Row("401 ok ok ok ok ok ok", owner=""),
    # the class, by the interface
    "POST /api/v1/gradebook/fill": Row(
        "401 ok 403 403 ok ok ok", {}, files=SHEET, params={"column": "points"}, owner=""
    ),
    "POST /api/v1/regrades": Row("401 403 403 403 422 403 ok", json={"assignment": "straight"}),
    "POST /api/v1/regrades/{regrade_id}/apply": Row("401 403 403 403 404 403 ok", json=REGRADE),
    "POST /api/v1/regrades/{regrade_id}/discard": Row("401 403 403 403 404 403 ok", json=REGRADE),
    "POST /api/v1/regrades/{regrade_id}/undo": Row(
        "401 403 403 403 404 403 ok", json=REGRADE, first="POST /api/v1/regrades/{regrade_id}/apply"
    ),
    "PUT /api/v1/assignments/{assignment_id}/rules": Row(
        "401 403 403 403 ok 403 ok", json={"shown": "draft"}
    ),
    "PUT /api/v1/assignments/{assignment_id}/teams": Row(
        "401 403 403 403 ok 403 ok", json={"teams": []}, owner=""
    ),
    "PUT /api/v1/assignments/{assignment_id}/team": Row("401 409 409 409 409 409 409", json={}, owner=""),
    "DELETE /api/v1/assignments/{assignment_id}/team": Row("401 409 409 409 409 409 409", owner=""),
    "PUT /api/v1/assignments/{assignment_id}/extensions/{student}": Row(
        "401 403 403 403 422 403 ok", json={"extra_attempts": 1}
    ),
    "POST /api/v1/members/import": Row("401 403 403 403 ok 403 ok", {}, files=LIST),
    "PUT /api/v1/members/{person}": Row(
        "401 403 403 403 ok 403 ok", json={"name": "Nobody", "role": "student"}
    ),
    "DELETE /api/v1/members/{person}": Row("401 403 403 403 404 403 ok"),
    "POST /api/v1/members/{person}/tokens": Row("401 403 403 403 404 403 ok", json={}),
    "DELETE /api/v1/members/{person}/identities/{identity}": Row("401 403 403 403 404 403 ok"),
    "POST /api/v1/members/{person}/forget": Row("401 403 403 403 404 403 ok", json={}),
    "POST /api/v1/course/assignments": Row(
        "401 403 403 403 422 403 422", {}, files={"file": ("walk.zip", b"none")}, owner=""
    ),
    "DELETE /api/v1/course/assignments/{assignment_id}": Row("401 403 403 403 404 403 ok", ids=WALK),
    "PUT /api/v1/course": Row("401 403 403 403 ok 403 ok", json={"distro": "jazzy"}),
    "PUT /api/v1/course/archived": Row("401 403 403 403 ok 403 ok", json={"archived": True}, first=DISCARD),
    "POST /api/v1/course/retention": Row(
        "401 403 403 403 ok 403 ok", json={"older_than_days": 1, "dry_run": False}
    ),
    "POST /api/v1/courses": Row("401 403 403 403 ok 403 ok", json={"id": "{caller}"}),
    "PUT /api/v1/course/notices/webhooks/{outlet}": Row(
        "401 403 403 403 ok 403 ok", json={"vendor": "wecom", "address": BOT + "y"}
    ),
    "POST /api/v1/course/platforms": Row("401 403 403 403 409 403 409", json=PLATFORM, owner=""),
    "DELETE /api/v1/course/platforms/{platform}": Row("401 403 403 403 404 403 ok"),
    "POST /api/v1/course/platforms/{platform}/people": Row("401 403 403 403 404 403 409", owner=""),
    "DELETE /api/v1/course/notices/webhooks/{outlet}": Row("401 403 403 403 404 403 ok"),
    "PUT /api/v1/course/notices/mail": Row(
        "401 403 403 403 409 403 409", json={"due": True, "graded": True, "faults": True}, owner=""
    ),
    "POST /api/v1/course/notices/{outlet}/test": Row("401 403 403 403 404 403 502", owner=""),
}


@dataclass(frozen=True)
class Things:
    """What belongs to the first course, by the names of parameters; and what everybody sends along."""

    ids: dict[str, str]
    headers: dict[str, dict[str, str]]
    file: str

    def send(self, client: httpx.Client, route: str, row: Row, caller: str) -> str:
        """Send a request; return what came of it."""
        method, path = route.split()
        page = not path.startswith("/api/")
        named = {**self.ids, **row.ids, "caller": caller}
        data = _filled(row.data or {}, named)
        body: dict[str, Any] = {"data": {**data, FIELD: FORM_TOKEN}} if page else {}
        if row.data is not None and not page:
            body = {"data": data}
        if row.json is not None:
            body = {"json": _filled(row.json, named)}
        if row.files is not None:
            body["files"] = row.files
        headers = {**self.headers[caller], **(PAGE if page else {})}
        answer = client.request(
            method, path.replace(":path", "").format_map(named), params=row.params, headers=headers, **body
        )
        if answer.status_code == 303 and answer.headers["Location"].startswith("/enter"):
            return "enter"
        return "ok" if answer.status_code < 400 else str(answer.status_code)

    def rows(self) -> set[tuple[Any, ...]]:
        """Return all that is stored, each row behind the name of its table."""
        with closing(sqlite3.connect(self.file)) as connection:
            tables = connection.execute("SELECT name FROM sqlite_master WHERE type = 'table'").fetchall()
            return {
                (name, *row) for (name,) in tables for row in connection.execute(f'SELECT * FROM "{name}"')
            }


def _filled(fields: dict[str, Any], ids: dict[str, str]) -> dict[str, Any]:
    """Return fields with ids in the place of their names."""
    return {
        name: ids.get(str(value).strip("{}"), value) if "{" in str(value) else value
        for name, value in fields.items()
    }


@pytest.fixture(scope="module")
def prepared(
    courses: PreparedCourses, shipped: AssignmentSource, tmp_path_factory: pytest.TempPathFactory
) -> tuple[Things, datetime]:
    """Everything that an address or a form may name, of ``li`` and of the first course; and when that was made."""
    file = shutil.copy(courses.file, tmp_path_factory.mktemp("things") / "grader.db")
    with server.services(server.settings(database_url=f"sqlite:///{file}"), FakeClock()) as made:
        services = replace(made, assignments=shipped)
        return Things(*_stored(services), str(file)), services.clock()


@pytest.fixture
def sqlite_url(tmp_path: Path, prepared: tuple[Things, datetime]) -> str:
    return f"sqlite:///{shutil.copy(prepared[0].file, tmp_path / 'grader.db')}"


@pytest.fixture
def things(services: Services, sqlite_url: str, prepared: tuple[Things, datetime]) -> Things:
    made, services.clock.now = prepared
    return replace(made, file=sqlite_url.removeprefix("sqlite:///"))


def _stored(services: Services) -> tuple[dict[str, str], dict[str, dict[str, str]]]:
    members = [
        RosterEntry(id="li", name="", sections=("1",)),
        RosterEntry(id="bound", name="", role=Role.ASSISTANT, sections=("2",)),
        RosterEntry(id="without_token", name=""),
    ]
    services.courses.import_roster("ros", members, "test")
    services.courses.create("other", "Other", "UTC", "test")
    others = [
        RosterEntry(id=one, name="", role=role)
        for one, role in (("outsider", Role.STUDENT), ("stranger", Role.INSTRUCTOR))
    ]
    services.courses.import_roster("other", others, "test")
    ids = _made(services)
    services.clock.advance(2 * 24 * 3_600)  # old enough to be erased
    headers = {"nobody": {"Cookie": f"{COOKIE}={FORM_TOKEN}"}}
    for caller, course in {**HOME, **dict.fromkeys(("li", *STAFF), "ros")}.items():
        token = services.tokens.issue(course, PEOPLE.get(caller, caller), timedelta(days=9), "test")[1]
        session = services.callers.open_session(token)
        cookies = f"{SESSION_COOKIE}={session}; {COOKIE}={FORM_TOKEN}"
        headers[caller] = {"Authorization": f"Bearer {token}", "Cookie": cookies}
    return ids, headers


def _made(services: Services) -> dict[str, str]:
    wang, li = (Signature(services.clock(), "ros", who) for who in ("wang", "li"))
    services.rules.set("square", Rules(appeals_until=services.clock() + timedelta(days=9)), wang)
    services.rules.extend("square", "li", Extension(extra_attempts=3), wang)
    put_in(services, student="li", course="ros", assignment="straight", name="straight.py")
    submission = put_in(services, student="li", course="ros", source=b"bad").rpartition("/")[2]
    services.appeals.ask(submission, Asked(item="closed", reason="x", attempt=1, earned=0.0, points=5.0), li)
    regrade = services.regrades.open(Wanted(assignment="square"), wang).id
    grade_all(services)
    uploaded = NewOwnAssignment(assignment="walk", version=1, content=b"zip", reading=b"{}")
    services.own_assignments.add(uploaded, wang)
    assert services.identities.bind("campus", "1", "ros", "li", by_token=True)
    platform = services.platforms.add(new_platform(), wang)
    services.notices.set_webhook(
        NewWebhook(outlet=Outlet.CLASS, vendor=Vendor.WECOM, address=BOT, secret=""), wang
    )
    instructor = Caller(course="ros", person="wang", role=Role.INSTRUCTOR)
    tag = people.plan_import(services, instructor, LIST["file"][1]).tag
    (seen,) = (one.tag for one in judging.items_of(services, instructor, submission)[1] if one.id == "closed")
    return {
        "submission_id": submission, "regrade_id": regrade, "assignment_id": "square", "item": "closed",
        "student": "li", "person": "li", "identity": services.identities.of_member("ros", "li")[0].id,
        "platform": platform.id, "outlet": "class", "secret": "x" * 43, "tag": tag, "seen": seen,
    }  # fmt: skip


def changing(app: FastAPI) -> set[str]:
    """Return every route of the application that changes something."""
    routes = [one for route in app.routes for one in (route, *_included(route))]
    return {
        f"{method} {route.path}"
        for route in routes
        if isinstance(route, APIRoute)
        for method in route.methods - {"GET", "HEAD"}
    }


def _included(route: Any) -> Sequence[Any]:
    router = getattr(route, "original_router", None)
    return () if router is None else router.routes


def of_others(row: tuple[Any, ...], caller: str, ids: dict[str, str]) -> bool:
    """Return whether a stored row is about the course of others, or about somebody else's work in one's own."""
    foreign = {
        ids["submission_id"],
        ids["regrade_id"],
        ids["platform"],
        "li" if HOME[caller] == "ros" else "ros",
    }
    return not foreign.isdisjoint(map(str, row))


def is_own_session(row: tuple[Any, ...], caller: str) -> bool:
    return row[0] == "token" and PEOPLE.get(caller, caller) in row


def test_every_route_that_changes_something_has_a_row(running: tuple[FastAPI, str]) -> None:
    assert set(ROWS) == changing(running[0])
    assert len(ROWS) > 70


@pytest.mark.parametrize("route", sorted(ROWS))
def test_a_change_is_made_by_those_who_may(client: httpx.Client, things: Things, route: str) -> None:
    row = ROWS[route]
    if row.first:
        assert things.send(client, row.first, ROWS[row.first], row.owner) == "ok"
    answers = []
    for caller in FOREIGN:
        before = things.rows()
        answers.append(things.send(client, route, row, caller))
        changed = before ^ things.rows()
        if answers[-1] == "ok" and caller != "nobody":
            changed = {
                one
                for one in changed
                if of_others(one, caller, things.ids) and not is_own_session(one, caller)
            }
        assert changed == set(), caller
    before = things.rows()
    if row.owner == "li":
        assert things.send(client, route, row, "li") == "ok"
    answers += [things.send(client, route, row, caller) for caller in STAFF]
    assert " ".join(answers) == row.answers
    if row.owner:
        assert things.rows() != before
