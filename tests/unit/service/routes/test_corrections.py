"""What a machine judged wrongly: corrected by instructors, with a reason, and taken back."""

import csv
import io
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import httpx
import pytest

from grader.contracts.assignment import BY_PERSON, Assignment
from grader.contracts.rules import Rules
from grader.store.audit import Signature
from grader.use_cases.services import Services
from tests.fakes.clock import START, FakeClock
from tests.fakes.essays import grade_essay, question
from tests.unit.service.routes.conftest import work

SHORT = b"too short\n"
Give = Callable[..., httpx.Response]


@pytest.fixture
def driven(graded: Callable[..., str], school: Any) -> str:
    """Address of a submission by ``li`` that earns 5 of 10 points: ``closed`` failed."""
    return graded(source=b"good\n", student="", headers=school.as_("li"))


def changed(item: str, **values: Any) -> Assignment:
    """The question with another `item`."""
    new = question(version=2)
    items = tuple(replace(one, **values) if one.id == item else one for one in new.items)
    return replace(new, items=items)


@pytest.fixture
def regrade(client: httpx.Client, school: Any, services: Services) -> Callable[[Assignment], dict[str, Any]]:
    """Grade all essays again by a changed question and apply it; return the trial."""

    def run(new: Assignment) -> dict[str, Any]:
        services.assignments.assignments = (new,)
        wang = school.as_("wang")
        opened = client.post("/api/v1/regrades", json={"assignment": "essay"}, headers=wang).headers[
            "Location"
        ]
        work(services, grade_essay)
        trial: dict[str, Any] = client.get(opened, headers=wang).json()
        assert client.post(opened + "/apply", json={"reason": "x"}, headers=wang).status_code == 200
        return trial

    return run


def test_a_correction_counts_everywhere_and_the_report_stays(
    client: httpx.Client, school: Any, driven: str, give: Give
) -> None:
    li, wang = school.as_("li"), school.as_("wang")
    report = client.get(driven + "/report", headers=li)
    picture = client.get(driven + "/plot.png", headers=li).headers["ETag"]
    assert give(driven, "closed", 2.5, "wang", comment="It did come back.").json()["machine"] == 0.0

    whole = client.get(driven, headers=li, params={"lang": "en"}).json()
    assert (whole["verdict"], whole["score"], whole["to_judge"]) == ("graded", 7.5, None)
    assert (whole["rubric"][1]["status"], whole["rubric"][1]["earned"]) == ("partial", 2.5)
    assert whole["rubric"][1]["message"] == "A teacher changed the points from 0 to 2.5: It did come back."
    assert "wang" not in str(whole)
    again = client.get(driven + "/report", headers=li)
    assert (again.content, again.headers["ETag"]) == (report.content, report.headers["ETag"])
    assert client.get(driven + "/plot.png", headers=li).headers["ETag"] != picture
    gradescope = client.get(driven + "/gradescope.json", headers=li).json()
    assert (gradescope["score"], [one["score"] for one in gradescope["tests"]]) == (7.5, [5.0, 2.5])
    assert f'"{gradescope["extra_data"]["report_sha256"]}"' == report.headers["ETag"]
    (machine,) = client.get(driven + "/gradings", headers=wang).json()["gradings"]
    assert machine["score"] == 5.0
    assert client.get(driven + "/prairielearn.json", headers=li).json()["score"] == 0.75
    book = client.get("/api/v1/gradebook.csv", headers=wang).text.removeprefix("\ufeff")
    assert {row["student"]: row["square (10)"] for row in csv.DictReader(io.StringIO(book))}["li"] == "7.5"
    canvas = client.get("/api/v1/gradebook.csv", params={"format": "canvas"}, headers=wang).text
    assert ",7.5" in canvas
    dashboard = client.get("/api/v1/dashboard", headers=wang).json()
    assert dashboard["waiting_for_person"] == 0
    assert all(one["most_failed_items"] == [] for one in dashboard["assignments"])
    assert dashboard["students"][0]["assignments"]["square"]["counted_score"] == 7.5
    assert client.get("/api/v1/judgements/waiting", headers=wang).json()["total"] == 0
    (entry,) = (
        one
        for one in client.get("/api/v1/audit", headers=wang).json()["entries"]
        if one["action"] == "grade.judge"
    )
    assert (entry["actor"], entry["before"]) == ("wang", {"points": 0.0, "comment": "", "score": 5.0})
    assert entry["after"] == {"points": 2.5, "comment": "It did come back.", "score": 7.5}


