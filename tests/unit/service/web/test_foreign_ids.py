"""Whoever may not see a submission or a re-grade learns from no address whether there is one of that id.

All of the OpenAPI document and all pages are walked, so a new route is asked, too. What an answer about something
foreign says must be, but for the id, what the caller is told of something that never was.
"""

import json
import re
import uuid
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from datetime import timedelta
from typing import Any

import httpx
import pytest
from fastapi.routing import APIRoute

from grader.contracts.identity import Role, RosterEntry
from grader.contracts.regrade import Wanted
from grader.contracts.rules import Rules
from grader.service.web.access import SESSION_COOKIE
from grader.service.web.forms import COOKIE, FIELD
from grader.service.web.routing import ROUTERS
from grader.store.audit import Signature
from grader.use_cases.services import Services
from tests.fakes.server import GOLDEN_OPENAPI
from tests.unit.service.web.conftest import PAGE

FORM_TOKEN = "t" * 32
DOCUMENT = json.loads(GOLDEN_OPENAPI.read_text())
REFUSALS = {303, 401, 403, 404}
NEVER = {"submission_id": str(uuid.UUID(int=7)), "regrade_id": "0123456789ab"}
HIDDEN = {"bound": ("submission_id",)}
"""What is not shown to whom, if not all: a re-grade of the class concerns the assistant's own students as well."""
OF_ANOTHER = {"outsider": "student", "stranger": "instructor"}
FIELDS = {
    FIELD: FORM_TOKEN, "text": "x", "reason": "x", "points": "1", "item": "closed", "comment": "x",
}  # fmt: skip


@dataclass(frozen=True)
class Operation:
    """One request that names something by its id.

    Attributes:
        body: what makes it well-formed, in the words of httpx.
    """

    method: str
    path: str
    body: dict[str, Any] = field(default_factory=dict)

    def __str__(self) -> str:
        return f"{self.method} {self.path}"


def on_the_interface() -> Iterator[Operation]:
    for path, methods in DOCUMENT["paths"].items():
        for method, told in methods.items():
            content = told.get("requestBody", {}).get("content", {})
            schema = content.get("application/json", {}).get("schema")
            yield Operation(method.upper(), path, {} if schema is None else {"json": well_formed(schema)})


def on_pages() -> Iterator[Operation]:
    for router in ROUTERS:
        for route in router.routes:
            if isinstance(route, APIRoute):
                decision = {"decision": "discard" if "regrades" in route.path else "refused"}
                for method in route.methods or ():
                    body = {} if method == "GET" else {"data": {**FIELDS, **decision}}
                    yield Operation(method, route.path, body)


def well_formed(schema: dict[str, Any]) -> Any:
    """Return the smallest value that a schema of the document takes."""
    if "$ref" in schema:
        return well_formed(DOCUMENT["components"]["schemas"][schema["$ref"].rpartition("/")[2]])
    for key in ("examples", "enum"):
        if key in schema:
            return schema[key][0]
    if "anyOf" in schema:
        return well_formed(schema["anyOf"][0])
    if schema.get("type") == "object":
        return {name: well_formed(schema["properties"][name]) for name in schema.get("required", ())}
    if schema.get("type") == "array":
        return [well_formed(schema["items"])]
    return {"string": "x", "boolean": True}.get(schema.get("type", ""), 1)


OPERATIONS = [
    one for one in (*on_the_interface(), *on_pages()) if any(f"{{{name}}}" in one.path for name in NEVER)
]


@pytest.fixture
def ids(
    services: Services, tokens: dict[str, str], put: Callable[..., str], grade_waiting: Callable[..., None]
) -> dict[str, str]:
    """Work by ``li`` of section 1 that has everything an address may name, and a re-grade of it."""
    bound = RosterEntry(id="bound", name="", role=Role.ASSISTANT, sections=("2",))
    services.courses.import_roster("ros", [RosterEntry(id="li", name="", sections=("1",)), bound], "test")
    signed = Signature(services.clock(), "ros", "wang")
    services.rules.set("square", Rules(appeals_until=services.clock() + timedelta(days=9)), signed)
    submission = put(student="li", course="ros").rpartition("/")[2]
    services.comments.add(submission, "x", None, Signature(services.clock(), "ros", "li"), by_student=True)
    regrade = services.regrades.open(Wanted(assignment="square"), signed).id
    grade_waiting()
    named = {"assignment_id": "square", "item": "closed", "platform": "gradescope"}
    return {"submission_id": submission, "regrade_id": regrade, **named}


