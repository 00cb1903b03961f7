"""Grading again: trial, what would change, apply or discard."""

import sqlite3
from collections.abc import Callable
from contextlib import closing
from dataclasses import replace
from pathlib import Path
from typing import Any

import httpx
import pytest

from grader.contracts.grading import GradingJob
from grader.contracts.rules import Rules
from grader.store.audit import Signature
from grader.use_cases.services import Services
from tests.fakes.clock import START, FakeClock
from tests.fakes.grading import grade
from tests.unit.service.routes.conftest import work

URL = "/api/v1/regrades"
Post = Callable[..., httpx.Response]


def tighten(services: Services) -> None:
    """Put a new first item into the rubric, which takes one ``good`` of the source from ``closed``."""
    square = services.assignments.get("square")
    extra = replace(square.items[0], id="start", title=square.items[0].title)
    changed = replace(square, version=square.version + 1, items=(extra, *square.items))
    services.assignments.assignments = (services.assignments.assignments[0], changed)


@pytest.fixture
def klass(client: httpx.Client, school: Any, graded: Callable[..., str], clock: FakeClock) -> dict[str, str]:
    urls = {}
    for person, source in (("li", b"good good good"), ("han", b"good good")):
        urls[person] = graded(source, student="", headers=school.as_(person))
        clock.advance(10)
    return urls


@pytest.fixture
def post(client: httpx.Client, school: Any) -> Post:
    def send(url: str = URL, **body: object) -> httpx.Response:
        return client.post(url, json=body, headers=school.as_("wang"))

    return send


def test_a_trial_lists_exactly_those_it_changes(
    client: httpx.Client, services: Services, school: Any, klass: dict[str, str], post: Post
) -> None:
    tighten(services)
    response = post(assignment="square")
    url = response.headers["Location"]
    assert (response.status_code, response.json()["waiting"]) == (202, 2)
    assert work(services, grade) == 2
    document = client.get(url, headers=school.as_("ta")).json()
    assert (document["waiting"], document["gain"], document["lose"], document["same"]) == (0, 1, 0, 0)
    han, li = document["changes"]
    assert (han["student"], han["submission"], han["before"], han["after"]) == (
        "han",
        klass["han"],
        10.0,
        10.0,
    )
    assert {one["item"]: (one["before"], one["after"]) for one in han["items"]} == {
        "closed": (5.0, 0.0),
        "start": (None, 5.0),
    }
    assert (li["student"], li["before"], li["after"]) == ("li", 10.0, 15.0)
    page = client.get(url, params={"offset": 1, "limit": 1}, headers=school.as_("ta")).json()
    assert page == document | {"changes": [li]}
    (listed,) = client.get(URL, headers=school.as_("ta")).json()["regrades"]
    assert listed == {name: value for name, value in document.items() if name != "changes"}
    assert listed["changed"] == 2


def test_nothing_changes_until_it_is_applied(
    client: httpx.Client, services: Services, school: Any, klass: dict[str, str], post: Post, tmp_path: Path
) -> None:
    before = {url: client.get(url + "/report", headers=school.as_("ta")).content for url in klass.values()}
    dashboard = client.get("/api/v1/dashboard", headers=school.as_("ta")).json()["students"]
    tighten(services)
    url = post(assignment="square").headers["Location"]
    work(services, grade)
    assert {one: client.get(one + "/report", headers=school.as_("ta")).content for one in before} == before
    assert client.get("/api/v1/dashboard", headers=school.as_("ta")).json()["students"] == dashboard
    assert services.intake.open_count("li", "ros") == 0
    discarded = post(f"{url}/discard", reason="a mistake").json()
    assert (discarded["state"], discarded["gain"]) == ("discarded", 1)
    assert {one: client.get(one + "/report", headers=school.as_("ta")).content for one in before} == before
    with closing(sqlite3.connect(tmp_path / "grader.db")) as rows:
        assert rows.execute("SELECT count(*) FROM submission").fetchone() == (2,)
        assert rows.execute("PRAGMA foreign_key_check").fetchall() == []