def test_a_machines_item_that_a_person_failed_is_failed(
    client: httpx.Client, school: Any, driven: str, give: Give
) -> None:
    assert give(driven, "sides", 0, "wang", comment="copied").status_code == 200
    found = client.get("/api/v1/dashboard", headers=school.as_("ta")).json()["assignments"]
    (square,) = (one for one in found if one["id"] == "square")
    assert {one["id"]: one["still"] for one in square["most_failed_items"]} == {"sides": 1, "closed": 1}


def test_only_instructors_correct_and_they_say_why(driven: str, give: Give) -> None:
    by_assistant = give(driven, "closed", 5, "ta", comment="x")
    assert (by_assistant.status_code, by_assistant.json()["code"]) == (403, "forbidden")
    for comment in ("", " \n"):
        problem = give(driven, "closed", 5, "wang", comment=comment)
        assert (problem.status_code, problem.json()["field"]) == (422, "comment")
    assert give(driven, "closed", 5.5, "wang", comment="x").json()["code"] == "invalid_points"
    assert give(driven, "sides", 5, "wang", comment="unseen").json()["code"] == "points_unchanged"
    assert give(driven, "none", 5, "wang", comment="x").json()["allowed"] == ["sides", "closed"]


def test_the_machines_own_points_take_a_correction_back(
    client: httpx.Client, school: Any, driven: str, give: Give
) -> None:
    before = client.get(driven, headers=school.as_("li")).json()
    first = give(driven, "closed", 5, "wang", comment="fine")
    assert give(driven, "closed", 0, "wang", comment="not fine").json()["code"] == "judged_meanwhile"
    assert client.get(driven, headers=school.as_("li")).json()["score"] == 10.0
    back = give(driven, "closed", 0, "wang", comment="not fine", seen=first.json()["etag"]).json()
    assert (back["judgement"], back["waits"]) == (None, False)
    assert [(one["points"], one["out_of"]) for one in back["history"]] == [(5.0, 5.0), (0.0, 0.0)]
    assert client.get(driven, headers=school.as_("li")).json() == before
    again = give(driven, "closed", 0, "wang", comment="no", seen=back["etag"])
    assert again.json()["code"] == "points_unchanged"
    third = give(driven, "closed", 1, "wang", comment="a little", seen=back["etag"]).json()
    assert (third["judgement"]["revision"], third["judgement"]["points"]) == (3, 1.0)


def test_a_corrected_attempt_may_become_the_best(
    client: httpx.Client,
    school: Any,
    clock: FakeClock,
    driven: str,
    give: Give,
    graded: Callable[..., str],
) -> None:
    clock.advance(10.0)
    graded(source=b"good good\n", student="", headers=school.as_("li"))
    give(driven, "closed", 5, "wang", comment="x")
    cell = client.get("/api/v1/dashboard", headers=school.as_("ta")).json()["students"][0]["assignments"]
    assert cell["square"]["best_score"] == 10.0
    assert cell["square"]["best_submission"].endswith(driven.rpartition("/")[2])


def test_hidden_items_hide_their_corrections(
    client: httpx.Client, school: Any, services: Services, driven: str, give: Give
) -> None:
    rules = Rules(hidden_items=("closed",))
    services.rules.set("square", rules, Signature(START, "ros", "wang"))
    shown = client.get(driven, headers=school.as_("li")).json()
    give(driven, "closed", 5, "wang", comment="secret")
    assert client.get(driven, headers=school.as_("li")).json() == shown
    give(driven, "sides", 3, "wang", comment="for all to see")
    told = client.get(driven, headers=school.as_("li")).json()
    assert (told["score"], told["max_score"], told["verdict"], told["to_judge"]) == (3.0, 5.0, "graded", None)
    for path in ("", "/report", "/gradescope.json", "/prairielearn.json"):
        assert "secret" not in client.get(driven + path, headers=school.as_("li")).text
    assert client.get(driven, headers=school.as_("ta")).json()["score"] == 8.0


