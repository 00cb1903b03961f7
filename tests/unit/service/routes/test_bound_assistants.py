"""An assistant who is bound to sections sees their students' work, and nobody else's, at every address."""

from collections.abc import Callable
from datetime import timedelta
from typing import Any

import httpx
import pytest

from grader.contracts.identity import Role, RosterEntry
from grader.contracts.rules import Extension, Rules
from grader.store.appeals import Asked
from grader.store.audit import Signature
from grader.use_cases.services import Services
from tests.fakes.server import operations

SILENT = {"/openapi.json", "/healthz", "/metrics", "/api/v1/dashboard/events"}


@pytest.fixture
def bound(
    services: Services, school: Any, upload: Callable[..., httpx.Response], answered: Callable[..., str]
) -> dict[str, str]:
    """Work by ``li`` of section 1 and ``han`` of section 2, of every kind; ``ta`` is bound to section 1.

    Return the submissions' addresses.
    """
    roster = [
        RosterEntry(id="li", name="", sections=("1",)),
        RosterEntry(id="han", name="Han Meimei", sections=("2",)),
        RosterEntry(id="ta", name="", role=Role.ASSISTANT, sections=("1",)),
    ]
    services.courses.import_roster("ros", roster, "wang")
    signed = Signature(services.clock(), "ros", "wang")
    until = services.clock() + timedelta(days=1)
    services.rules.set("essay", Rules(appeals_until=until), signed)
    services.rules.extend("essay", "han", Extension(extra_attempts=3), signed)
    urls = {who: answered(who) for who in ("li", "han")}
    for who, url in urls.items():
        own = Signature(services.clock(), "ros", who)
        id_ = url.rpartition("/")[2]
        asked = Asked(item="timer", reason=f"by {who}", attempt=1, earned=0.0, points=45.0)
        services.appeals.ask(id_, asked, own)
        services.comments.add(id_, f"by {who}", None, own, by_student=True)
    return urls


def test_others_are_not_found_and_in_no_list(
    client: httpx.Client, school: Any, bound: dict[str, str], services: Services
) -> None:
    ta, foreign = school.as_("ta"), bound["han"].rpartition("/")[2]
    listed: dict[str, str] = {}
    for template, method in operations():
        if method != "get" or template in SILENT:
            continue
        of = {
            "assignment_id": "essay",
            "code": "empty",
            "platform": "none",
            "person": "han",
            "item": "timer",
            "regrade_id": "none",
        }
        path = template.format(submission_id=foreign, **of)
        answer = client.get(path, headers=ta)
        if "{submission_id}" in template:
            assert answer.status_code == 404, path
        else:
            listed[path] = answer.text
    told = [path for path, text in listed.items() if foreign in text or '"han"' in text or "Meimei" in text]
    assert told == []
    own = bound["li"].rpartition("/")[2]
    for path in ("/api/v1/submissions", "/api/v1/judgements/waiting", "/api/v1/appeals", "/api/v1/dashboard"):
        assert own in listed[path], path
    assert "li" in listed["/api/v1/gradebook.csv"]
    assert client.get(bound["li"], headers=ta).status_code == 200


def test_a_regrade_of_others_alone_is_not_found(
    client: httpx.Client, school: Any, bound: dict[str, str], services: Services
) -> None:
    """Without its students it would look like one of everybody."""
    made = {}
    for students in (("han",), ("li", "han")):
        body = {"assignment": "essay", "students": students}
        made[students] = client.post("/api/v1/regrades", json=body, headers=school.as_("wang")).headers[
            "Location"
        ]
        client.post(f"{made[students]}/discard", json={"reason": "x"}, headers=school.as_("wang"))
    ta = school.as_("ta")
    (seen,) = client.get("/api/v1/regrades", headers=ta).json()["regrades"]
    assert seen["students"] == ["li"]
    assert [client.get(url, headers=ta).status_code for url in made.values()] == [404, 200]
    assert len(client.get("/api/v1/regrades", headers=school.as_("wang")).json()["regrades"]) == 2


def test_without_sections_an_assistant_sees_everybody(
    client: httpx.Client, school: Any, bound: dict[str, str], services: Services
) -> None:
    unbound = RosterEntry(id="ta", name="", sections=())
    services.courses.import_roster("ros", [unbound], "wang")
    assert client.get(bound["han"], headers=school.as_("ta")).status_code == 200
    empty = RosterEntry(id="ta", name="", sections=("nobody's",))
    services.courses.import_roster("ros", [empty], "wang")
    assert client.get(bound["li"], headers=school.as_("ta")).status_code == 404
