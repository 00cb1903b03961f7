"""Due dates of sections: what holds for whom, and for who changes section."""

from collections.abc import Callable
from datetime import UTC, datetime, timedelta
from typing import Any

import httpx
import pytest

from grader.contracts.identity import RosterEntry
from grader.contracts.rules import LateRule, RuleError, Rules, SectionRule
from grader.store.audit import Signature
from grader.use_cases.services import Services
from tests.unit.service.routes.conftest import School

URL = "/api/v1/assignments/square/rules"


def rule(section: str, due: datetime, **more: Any) -> SectionRule:
    return SectionRule(section=section, due=due, **more)


@pytest.fixture
def ruled(services: Services, school: School) -> Services:
    """Let `li` be in section A, `han` in none; it is an hour after A's due date, and a day before the course's."""
    now = services.clock()
    services.courses.import_roster("ros", [RosterEntry(id="li", name="", sections=("A",))], "wang")
    late = LateRule(kind="linear", per_day=0.5)
    rules = Rules(
        due=now + timedelta(days=1),
        by_section=(rule("A", now - timedelta(hours=1), late=late), rule("B", now - timedelta(days=1))),
    )
    services.rules.set("square", rules, Signature(now, "ros", "wang"))
    return services


def test_a_section_has_a_due_date_and_a_late_rule_of_its_own(
    client: httpx.Client, graded: Callable[..., str], school: School, ruled: Services
) -> None:
    for person, share in (("li", 0.5), ("han", 1.0)):
        url = graded(student="", headers=school.as_(person))
        score = client.get(url, headers=school.as_(person)).json()["score"]
        standing = client.get(URL, headers=school.as_(person)).json()
        assert standing["counted_score"] == score * share, person
        assert standing["rules"]["by_section"] == []  # other sections are nobody's business
    rows = client.get("/api/v1/gradebook.csv", headers=school.as_("wang")).text.splitlines()[1:]
    li, han = ([float(one) for one in row.split(",")[2:] if one] for row in sorted(rows, reverse=True))
    assert li[0] * 2 == han[0]


def test_who_changes_section_gets_the_new_sections_date(
    client: httpx.Client, school: School, ruled: Services, upload: Callable[..., httpx.Response]
) -> None:
    now = ruled.clock()
    assert client.get(URL, headers=school.as_("li")).json()["your_due"] == _iso(now - timedelta(hours=1))
    for sections, due in ((("B",), now - timedelta(days=1)), (("A", "B"), now - timedelta(hours=1))):
        client.put(
            "/api/v1/members/li", json={"sections": list(sections)}, headers=school.as_("wang")
        ).raise_for_status()
        assert client.get(URL, headers=school.as_("li")).json()["your_due"] == _iso(due)
    client.put("/api/v1/members/li", json={"sections": []}, headers=school.as_("wang"))
    assert client.get(URL, headers=school.as_("li")).json()["your_due"] == _iso(now + timedelta(days=1))


def test_an_upload_is_refused_by_the_date_of_the_section(
    client: httpx.Client, school: School, ruled: Services, upload: Callable[..., httpx.Response]
) -> None:
    wang = school.as_("wang")
    before = client.get(URL, headers=wang)
    body = {
        "due": _iso(ruled.clock() + timedelta(days=1)),
        "by_section": [{"section": "A", "due": _iso(ruled.clock() - timedelta(hours=1)), "accept_late_s": 0}],
    }
    changed = client.put(URL, json=body, headers=wang | {"If-Match": before.headers["ETag"]})
    assert changed.json()["by_section"][0]["section"] == "A"
    assert upload(student="", headers=school.as_("li")).json()["code"] == "closed"
    assert upload(student="", headers=school.as_("han")).status_code == 202
    assert changed.json()["by_section"][0]["late"] == changed.json()["late"]  # it moves a date, no more
    assert changed.json()["by_section"][0]["accept_late_s"] == 0
    twice = {"by_section": body["by_section"] * 2}
    refused = client.put(URL, json=twice, headers=wang)
    assert (refused.status_code, refused.json()["field"]) == (422, "by_section")


def test_sections_move_with_a_copy_and_never_come_before_the_opening() -> None:
    due = datetime(2026, 3, 2, 8, tzinfo=UTC)
    rules = Rules(opens=due - timedelta(days=1), due=due, by_section=(rule("A", due),))
    moved = rules.moved(7, UTC)  # type: ignore[arg-type]
    assert moved.by_section[0].due == due + timedelta(days=7)
    with pytest.raises(RuleError, match="later than opens"):
        rules.with_section("A", rule("A", due - timedelta(days=2)))
    assert rules.with_section("A", None).by_section == ()


def _iso(instant: datetime) -> str:
    return instant.isoformat().replace("+00:00", "Z")
