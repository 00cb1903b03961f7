"""Assignments, dashboard, health and the interface's description of itself."""

import json
from collections.abc import Callable, Iterator
from datetime import timedelta
from typing import Any

import httpx
import pytest

from grader.contracts.identity import RosterEntry
from grader.contracts.rules import Extension, Rules
from grader.contracts.submission import WorkerState
from grader.render.dashboard import render_dashboard
from grader.render.terminal import console
from grader.service.routes.problems import PROBLEM_TYPES
from grader.store.audit import Signature
from grader.use_cases.services import Services
from tests.fakes.clock import START, FakeClock
from tests.fakes.refusals import problem
from tests.fakes.server import TOKEN

INSTRUCTOR = {"Authorization": f"Bearer {TOKEN}"}


def worker(clock: FakeClock, *, ready: bool = True, slots: int = 2) -> WorkerState:
    return WorkerState(
        id="host:1",
        slots=slots,
        busy=0,
        sandbox_ready=ready,
        isolation="strict",
        detail="" if ready else "no seccomp",
        started_at=START,
        seen_at=clock(),
    )


def test_the_checklist(client: httpx.Client) -> None:
    document = client.get("/api/v1/assignments", params={"lang": "en"}).json()
    assert [(one["id"], one["title"], one["max_score"]) for one in document["assignments"]] == [
        ("straight", "Exercise straight", 10.0),
        ("square", "Exercise square", 10.0),
    ]
    assert client.get(document["assignments"][0]["url"]).status_code == 200


def test_a_published_rubric(client: httpx.Client) -> None:
    document = client.get("/api/v1/assignments/square").json()
    assert document["title"] == "作业 square"
    assert document["rubric"][1] == {
        "id": "closed",
        "title": "回到起点",
        "points": 5.0,
        "measure": "gap_pct",
        "low": None,
        "high": 4.0,
        "ramp": 12.0,
        "needs": ["sides"],
        "looks_at": "终点到起点的距离（占周长的百分比）",
        "wanted": "不超过 4 %",
        "partial": "偏差越大得分越少，达到 16 % 时为 0 分。",
    }
    assert document["cmd_vel_topic"] == "/turtle1/cmd_vel"


def test_an_empty_dashboard(client: httpx.Client) -> None:
    document = client.get("/api/v1/dashboard", headers=INSTRUCTOR).json()
    assert document["students"] == []
    assert [one["pass_rate"] for one in document["assignments"]] == [None, None]


def test_the_dashboard(
    client: httpx.Client, graded: Callable[..., str], upload: Callable[..., httpx.Response], clock: FakeClock
) -> None:
    best = graded(b"good good", student="ann")
    clock.advance(60)
    latest = graded(b"raise good", student="ann")
    graded(b"x", student="bob")
    graded(b"good good", student="bob", assignment="straight")
    waiting = upload(b"x", student="cyd").headers["Location"]
    document = client.get("/api/v1/dashboard", headers=INSTRUCTOR, params={"lang": "en"}).json()
    ann, bob, cyd = document["students"]
    assert ann["assignments"]["square"] == {
        "best_score": 10.0,
        "max_score": 10.0,
        "passed": True,
        "waits_for_person": False,
        "status": "graded",
        "verdict": "crashed",
        "attempts": 2,
        "last_activity_at": "2026-03-02T08:01:00Z",
        "best_submission": best,
        "counted_score": 10.0,
        "counted_submission": best,
        "latest_submission": latest,
    }
    assert bob["total_score"] == 10.0
    assert cyd["assignments"]["square"]["latest_submission"] == waiting
    assert cyd["assignments"]["square"]["best_score"] is None
    straight, square = document["assignments"]
    assert (square["students"], square["submissions"], square["passed"]) == (3, 4, 1)
    assert square["pass_rate"] == 0.5  # cyd, who still waits for a score, has not failed
    assert square["mean_score"] == 5.0
    assert [one["students"] for one in square["score_distribution"]] == [1, 0, 0, 0, 0, 0, 0, 0, 0, 1]
    assert square["most_failed_items"] == [
        {"id": "closed", "title": "Back at the start", "count": 2, "still": 1},
        {"id": "sides", "title": "Sides", "count": 1, "still": 1},
    ]
    assert square["most_common_mistakes"][0]["students"] == 2
    assert straight["pass_rate"] == 1.0
    assert document["queue"] == {"queued": 1, "running": 0, "infrastructure_error": 0}
    assert document["oldest_queued_at"] == "2026-03-02T08:01:00Z"


