"""Rules of assignments over HTTP."""

import json
from collections.abc import Callable
from dataclasses import replace
from datetime import timedelta
from typing import Any

import httpx
import pytest

from grader.contracts.grading import GradingJob, GradingResult
from grader.contracts.rubric import ItemStatus
from grader.messages import say
from grader.use_cases.services import Services
from tests.fakes.clock import START, FakeClock
from tests.fakes.grading import grade, grade_next

Upload = Callable[..., httpx.Response]
RULES = "/api/v1/assignments/square/rules"


@pytest.fixture
def ruled(client: httpx.Client, school: Any) -> Callable[..., httpx.Response]:
    def change(**rules: object) -> httpx.Response:
        return client.put(RULES, json=rules, headers=school.as_("wang"))

    return change


@pytest.fixture
def hand_in(upload: Upload, school: Any) -> Callable[..., httpx.Response]:
    def send(source: bytes = b"good good\n", person: str = "li") -> httpx.Response:
        return upload(source, student="", headers={**school.as_(person), "Accept-Language": "en"})

    return send


def at(seconds: float) -> str:
    return (START + timedelta(seconds=seconds)).isoformat()


def test_rules_are_changed_whole_and_written_down(
    client: httpx.Client, ruled: Callable[..., httpx.Response], school: Any
) -> None:
    assert ruled(due="2026-03-20T23:59:59", attempts=3, reason="term plan").status_code == 200
    assert ruled(attempts=5).json()["due"] is None
    document = client.get(RULES, headers=school.as_("li")).json()
    assert (document["rules"]["attempts"], document["attempts_left"]) == (5, 5)
    second, first = client.get("/api/v1/audit", headers=school.as_("wang"), params={"limit": 2}).json()[
        "entries"
    ]
    assert (first["action"], first["actor"], first["reason"]) == ("rules.change", "wang", "term plan")
    assert first["before"]["due"] is None
    assert first["after"]["due"] == second["before"]["due"] == "2026-03-20T23:59:59+08:00"


def test_rules_that_were_changed_meanwhile_stay(
    client: httpx.Client, ruled: Callable[..., httpx.Response], school: Any
) -> None:
    seen = client.get(RULES, headers=school.as_("ta")).headers["ETag"]
    assert "ETag" not in client.get(RULES, headers=school.as_("li")).headers
    now = ruled(attempts=3).headers["ETag"]
    matching = {**school.as_("wang"), "If-Match": seen}
    refused = client.put(RULES, json={"attempts": 9}, headers=matching)
    assert (refused.status_code, refused.json()["code"]) == (412, "changed_meanwhile")
    answer = client.get(RULES, headers=school.as_("wang"))
    assert (answer.json()["rules"]["attempts"], answer.headers["ETag"]) == (3, now)
    matching["If-Match"] = f"{seen}, {now}"
    assert client.put(RULES, json={"attempts": 9}, headers=matching).status_code == 200


def test_a_tag_of_rules_is_none_of_where_one_stands(
    client: httpx.Client, school: Any, upload: Callable[..., httpx.Response]
) -> None:
    """How many attempts are used stands beside the rules, and changes without them."""
    ta = school.as_("ta")
    first = client.get(RULES, headers=ta)
    assert upload(student="ta", headers=ta).status_code == 202
    again = client.get(RULES, headers={**ta, "If-None-Match": first.headers["ETag"]})
    assert (again.status_code, again.headers["ETag"]) == (200, first.headers["ETag"])
    assert (first.json()["attempts_used"], again.json()["attempts_used"]) == (0, 1)


def test_an_extension_that_was_changed_meanwhile_stays(client: httpx.Client, school: Any) -> None:
    address = "/api/v1/assignments/square/extensions/li"
    wang = school.as_("wang")
    due = {"due": "2026-03-27T23:59:59"}  # on the course's clock; databases keep UTC
    seen = client.put(address, json={"extra_attempts": 1, **due}, headers=wang).json()["etag"]
    matching = {**wang, "If-Match": seen}
    assert client.put(address, json={"extra_attempts": 2}, headers=matching).status_code == 200
    refused = client.put(address, json={"extra_attempts": 3}, headers=matching)
    assert (refused.status_code, refused.json()["code"]) == (412, "changed_meanwhile")