def test_applied_it_counts_and_the_old_grading_stays(
    client: httpx.Client, services: Services, school: Any, klass: dict[str, str], post: Post
) -> None:
    tighten(services)
    url = post(assignment="square").headers["Location"]
    assert post(f"{url}/apply", reason=" \n").json()["code"] == "invalid_request"
    assert post(f"{url}/apply", reason="too early").json()["code"] == "regrade_running"
    work(services, grade)
    applied = post(f"{url}/apply", reason="the rubric grew").json()
    assert (applied["state"], applied["decided_by"], applied["reason"]) == (
        "applied",
        "wang",
        "the rubric grew",
    )
    assert post(f"{url}/apply", reason="again").json()["code"] == "regrade_decided"
    li = client.get(klass["li"], headers=school.as_("li")).json()
    assert (li["score"], li["max_score"], li["assignment_version"]) == (15.0, 15.0, 4)
    assert client.get(klass["li"] + "/trajectory", headers=school.as_("li")).status_code == 200
    first, second = client.get(klass["li"] + "/gradings", headers=school.as_("ta")).json()["gradings"]
    assert (first["assignment_version"], first["score"], first["by"]) == (3, 10.0, "")
    assert (second["assignment_version"], second["score"], second["by"]) == (4, 15.0, "wang")
    changes = [
        (one["subject"], one["before"], one["after"], one["reason"])
        for one in client.get("/api/v1/audit", headers=school.as_("wang")).json()["entries"]
        if one["action"] == "grade.change"
    ]
    id_ = klass["li"].rpartition("/")[2]
    assert (f"submission {id_}", {"score": 10.0}, {"score": 15.0}, "the rubric grew") in changes
    students = client.get("/api/v1/dashboard", headers=school.as_("ta")).json()["students"]
    assert {one["student"]: one["total_score"] for one in students} == {"han": 10.0, "li": 15.0}


def test_fresh_submissions_go_first(
    services: Services, school: Any, klass: dict[str, str], post: Post, upload: Post, clock: FakeClock
) -> None:
    post(assignment="square")
    clock.advance(60)
    fresh = upload(student="", headers=school.as_("han")).json()["id"]
    assert services.queue.claim("w").submission_id == fresh


@pytest.mark.parametrize(
    ("which", "students", "count"),
    [("all", [], 3), ("latest", [], 2), ("best", ["li"], 1), ("all", ["li"], 2), ("all", ["han"], 1)],
)
def test_filters(
    school: Any,
    klass: dict[str, str],
    graded: Callable[..., str],
    post: Post,
    which: str,
    students: list[str],
    count: int,
) -> None:
    graded(b"x = 1", student="", headers=school.as_("li"))
    assert post(assignment="square", which=which, students=students).json()["waiting"] == count


def test_unknown_students_are_named(klass: dict[str, str], post: Post) -> None:
    """Left out, they would seem to have been graded again."""
    refused = post(assignment="square", which="all", students=["li", "lii", "ta"]).json()
    assert (refused["code"], refused["field"]) == ("unknown_student", "students")
    assert refused["detail"].endswith("lii, ta")


def test_what_the_service_failed_to_grade(
    client: httpx.Client, services: Services, school: Any, upload: Post, post: Post
) -> None:
    assert post(assignment="square", which="faults").json()["code"] == "nothing_to_regrade"
    url = upload(b"good", student="", headers=school.as_("li")).headers["Location"]
    for _ in range(3):
        services.queue.fail(services.queue.claim("w"), "no")
    regrade = post(assignment="square", which="faults").headers["Location"]
    work(services, grade)
    post(f"{regrade}/apply", reason="the disk was full")
    document = client.get(url, headers=school.as_("li")).json()
    assert (document["status"], document["score"]) == ("graded", 5.0)


@pytest.mark.parametrize("made", [False, True])
def test_a_trial_is_no_submission(
    client: httpx.Client, services: Services, school: Any, klass: dict[str, str], post: Post, made: bool
) -> None:
    post(assignment="square", which="best")
    claim = services.queue.claim("w")
    assert claim is not None
    if made:
        assignment = services.assignments.get("square")
        job = GradingJob(file_name=claim.file_name, source=claim.source, assignment=assignment)
        assert services.queue.finish(claim, grade(job), assignment)
    of_submissions = [
        path.partition("{submission_id}")[2]
        for path, item in client.get("/openapi.json").json()["paths"].items()
        if path.startswith("/api/v1/submissions/{submission_id}") and "get" in item
    ]
    assert {"", "/report", "/source", "/events", "/plot.png", "/gradings"} <= set(of_submissions)
    for rest in of_submissions:
        address = f"/api/v1/submissions/{claim.submission_id}{rest.replace('{item}', 'closed')}"
        answer = client.get(address, headers=school.as_("wang"))
        assert (answer.status_code, answer.json()["code"]) == (404, "submission_not_found"), rest