def test_pages_and_filters_choose_students(client: httpx.Client, graded: Callable[..., str]) -> None:
    for student in ("a1", "a2", "b1"):
        graded(b"good good", student=student)

    def asked(**params: object) -> tuple[list[str], int]:
        document = client.get("/api/v1/dashboard", headers=INSTRUCTOR, params=params).json()
        assert document["assignments"][1]["students"] == 3
        return [one["student"] for one in document["students"]], document["total_students"]

    assert asked() == (["a1", "a2", "b1"], 3)
    assert asked(search="a") == (["a1", "a2"], 2)
    assert asked(limit=1, offset=1) == (["a2"], 3)
    assert asked(offset=9) == ([], 3)
    assert asked(at_risk=True) == ([], 0)


def test_who_may_need_help(client: httpx.Client, graded: Callable[..., str], school: Any) -> None:
    for number in range(3):
        graded(f"x = {number}".encode(), student="", headers=school.as_("li"))
    document = client.get("/api/v1/dashboard", headers=school.as_("ta")).json()
    assert document["at_risk"] == [
        {
            "student": "li",
            "name": "li",
            "reason": "stuck",
            "assignment": "square",
            "attempts": 3,
            "due": None,
        },
        {
            "student": "han",
            "name": "han",
            "reason": "not_started",
            "assignment": None,
            "attempts": 0,
            "due": None,
        },
    ]


def test_refusals_crashes_and_due_dates_are_risks(
    client: httpx.Client, graded: Callable[..., str], school: Any, services: Services
) -> None:
    def risky() -> list[tuple[str, str, str | None, int]]:
        answer = client.get("/api/v1/dashboard", headers=school.as_("ta"))
        return [
            (one["student"], one["reason"], one["assignment"], one["attempts"])
            for one in answer.json()["at_risk"]
        ]

    tag = client.get("/api/v1/dashboard", headers=school.as_("ta")).headers["ETag"]
    unchanged = {**school.as_("ta"), "If-None-Match": tag}
    assert client.get("/api/v1/dashboard", headers=unchanged).status_code == 304
    for _ in range(2):
        files = {"file": ("a.py", b"")}
        assert (
            client.post(
                "/api/v1/submissions", data={"assignment": "square"}, files=files, headers=school.as_("han")
            ).status_code
            == 422
        )
    assert client.get("/api/v1/dashboard", headers=unchanged).status_code == 200
    assert risky() == [("han", "refused", "square", 2), ("li", "not_started", None, 0)]
    due = services.clock() + timedelta(days=2)
    signed = Signature(services.clock(), "ros", "wang")
    services.rules.set("straight", Rules(due=due), signed)
    assert risky() == [("han", "refused", "square", 2), ("li", "due_soon", "straight", 0)]
    graded(b"good", student="", headers=school.as_("han"))
    assert risky() == [("han", "due_soon", "straight", 0), ("li", "due_soon", "straight", 0)]
    services.rules.extend("straight", "han", Extension(due=due + timedelta(days=30)), signed)
    assert risky() == [("li", "due_soon", "straight", 0)]
    tag = client.get("/api/v1/dashboard", headers=school.as_("ta")).headers["ETag"]
    services.rules.set("straight", Rules(due=services.clock() - timedelta(hours=1)), signed)
    assert risky() == [("li", "overdue", "straight", 0)]


def test_every_list_of_the_dashboard_is_paged(client: httpx.Client, graded: Callable[..., str]) -> None:
    for student in ("a", "b", "c"):
        graded(b"x = 1", student=student)
    page = client.get("/api/v1/dashboard", headers=INSTRUCTOR, params={"limit": 2}).json()
    assert (len(page["students"]), page["next_offset"]) == (2, 2)
    page = client.get("/api/v1/dashboard", headers=INSTRUCTOR, params={"limit": 2, "offset": 2}).json()
    assert (len(page["students"]), page["next_offset"]) == (1, None)
    for path in ("/api/v1/dashboard/costs", "/api/v1/assignments/square/students"):
        some = client.get(path, headers=INSTRUCTOR, params={"limit": 1, "offset": 1}).json()["students"]
        assert len(some) == 1, path


def test_students_are_found_by_name_and_section(
    client: httpx.Client, graded: Callable[..., str], school: Any, services: Services
) -> None:
    li = RosterEntry(id="li", name="李雷", sections=("A",))
    services.courses.import_roster("ros", [li], "test")
    for person in ("li", "han"):
        graded(b"good", student="", headers=school.as_(person))

    def asked(**params: object) -> list[str]:
        document = client.get("/api/v1/dashboard", headers=school.as_("ta"), params=params).json()
        return [one["student"] for one in document["students"]]

    assert asked(search="李") == asked(section="A") == ["li"]