def test_an_item_is_corrected_that_was_not_checked(
    client: httpx.Client, school: Any, answered: Callable[..., str], give: Give
) -> None:
    url = answered(answer=SHORT)
    assert give(url, "publisher", 40, "wang", comment="said in class").status_code == 200
    whole = client.get(url, headers=school.as_("li")).json()
    assert (whole["score"], whole["verdict"], whole["to_judge"]) == (40.0, "graded", None)
    assert [one["status"] for one in whole["rubric"]] == ["failed", "partial", "not_checked"]


def test_a_correction_completes_nothing_that_waits(
    client: httpx.Client, school: Any, answered: Callable[..., str], give: Give
) -> None:
    url = answered()
    assert give(url, "written", 5, "wang", comment="x").status_code == 200
    half = client.get(url, headers=school.as_("li")).json()
    assert (half["score"], half["verdict"], half["to_judge"]) == (None, "needs_manual", 2)
    for item in ("publisher", "timer"):
        assert give(url, item, 45).status_code == 200
    assert client.get(url, headers=school.as_("li")).json()["score"] == 95.0


def test_a_regrade_keeps_a_correction_that_fits_and_else_the_machines_points_count(
    client: httpx.Client,
    school: Any,
    answered: Callable[..., str],
    give: Give,
    regrade: Callable[[Assignment], dict[str, Any]],
) -> None:
    url = answered(answer=SHORT)
    give(url, "written", 8, "wang", comment="short, but right")

    same = regrade(question(version=2))
    assert (same["same"], same["kept"], same["changes"]) == (1, 1, [])
    assert client.get(url, headers=school.as_("li")).json()["score"] == 8.0

    (change,) = regrade(changed("written", points=12.0))["changes"]
    assert (change["before"], change["after"]) == (8.0, 0.0)
    assert (change["kept"], change["void"]) == ([], ["written"])
    whole = client.get(url, headers=school.as_("li")).json()
    assert (whole["score"], whole["verdict"], whole["to_judge"]) == (0.0, "graded", None)
    assert client.get("/api/v1/judgements/waiting", headers=school.as_("ta")).json()["total"] == 0


def test_a_regrade_changes_what_was_taken_back(
    client: httpx.Client,
    school: Any,
    answered: Callable[..., str],
    give: Give,
    regrade: Callable[[Assignment], dict[str, Any]],
) -> None:
    url = answered(answer=SHORT)
    seen = give(url, "written", 8, "wang", comment="right").json()["etag"]
    assert give(url, "written", 0, "wang", comment="wrong", seen=seen).status_code == 200
    (change,) = regrade(changed("written", low=5))["changes"]
    assert (change["items"][0]["after"], change["kept"], change["void"]) == (10.0, [], [])
    regrade(changed("written", measure=BY_PERSON, low=None))  # what was taken back judges nothing
    assert client.get(url, headers=school.as_("li")).json()["rubric"][0]["status"] == "needs_manual"
    waiting = client.get("/api/v1/judgements/waiting", headers=school.as_("ta")).json()["waiting"]
    assert "written" in [one["item"] for one in waiting]


def test_several_items_at_once_or_none(client: httpx.Client, school: Any, driven: str) -> None:
    url, wang = driven + "/judgements", school.as_("wang")
    tags = {one["item"]: one["etag"] for one in client.get(url, headers=wang).json()["items"]}

    def put(comment: str = "seen", **points: float) -> httpx.Response:
        items = [{"item": item, "points": given, "etag": tags[item]} for item, given in points.items()]
        return client.put(url, json={"items": items, "comment": comment}, headers=wang)

    assert put(sides=1.0, closed=9.0).json()["code"] == "invalid_points"
    assert put("", sides=1.0, closed=4.0).status_code == 422
    assert client.put(url, json={"items": [], "comment": "x"}, headers=wang).status_code == 422
    assert client.get(driven, headers=wang).json()["score"] == 5.0
    assert put(sides=1.0, closed=4.0).json()["score"] == 5.0
    assert put(sides=1.0, closed=4.0).json()["code"] == "judged_meanwhile"
    allowed = client.put(url, json={"items": [{"item": "sides", "points": 2.0}]}, headers=school.as_("ta"))
    assert allowed.status_code == 403