def test_a_trial_that_cannot_be_made_leaves_its_submission(
    client: httpx.Client, services: Services, school: Any, klass: dict[str, str], post: Post
) -> None:
    url = post(assignment="square", students=["li"]).headers["Location"]
    for _ in range(3):
        services.queue.fail(services.queue.claim("w"), "no")
    assert post(f"{url}/apply", reason="x").json()["failed"] == 1
    assert client.get(klass["li"], headers=school.as_("li")).json()["score"] == 10.0


def test_a_worker_late_with_a_discarded_trial_changes_nothing(
    services: Services, klass: dict[str, str], post: Post
) -> None:
    url = post(assignment="square", students=["li"]).headers["Location"]
    claim = services.queue.claim("w")
    post(f"{url}/discard", reason="x")
    job = GradingJob(file_name="a.py", source=claim.source, assignment=services.assignments.get("square"))
    assert not services.queue.finish(claim, grade(job), job.assignment)


def test_one_at_a_time(klass: dict[str, str], post: Post, client: httpx.Client, school: Any) -> None:
    url = post(assignment="square").headers["Location"]
    assert post(assignment="square").json()["code"] == "regrade_open"
    assert post(assignment="nose").json()["code"] == "assignment_not_found"
    assert client.get(url, headers=school.as_("zhao")).status_code == 404
    assert len(client.get(URL, headers=school.as_("ta")).json()["regrades"]) == 1


def test_a_plot_shows_the_assignment_that_was_graded(
    client: httpx.Client, services: Services, school: Any, upload: Post
) -> None:
    url = upload(b"good", student="", headers=school.as_("li")).headers["Location"]
    work(services, grade)
    stored = services.submissions.report(url.rpartition("/")[2])
    graded_one = services.assignments.get("square").of_course("humble", "python")
    tighten(services)
    assert services.submissions.graded_assignment(stored) == graded_one
    services.assignments.assignments = services.assignments.assignments[:1]
    assert client.get(url + "/plot.png", headers=school.as_("li")).status_code == 200


def test_rules_that_hide_items_hold_for_regrades(
    client: httpx.Client, services: Services, school: Any, klass: dict[str, str], post: Post
) -> None:
    rules = Rules(hidden_items=("closed",))
    services.rules.set("square", rules, Signature(START, "ros", "test"))
    url = post(assignment="square").headers["Location"]
    work(services, grade)
    post(f"{url}/apply", reason="x")
    assert "closed" not in client.get(klass["li"], headers=school.as_("li")).text


def test_a_regrade_is_undone_and_the_student_told(
    client: httpx.Client, services: Services, school: Any, klass: dict[str, str], post: Post
) -> None:
    tighten(services)
    url = post(assignment="square").headers["Location"]
    assert post(url + "/undo", reason="x").json()["code"] == "regrade_not_applied"
    work(services, grade)
    post(url + "/apply", reason="one more item")
    li, changes = school.as_("li"), klass["li"] + "/changes"
    (told,) = client.get(changes, headers=li).json()["changes"]
    assert (told["undone"], told["reason"], told["before"], told["after"]) == (
        False,
        "one more item",
        10.0,
        15.0,
    )
    assert told["items"] == [{"item": "start", "before": None, "after": 5.0}]
    later = post(assignment="square").headers["Location"]
    work(services, grade)
    post(later + "/apply", reason="again")
    assert post(url + "/undo", reason="x").json()["code"] == "regrade_superseded"
    assert post(later + "/undo", reason="x").json()["state"] == "undone"
    undone = post(url + "/undo", reason="it was right before").json()
    assert (undone["state"], undone["undone_by"], undone["undone_reason"]) == (
        "undone",
        "wang",
        "it was right before",
    )
    assert client.get(klass["li"], headers=li).json()["score"] == 10.0
    assert [one["undone"] for one in client.get(changes, headers=li).json()["changes"]] == [True, False]
    signed = Signature(services.clock(), "ros", "wang")
    services.rules.set("square", Rules(hidden_items=("start",)), signed)
    assert client.get(changes, headers=li).json()["changes"] == []  # nothing but the hidden item changed
    gradings = client.get(klass["li"] + "/gradings", headers=school.as_("ta")).json()["gradings"]
    assert [one["stands"] for one in gradings] == [True, False, False]