@pytest.mark.parametrize(
    ("path", "field"),
    [
        ("/api/v1/dashboard", "section"),
        ("/api/v1/gradebook.csv", "section"),
        ("/api/v1/gradebook.xlsx", "section"),
        ("/api/v1/appeals", "section"),
        ("/api/v1/assignments/square/students", "item"),
        ("/api/v1/submissions", "assignment"),
        ("/api/v1/appeals", "assignment"),
        ("/api/v1/judgements/waiting", "assignment"),
        ("/api/v1/assignments/square/students", "status"),
    ],
)
def test_what_is_not_there_is_named(
    client: httpx.Client, school: Any, services: Services, path: str, field: str
) -> None:
    """An empty answer would look like a class in which nobody did anything."""
    services.courses.import_roster("ros", [RosterEntry(id="li", name="", sections=("A",))], "test")
    known = {"section": "A", "item": "closed", "assignment": "square", "status": "queued"}[field]
    assert client.get(path, headers=school.as_("ta"), params={field: known}).status_code == 200
    refused = client.get(path, headers={**school.as_("ta"), "Accept-Language": "en"}, params={field: "x"})
    assert (refused.status_code, refused.json()["field"]) == (422, field)
    assert known in refused.json()["allowed"]


def test_nobody_and_no_mistake_of_a_name_are_refused(client: httpx.Client, school: Any) -> None:
    def asked(address: str, who: str = "ta") -> tuple[int, str | None]:
        answer = client.get(address, headers=school.as_(who))
        return answer.status_code, answer.json().get("field")

    assert asked("/api/v1/submissions?student=li") == (200, None)
    assert asked("/api/v1/submissions?student=lii") == (422, "student")
    # they get their own, whatever they ask
    assert asked("/api/v1/submissions?student=han", who="li") == (200, None)
    assert asked("/api/v1/assignments/square/students?mistake=no_publisher") == (200, None)
    assert asked("/api/v1/assignments/square/students?mistake=no_publihs") == (422, "mistake")


@pytest.mark.parametrize(
    "address", ["/api/v1/submissions?assigment=square", "/api/v1/me?lang=zh&assigment=square"]
)
def test_a_misspelt_parameter_is_refused(client: httpx.Client, school: Any, address: str) -> None:
    """Left out, a misspelt filter would show everything."""
    document = problem(client.get(address, headers=school.as_("ta")), 422, "invalid_request")
    assert document["errors"] == [{"field": "query.assigment", "detail": "没有这个字段。"}]


def test_a_parameter_given_twice_is_refused(client: httpx.Client, school: Any) -> None:
    """Only the last would be read."""
    answer = client.get("/api/v1/submissions?student=li&student=han", headers=school.as_("ta"))
    assert problem(answer, 422, "invalid_request")["errors"] == [
        {"field": "query.student", "detail": "这个字段只能有一个。"}
    ]


def test_attempts_to_pass(client: httpx.Client, graded: Callable[..., str], clock: FakeClock) -> None:
    for student, tries in (
        ("a", (b"x", b"good", b"good good", b"y")),
        ("b", (b"good good",)),
        ("c", (b"x",)),
    ):
        for source in tries:
            graded(source, student=student)
            clock.advance(1)
    _, square = client.get("/api/v1/dashboard", headers=INSTRUCTOR).json()["assignments"]
    assert square["mean_attempts_to_pass"] == 2.0


def test_an_unchanged_class_is_not_sent_again(
    client: httpx.Client,
    graded: Callable[..., str],
    upload: Callable[..., httpx.Response],
    services: Services,
    clock: FakeClock,
) -> None:
    def ask(tag: str, **params: object) -> httpx.Response:
        return client.get("/api/v1/dashboard", headers={**INSTRUCTOR, "If-None-Match": tag}, params=params)

    def changed(tag: str) -> str:
        response = ask(tag)
        assert response.status_code == 200
        return response.headers["ETag"]

    graded(b"good", student="a")
    tag = changed('"none"')
    clock.advance(60)
    same = ask(f'"other", {tag}')
    assert (same.status_code, same.content, same.headers["ETag"]) == (304, b"", tag)
    assert ask(tag, search="a").status_code == 200
    upload(student="a")
    tag = changed(tag)
    claim = services.queue.claim("w")
    tag = changed(tag)
    services.queue.hand_back(claim)
    tag = changed(tag)
    services.workers.report(worker(clock))
    tag = changed(tag)
    clock.advance(1)
    services.workers.report(worker(clock))
    assert ask(tag).status_code == 304


def test_the_terminal_can_show_the_dashboard(client: httpx.Client, graded: Callable[..., str]) -> None:
    graded(b"good", student="ann")
    document = client.get("/api/v1/dashboard", headers=INSTRUCTOR).json()
    output = console()
    with output.capture() as captured:
        output.print(render_dashboard(document, language="en"))
    assert "ann" in captured.get()


def test_without_a_worker_the_service_is_degraded(client: httpx.Client) -> None:
    response = client.get("/healthz")
    assert response.status_code == 503
    assert response.json()["status"] == "degraded"
    assert response.json()["sandbox"] == {"ready": False, "isolation": "", "detail": "no worker is alive"}
    assert response.json()["broken_assignments"] == []