@pytest.fixture
def callers(services: Services, ids: dict[str, str], tokens: dict[str, str]) -> dict[str, dict[str, str]]:
    """What each who may not see them sends with a request, at both doors."""
    services.courses.create("other", "Other", "UTC", "test")
    others = [RosterEntry(id=name, name="", role=Role(role)) for name, role in OF_ANOTHER.items()]
    services.courses.import_roster("other", others, "test")

    def token(course: str, person: str) -> str:
        return services.tokens.issue(course, person, timedelta(days=1), "test")[1]

    shown = {"classmate": tokens["han"], "bound": token("ros", "bound")}
    shown |= {name: token("other", name) for name in OF_ANOTHER}
    cookies = {
        name: f"{SESSION_COOKIE}={services.callers.open_session(one)}; " for name, one in shown.items()
    }
    headers = {
        name: {"Authorization": f"Bearer {one}", "Cookie": f"{cookies[name]}{COOKIE}={FORM_TOKEN}"}
        for name, one in shown.items()
    }
    return {**headers, "nobody": {"Cookie": f"{COOKIE}={FORM_TOKEN}"}}


def told(
    client: httpx.Client, operation: Operation, ids: dict[str, str], headers: dict[str, str]
) -> tuple[int, str]:
    """Return status and text of the answer, with the ids that were asked for left out."""
    is_page = not operation.path.startswith("/api/")
    accept, pair = (PAGE, {"first": "1", "second": "1"}) if is_page else ({}, {})  # two gradings are compared
    path = operation.path.format_map(ids)
    with client.stream(
        operation.method, path, params=pair, headers={**headers, **accept}, **operation.body
    ) as answer:
        # a stream of events never ends: whoever gets one is told something
        text = answer.read().decode() if answer.status_code in REFUSALS else ""
        location = answer.headers.get("Location", "")
    for one in (*ids.values(), answer.headers["X-Request-ID"]):
        text, location = text.replace(one, "…"), location.replace(one, "…")
    return answer.status_code, re.sub(r"urn:uuid:[0-9a-f-]+", "", text) + location


@pytest.mark.parametrize("name", ["classmate", "bound", "outsider", "nobody", "stranger"])
def test_nobody_learns_whether_something_foreign_exists(
    client: httpx.Client,
    services: Services,
    ids: dict[str, str],
    callers: dict[str, dict[str, str]],
    name: str,
) -> None:
    before = services.submissions.get(ids["submission_id"])
    assert len(callers) == 5
    for operation in OPERATIONS:
        never = {key: NEVER[key] for key in HIDDEN.get(name, NEVER)}
        if not any(f"{{{key}}}" in operation.path for key in never):
            continue
        foreign = told(client, operation, ids, callers[name])
        assert foreign[0] in REFUSALS, str(operation)
        assert foreign == told(client, operation, {**ids, **never}, callers[name]), str(operation)
    assert services.submissions.get(ids["submission_id"]) == before
    assert len(OPERATIONS) > 50


def test_the_owner_is_told_something_else(
    client: httpx.Client, ids: dict[str, str], tokens: dict[str, str]
) -> None:
    """Else the other test would say nothing."""
    own = {"Authorization": f"Bearer {tokens['li']}"}
    read = [one for one in OPERATIONS if str(one) == "GET /api/v1/submissions/{submission_id}"]
    (operation,) = read
    assert told(client, operation, ids, own)[0] == httpx.codes.OK
    assert told(client, operation, {**ids, **NEVER}, own)[0] == httpx.codes.NOT_FOUND
