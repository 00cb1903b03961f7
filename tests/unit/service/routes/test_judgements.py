"""Points that people give: taken once each, shown to whom they concern, and added up in every place."""

import csv
import hashlib
import io
from collections.abc import Callable
from typing import Any

import httpx
import pytest

from grader.contracts.rules import Rules
from grader.store.audit import Signature
from grader.use_cases.services import Services
from tests.fakes.clock import START
from tests.fakes.essays import ANSWER

WAITING = "/api/v1/judgements/waiting"


def test_once_all_is_judged_the_score_is_complete_everywhere(
    client: httpx.Client, school: Any, answered: Callable[..., str], give: Callable[..., httpx.Response]
) -> None:
    url = answered()
    report = client.get(url + "/report", headers=school.as_("li"))
    before = client.get(url, headers=school.as_("li")).json()
    assert (before["verdict"], before["score"], before["to_judge"]) == ("needs_manual", None, 2)
    assert give(url, "publisher", 45).json()["judgement"]["by"] == "ta"
    half = client.get(url, headers=school.as_("li")).json()
    assert (half["verdict"], half["score"], half["to_judge"]) == ("needs_manual", None, 1)
    assert [one["status"] for one in half["rubric"]] == ["passed", "passed", "needs_manual"]
    assert give(url, "timer", 22.5, "wang", comment="Who calls it?").status_code == 200

    whole = client.get(url, headers=school.as_("li"), params={"lang": "en"}).json()
    assert (whole["verdict"], whole["score"], whole["to_judge"]) == ("graded", 77.5, 0)
    assert (whole["rubric"][2]["status"], whole["rubric"][2]["earned"]) == ("partial", 22.5)
    assert whole["rubric"][2]["message"] == "Who calls it?"
    assert whole["summary"] == "A person has graded this: 77.5 / 100 points."
    again = client.get(url + "/report", headers=school.as_("li"))
    assert again.content == report.content
    assert again.headers["ETag"] == f'"{hashlib.sha256(report.content).hexdigest()}"'
    gradescope = client.get(url + "/gradescope.json", headers=school.as_("li")).json()
    assert (gradescope["score"], [one["score"] for one in gradescope["tests"]]) == (77.5, [10.0, 45.0, 22.5])
    assert client.get(url + "/prairielearn.json", headers=school.as_("li")).json()["score"] == 0.775
    book = client.get("/api/v1/gradebook.csv", headers=school.as_("ta")).text.removeprefix("\ufeff")
    rows = {row["student"]: row["essay (100)"] for row in csv.DictReader(io.StringIO(book))}
    assert rows == {"han": "", "li": "77.5"}
    cell = client.get("/api/v1/dashboard", headers=school.as_("ta")).json()["students"][0]
    assert cell["assignments"]["essay"]["counted_score"] == 77.5


def test_an_item_without_points_from_a_person_is_failed(
    client: httpx.Client, school: Any, answered: Callable[..., str], give: Callable[..., httpx.Response]
) -> None:
    def failed() -> list[tuple[str, int, int]]:
        (essay,) = client.get("/api/v1/dashboard", headers=school.as_("ta")).json()["assignments"]
        return [(one["id"], one["count"], one["still"]) for one in essay["most_failed_items"]]

    first = answered()
    assert failed() == []
    seen = give(first, "timer", 0).json()["etag"]
    assert failed() == [("timer", 1, 0)]  # no best submission yet: one item waits
    give(first, "publisher", 45)
    assert failed() == [("timer", 1, 1)]
    again = answered(answer=ANSWER + b"More.")
    for item in ("publisher", "timer"):
        give(again, item, 45)
    assert failed() == [("timer", 1, 0)]
    assert give(first, "timer", 0.01, seen=seen).status_code == 200  # the latest judgement counts
    assert failed() == []


@pytest.mark.parametrize(
    ("points", "code", "field"),
    [
        (-0.5, "invalid_request", "points"),
        (45.5, "invalid_points", "points"),
        (1.234, "invalid_points", "points"),
        ("many", "invalid_request", "points"),
        (None, "invalid_request", "points"),
    ],
)
def test_points_out_of_range_name_the_field(
    points: object,
    code: str,
    field: str,
    answered: Callable[..., str],
    give: Callable[..., httpx.Response],
) -> None:
    problem = give(answered(), "timer", points)
    assert (problem.status_code, problem.json()["code"], problem.json()["field"]) == (422, code, field)


@pytest.mark.parametrize(
    "number",
    ["NaN", "Infinity", "-Infinity", "1e999", '"10"', '"1_0"', '" 10"', '"1e1"', '"١٠"', "true"],
)
def test_what_is_no_number_is_refused(
    number: str, client: httpx.Client, school: Any, answered: Callable[..., str]
) -> None:
    headers = school.as_("ta") | {"Content-Type": "application/json"}
    body = f'{{"points": {number}}}'
    problem = client.put(answered() + "/judgements/timer", content=body.encode(), headers=headers)
    assert (problem.status_code, problem.json()["field"]) == (422, "points")


@pytest.mark.parametrize("comment", ["x" * 2001, "a\x00b", "\x1b[31m"])
def test_comments_are_bounded(
    comment: str, answered: Callable[..., str], give: Callable[..., httpx.Response]
) -> None:
    problem = give(answered(), "timer", 1, comment=comment)
    assert (problem.status_code, problem.json()["field"]) == (422, "comment")