def test_with_a_worker_it_is_well(client: httpx.Client, services: Services, clock: FakeClock) -> None:
    services.workers.report(worker(clock))
    response = client.get("/healthz")
    assert (response.status_code, response.json()["status"]) == (200, "ok")
    assert response.json()["sandbox"]["isolation"] == "strict"
    clock.advance(60)
    assert client.get("/healthz").status_code == 503


def test_a_full_disk_is_said_to_be_one(
    client: httpx.Client, services: Services, clock: FakeClock, monkeypatch: pytest.MonkeyPatch
) -> None:
    services.workers.report(worker(clock))
    monkeypatch.setattr(type(services.queue), "free_bytes", lambda _: 3_000_000)
    answer = client.get("/healthz")
    assert (answer.status_code, answer.json()["status"]) == (503, "degraded")
    assert answer.json()["detail"] == "the disk of the database is full: 3 MB are left; uploads are refused"


@pytest.mark.parametrize("state", [{"ready": False}, {"slots": 0}])
def test_a_worker_that_cannot_grade_does_not_count(
    client: httpx.Client, services: Services, clock: FakeClock, state: dict[str, Any]
) -> None:
    services.workers.report(worker(clock, **state))
    assert client.get("/healthz").status_code == 503


@pytest.fixture
def openapi(client: httpx.Client) -> dict[str, Any]:
    document: dict[str, Any] = client.get("/openapi.json").json()
    return document


def operations(openapi: dict[str, Any]) -> Iterator[tuple[str, dict[str, Any]]]:
    for path, methods in openapi["paths"].items():
        for method, operation in methods.items():
            yield f"{method} {path}", operation


def references(node: object) -> Iterator[str]:
    if isinstance(node, dict):
        if isinstance(node.get("$ref"), str):
            yield node["$ref"]
        for value in node.values():
            yield from references(value)
    elif isinstance(node, list):
        for value in node:
            yield from references(value)


def test_openapi_has_no_loose_ends(openapi: dict[str, Any]) -> None:
    for reference in references(openapi):
        node: Any = openapi
        for part in reference.removeprefix("#/").split("/"):
            node = node[part]


def test_openapi_documents_failures_as_problem_documents(openapi: dict[str, Any]) -> None:
    assert "HTTPValidationError" not in json.dumps(openapi)
    for name, operation in operations(openapi):
        for status, response in operation["responses"].items():
            if status == "503" and name == "get /healthz":
                continue
            if int(status) >= 400:
                assert list(response["content"]) == ["application/problem+json"], (name, status)
                assert response["content"]["application/problem+json"]["examples"]


def test_openapi_documents_500_everywhere(openapi: dict[str, Any]) -> None:
    assert [name for name, operation in operations(openapi) if "500" not in operation["responses"]] == []


def test_openapi_knows_every_kind_of_problem(openapi: dict[str, Any]) -> None:
    text = json.dumps(openapi)
    general = {  # of no operation, or of pages
        "not_found", "method_not_allowed", "refused", "foreign_form", "not_the_same", "false_receipt",
        "signin_refused", "signin_failed", "signin_expired", "signin_somebody_else", "signin_other_course",
        "signin_unreachable",
        "platform_not_found", "platform_unknown", "platform_differs", "platform_exists", "too_many_platforms",
        "platforms_not_set_up",
        "invalid_platform", "picking_over", "picking_by_instructors", "nothing_picked", "registration_over",
        "not_a_registration", "registration_failed",
    }  # fmt: skip
    assert [code for code in PROBLEM_TYPES if f"/problems/{code}" not in text and code not in general] == []


def test_openapi_explains_every_operation(openapi: dict[str, Any]) -> None:
    for name, operation in operations(openapi):
        assert operation.get("summary"), name
        assert operation.get("description"), name
        assert operation.get("tags"), name


def test_a_number_leads_to_the_students_behind_it(client: httpx.Client, graded: Callable[..., str]) -> None:
    for student, source in (("ada", b"good good"), ("bo", b"good"), ("bo", b"good good ")):
        graded(source, student=student)

    def asked(**concern: str) -> list[tuple[str, bool, int]]:
        answer = client.get("/api/v1/assignments/square/students", params=concern, headers=INSTRUCTOR)
        return [(one["student"], one["still"], one["attempts"]) for one in answer.json()["students"]]

    assert asked() == [("bo", False, 2), ("ada", False, 1)]
    assert asked(item="closed") == [("bo", False, 2)]
    assert asked(mistake="wall_hit") == [("bo", False, 2)]
    assert asked(status="graded", item="sides") == []
    unknown = client.get("/api/v1/assignments/none/students", headers=INSTRUCTOR)
    assert unknown.status_code == 404