def test_rules_hold_for_one_course(
    client: httpx.Client, ruled: Callable[..., httpx.Response], school: Any
) -> None:
    ruled(attempts=3)
    assert client.get(RULES, headers=school.as_("li2")).json()["rules"]["attempts"] is None


@pytest.mark.parametrize(
    ("rules", "code"),
    [
        ({"opens": at(10), "due": at(5)}, "invalid_rules"),
        ({"counts": "best_before_due"}, "invalid_rules"),
        ({"late": {"kind": "linear"}}, "invalid_rules"),
        ({"hidden_items": ["nose"]}, "invalid_rules"),
        ({"attempts": 0}, "invalid_request"),
        ({"attempts": 2.5}, "invalid_request"),
        ({"attempts": "10"}, "invalid_request"),
        ({"attempts": "1_0"}, "invalid_request"),
        ({"attempts": True}, "invalid_request"),
        ({"late": {"kind": "linear", "per_day": "0.1"}}, "invalid_request"),
        ({"due": 1_772_409_600}, "invalid_request"),
        ({"due": "1772409600"}, "invalid_request"),
        ({"due": "2026-03-20"}, "invalid_request"),
        ({"due": "9999-12-31T23:59:59"}, "invalid_request"),
        ({"deadline": at(5)}, "invalid_request"),
    ],
)
def test_rules_that_make_no_sense(
    ruled: Callable[..., httpx.Response], rules: dict[str, object], code: str
) -> None:
    response = ruled(**rules)
    assert (response.status_code, response.json()["code"]) == (422, code)


@pytest.mark.parametrize(
    ("rules", "field", "words"),
    [
        ({"opens": at(10), "due": at(5)}, "due", "晚于"),
        ({"late": {"kind": "linear"}}, "late.per_day", "大于 0"),
        ({"due": "9999-12-31T23:59:59"}, "due", "年份要在 2000 到 2200 之间。"),
    ],
)
def test_what_is_wrong_is_said_in_the_readers_language(
    ruled: Callable[..., httpx.Response], rules: dict[str, object], field: str, words: str
) -> None:
    problem = ruled(**rules).json()
    assert problem["field"] == field
    assert words in problem["detail"]


def test_a_hidden_item_that_there_is_not_is_named(ruled: Callable[..., httpx.Response]) -> None:
    problem = ruled(hidden_items=["nose"]).json()
    assert (problem["field"], problem["detail"]) == ("hidden_items", "没有这个评分项：nose。")


def test_too_early_and_too_late(
    ruled: Callable[..., httpx.Response], hand_in: Callable[..., httpx.Response], clock: FakeClock
) -> None:
    ruled(opens=at(100), due=at(200), accept_late_s=50)
    response = hand_in()
    assert (response.status_code, response.json()["code"]) == (403, "not_open_yet")
    assert at(100) in response.json()["detail"]
    clock.advance(100)
    assert hand_in().status_code == 202
    clock.advance(151)
    assert hand_in().json()["code"] == "closed"


def test_staff_is_not_ruled(
    ruled: Callable[..., httpx.Response], hand_in: Callable[..., httpx.Response]
) -> None:
    ruled(opens=at(100))
    assert hand_in(person="wang").status_code == 202


def test_attempts_run_out_and_faults_cost_none(
    ruled: Callable[..., httpx.Response],
    hand_in: Callable[..., httpx.Response],
    client: httpx.Client,
    services: Services,
    school: Any,
) -> None:
    ruled(attempts=1)
    assert hand_in(b"def broken(").json()["code"] == "syntax_error"
    assert hand_in().status_code == 202
    assert hand_in().json()["code"] == "no_attempts_left"
    for _ in range(3):
        services.queue.fail(services.queue.claim("w"), "no")
    assert client.get(RULES, headers=school.as_("li")).json()["attempts_left"] == 1
    assert hand_in().status_code == 202


def test_an_extension_for_one(
    client: httpx.Client,
    ruled: Callable[..., httpx.Response],
    hand_in: Callable[..., httpx.Response],
    clock: FakeClock,
    school: Any,
) -> None:
    ruled(due=at(100), accept_late_s=0)
    url = "/api/v1/assignments/square/extensions"
    body = {"due": at(1000), "reason": "ill"}
    assert client.put(f"{url}/li", json=body, headers=school.as_("wang")).status_code == 200
    assert client.put(f"{url}/nobody", json=body, headers=school.as_("wang")).status_code == 422
    clock.advance(500)
    assert hand_in(person="li").status_code == 202
    assert hand_in(person="han").json()["code"] == "closed"
    (listed,) = client.get(url, headers=school.as_("ta")).json()["extensions"]
    assert (listed["student"], listed["extra_attempts"]) == ("li", 0)
    client.put(f"{url}/li", json={}, headers=school.as_("wang"))
    assert client.get(url, headers=school.as_("ta")).json()["extensions"] == []


