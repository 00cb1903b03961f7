"""The list of submissions: whose, which, page by page."""

from collections.abc import Callable
from datetime import timedelta
from typing import Any
from zoneinfo import ZoneInfo

import httpx

from grader.contracts.rules import Rules
from grader.store.audit import Signature
from grader.use_cases.services import Services
from tests.fakes.clock import START, FakeClock

URL = "/api/v1/submissions"


def listed(client: httpx.Client, headers: dict[str, str], **params: object) -> list[tuple[str, str]]:
    """Student and assignment of every line, over all pages."""
    lines, after = [], None
    while True:
        page = client.get(
            URL, headers=headers, params={**params, **({"after": after} if after else {})}
        ).json()
        lines += [(one["student"], one["assignment"]) for one in page["submissions"]]
        after = page["next_after"]
        if after is None:
            return lines


def test_everything_is_listed_once(
    client: httpx.Client, graded: Callable[..., str], school: Any, clock: FakeClock
) -> None:
    for person, assignment in (("li", "square"), ("han", "square"), ("li", "straight"), ("wang", "square")):
        graded(b"good", student="", assignment=assignment, headers=school.as_(person))
        clock.advance(60.0)
    everything = [("li", "square"), ("han", "square"), ("li", "straight")]  # no staff
    for limit in (1, 2, 100):
        assert listed(client, school.as_("ta"), limit=limit) == everything
    assert listed(client, school.as_("ta"), student="li", assignment="square") == [("li", "square")]
    assert listed(client, school.as_("ta"), since=START.isoformat()) == everything
    assert listed(client, school.as_("ta"), status="queued") == []
    local = START.astimezone(ZoneInfo("Asia/Shanghai")).replace(tzinfo=None)
    assert listed(client, school.as_("ta"), since=local.isoformat()) == everything
    assert listed(client, school.as_("ta"), since=(local + timedelta(days=1)).isoformat()) == []
    for after in ("zzz", "1"):  # as the end of the list, it would end a program's loop too soon
        refused = client.get(URL, headers=school.as_("ta"), params={"after": after})
        assert (refused.status_code, refused.json()["field"]) == (422, "query.after"), after
    for since in ("2026-03-02", "0", "1.5", "0001-01-01T00:00:00+14:00", "9999-12-31T23:59:59-14:00"):
        refused = client.get(URL, headers=school.as_("ta"), params={"since": since})
        assert (refused.status_code, refused.json()["code"]) == (422, "invalid_request"), since


def test_students_get_their_own_without_what_is_hidden(
    client: httpx.Client, graded: Callable[..., str], school: Any, services: Services
) -> None:
    services.rules.set("square", Rules(hidden_items=("closed",)), Signature(START, "ros", "t"))
    for person in ("li", "han"):
        graded(b"good good", student="", headers=school.as_(person))
    assert listed(client, school.as_("li"), student="han") == [("li", "square")]
    own = client.get(URL, headers=school.as_("li")).json()["submissions"][0]
    whole = client.get(URL, headers=school.as_("ta"), params={"student": "li"}).json()["submissions"][0]
    assert (own["max_score"], whole["max_score"]) == (5.0, 10.0)