def test_only_what_waits_for_a_person_is_judged(
    answered: Callable[..., str], give: Callable[..., httpx.Response]
) -> None:
    url = answered()
    assert give(url, "written", 1).json()["code"] == "forbidden"  # the machine judged it
    for item in ("nothing", "a/b"):
        problem = give(url, item, 1)
        assert (problem.status_code, problem.json()["code"]) == (404, "item_not_found")
        assert problem.json()["allowed"] == ["publisher", "timer"]
    short = answered("han", b"too short\n")
    assert give(short, "nothing", 1).json()["allowed"] == []


def test_nobody_overwrites_what_they_have_not_seen(
    client: httpx.Client,
    school: Any,
    services: Services,
    answered: Callable[..., str],
    give: Callable[..., httpx.Response],
) -> None:
    url = answered()
    fresh = client.get(url + "/judgements/timer", headers=school.as_("ta")).headers["ETag"]
    first = give(url, "timer", 30, "ta", seen=fresh)
    assert first.headers["ETag"] == first.json()["etag"] != fresh
    for seen in (None, fresh, '"7.beef"'):
        late = give(url, "timer", 10, "wang", seen=seen)
        assert (late.status_code, late.json()["code"]) == (412, "judged_meanwhile")
    assert give(url, "timer", 40, "wang", seen=first.headers["ETag"], comment="more").status_code == 200
    items = client.get(url + "/judgements", headers=school.as_("ta")).json()["items"]
    history = [(one["revision"], one["points"], one["by"]) for one in items[2]["history"]]
    assert history == [(1, 30.0, "ta"), (2, 40.0, "wang")]
    assert items[2]["judgement"]["source_sha256"] == hashlib.sha256(ANSWER).hexdigest()
    assert [(one["waits"], one["machine"]) for one in items] == [(False, 10.0), (True, None), (False, None)]
    entries = client.get("/api/v1/audit", headers=school.as_("wang")).json()["entries"]
    second, one = [entry for entry in entries if entry["action"] == "grade.judge"]
    assert (one["actor"], one["before"]) == ("ta", None)
    assert second["before"] == {"points": 30.0, "comment": "", "score": None}
    assert second["after"] == {"points": 40.0, "comment": "more", "score": None}
    assert second["subject"] == f"submission {url.rpartition('/')[2]}, item timer"


def test_what_waits_is_listed_question_by_question(
    client: httpx.Client, school: Any, answered: Callable[..., str], give: Callable[..., httpx.Response]
) -> None:
    earlier, newest, other = answered(), answered(answer=ANSWER * 2), answered("han")
    answered("han", b"too short\n")  # judged by the machine alone: the one before still waits

    def waiting(**params: object) -> dict[str, Any]:
        response = client.get(WAITING, params=params, headers=school.as_("ta"))  # type: ignore[arg-type]
        document: dict[str, Any] = response.json()
        return document

    document = waiting()
    assert [(one["item"], one["submission"]) for one in document["waiting"]] == [
        ("publisher", newest),
        ("publisher", other),
        ("timer", newest),
        ("timer", other),
    ]
    assert [(one["item"], one["waiting"]) for one in document["questions"]] == [
        ("publisher", 2),
        ("timer", 2),
    ]
    assert document["waiting"][0]["student"] == "li"
    assert waiting(every=True)["total"] == 6
    assert waiting(assignment="square")["code"] == "unknown_assignment"
    page = waiting(item="timer", offset=1, limit=1, anonymous=True)
    assert [(one["submission"], one["student"]) for one in page["waiting"]] == [(other, None)]
    assert page["total"] == 2

    first = document["waiting"][0]
    assert client.get(first["source"], headers=school.as_("ta")).content == ANSWER * 2
    put = client.put(first["judgement"], json={"points": 1}, headers=school.as_("ta"))
    assert put.status_code == 200
    assert waiting()["total"] == 3
    assert give(newest, "timer", 1).status_code == 200
    dashboard = client.get("/api/v1/dashboard", headers=school.as_("ta")).json()
    assert dashboard["waiting_for_person"] == 1
    assert dashboard["assignments"][0]["waiting_for_person"] == 1
    cells = {one["student"]: one["assignments"]["essay"] for one in dashboard["students"]}
    assert (cells["han"]["waits_for_person"], cells["li"]["waits_for_person"]) == (True, False)
    assert earlier not in str(waiting())


def test_students_see_points_not_who_gave_them(
    client: httpx.Client, school: Any, answered: Callable[..., str], give: Callable[..., httpx.Response]
) -> None:
    url = answered()
    give(url, "timer", 5, "wang")
    assert "wang" not in client.get(url, headers=school.as_("li")).text
    assert client.get(url + "/judgements", headers=school.as_("li")).status_code == 403


def test_hidden_items_hide_their_points(
    client: httpx.Client,
    school: Any,
    services: Services,
    answered: Callable[..., str],
    give: Callable[..., httpx.Response],
) -> None:
    url = answered()
    rules = Rules(hidden_items=("timer",))
    services.rules.set("essay", rules, Signature(START, "ros", "wang"))
    hidden = client.get(url, headers=school.as_("li")).json()
    assert (hidden["verdict"], hidden["score"], hidden["to_judge"]) == ("needs_manual", None, 1)
    give(url, "publisher", 40, comment="good")
    give(url, "timer", 5, comment="secret")
    shown = client.get(url, headers=school.as_("li")).json()
    assert (shown["verdict"], shown["score"], shown["max_score"]) == ("graded", 50.0, 55.0)
    assert [one["message"] for one in shown["rubric"]][1] == "good"
    for path in ("", "/report", "/gradescope.json", "/prairielearn.json"):
        assert "secret" not in client.get(url + path, headers=school.as_("li")).text
    assert client.get(url, headers=school.as_("ta")).json()["score"] == 55.0