def test_lateness_shows_and_counts(
    client: httpx.Client,
    ruled: Callable[..., httpx.Response],
    graded: Callable[..., str],
    clock: FakeClock,
    school: Any,
) -> None:
    ruled(due=at(100), late={"kind": "linear", "per_day": 0.5})
    clock.advance(160)
    url = graded(b"good good", student="", headers=school.as_("li"))
    clock.advance(3600)
    document = client.get(url, headers=school.as_("li")).json()
    assert (document["score"], document["late_s"], document["kept_share"], document["kept_score"]) == (
        10.0,
        60.0,
        0.5,
        5.0,
    )
    standing = client.get(RULES, headers=school.as_("li")).json()
    assert (standing["counted_submission"], standing["counted_score"]) == (url, 5.0)
    (row,) = client.get("/api/v1/dashboard", headers=school.as_("ta")).json()["students"]
    assert (row["total_score"], row["assignments"]["square"]["passed"]) == (5.0, False)


def test_hidden_items_are_nowhere_until_their_date(
    client: httpx.Client,
    ruled: Callable[..., httpx.Response],
    graded: Callable[..., str],
    clock: FakeClock,
    school: Any,
) -> None:
    ruled(hidden_items=["closed"], hidden_until=at(1000))
    url = graded(b"good good", student="", headers=school.as_("li"))
    student, teacher = school.as_("li"), school.as_("wang")
    seen = [
        client.get(path, headers=student).text
        for path in (url, url + "/report", RULES, "/api/v1/assignments/square")
    ]
    assert all("closed" not in text for text in seen)
    assert (json.loads(seen[0])["score"], json.loads(seen[0])["max_score"]) == (5.0, 5.0)
    assert json.loads(seen[3])["max_score"] == 5.0
    assert client.get(url + "/plot.png", headers=student).status_code == 200
    assert client.get(url, headers=teacher).json()["score"] == 10.0
    clock.advance(1000)
    assert client.get(url, headers=student).json()["score"] == 10.0
    assert "closed" in client.get("/api/v1/assignments/square", headers=student).text


@pytest.mark.parametrize("sentence", ["item.not_checked", "item.in_part"])
def test_what_needs_a_hidden_item_does_not_tell_of_it(
    client: httpx.Client,
    ruled: Callable[..., httpx.Response],
    hand_in: Callable[..., httpx.Response],
    services: Services,
    school: Any,
    sentence: str,
) -> None:
    def grading(job: GradingJob) -> GradingResult:
        result = grade(job)
        sides, closed = result.report.items
        told = say(sentence, seen="", share="50 %", items=sides.title)
        closed = replace(closed, status=ItemStatus.NOT_CHECKED, message=told)
        return replace(result, report=replace(result.report, items=(sides, closed)))

    url = hand_in(b"bad\n").headers["Location"]
    assert grade_next(services.queue, services.assignments, grading)
    assert "边数" in client.get(url, headers=school.as_("li")).json()["rubric"][1]["message"]
    ruled(hidden_items=["sides"])
    for path in (url, url + "/report"):
        assert "边数" not in client.get(path, headers=school.as_("li")).text
    assert "边数" in client.get(url, headers=school.as_("wang")).json()["rubric"][1]["message"]


def test_a_draft_has_no_name_for_students(
    ruled: Callable[..., httpx.Response],
    hand_in: Callable[..., httpx.Response],
    client: httpx.Client,
    school: Any,
) -> None:
    ruled(shown="draft")
    refused = hand_in().json()
    assert (refused["code"], "square" in refused["allowed"]) == ("unknown_assignment", False)
    listed = client.get("/api/v1/assignments/none", headers=school.as_("li")).json()["allowed"]
    assert listed
    assert "square" not in listed
    to_staff = client.get("/api/v1/assignments/none", headers=school.as_("wang")).json()["allowed"]
    assert "square" in to_staff
