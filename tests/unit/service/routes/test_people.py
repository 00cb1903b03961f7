"""The people of a course over HTTP."""

from typing import Any

import httpx
import pytest

from grader.use_cases.services import Services
from tests.fakes.clock import FakeClock


@pytest.fixture
def headers(school: Any) -> dict[str, str]:
    headers: dict[str, str] = school.as_("wang")
    return headers


def send_list(client: httpx.Client, headers: dict[str, str], content: str, **query: bool) -> httpx.Response:
    files = {"file": ("class.csv", content.encode())}
    return client.post("/api/v1/members/import", headers=headers, params=query, files=files)


def test_a_dry_run_tells_and_changes_nothing(
    client: httpx.Client, headers: dict[str, str], services: Services
) -> None:
    before = services.courses.members("ros")
    seen = send_list(client, headers, "id,name,section\nli,李,A\nnew,x,\n,y,\n", dry_run=True).json()
    assert [one["id"] for one in seen["added"]] == ["new"]
    assert [(one["before"]["sections"], one["after"]["sections"]) for one in seen["changed"]] == [([], ["A"])]
    assert seen["dry_run"] is True
    assert [one["row"] for one in seen["skipped"]] == [4]
    assert "han" in [one["id"] for one in seen["gone"]]
    assert services.courses.members("ros") == before


def test_a_dry_run_refuses_what_an_import_would(client: httpx.Client, headers: dict[str, str]) -> None:
    refused = send_list(client, headers, "id,name,role\nwang,王,student\n", dry_run=True)
    assert (refused.status_code, refused.json()["code"]) == (422, "invalid_roster")


def test_canvas_own_rows_are_passed_over(client: httpx.Client, headers: dict[str, str]) -> None:
    rows = 'Student,ID,SIS User ID\n"Points Possible",,\n"Li, A",7,20260101\n"Student, Test",8,\n'
    seen = send_list(client, headers, rows, dry_run=True).json()
    assert [one["id"] for one in seen["added"]] == ["20260101"]
    assert seen["skipped"] == []


def test_wrong_rows_are_skipped_only_if_asked(
    client: httpx.Client, headers: dict[str, str], services: Services
) -> None:
    content = "id,name\nnew,x\na b,y\n"
    refused = send_list(client, headers, content)
    assert (refused.status_code, refused.json()["code"]) == (422, "invalid_roster")
    assert "line 3" in refused.json()["detail"] or "第 3 行" in refused.json()["detail"]
    assert services.courses.member("ros", "new") is None
    assert send_list(client, headers, content, skip=True).status_code == 200
    assert services.courses.member("ros", "new") is not None


def test_the_course_of_another_release_tells_it_to_students(
    client: httpx.Client, headers: dict[str, str], school: Any
) -> None:
    def told() -> tuple[str, str]:
        one = client.get("/api/v1/assignments/square", headers=school.as_("li")).json()
        return one["distro"], client.get("/api/v1/me", headers=headers).json()["course"]["distro"]

    assert told() == ("humble", "humble")
    assert client.put("/api/v1/course", headers=headers, json={"distro": "jazzy"}).json()["distro"] == "jazzy"
    assert told() == ("jazzy", "jazzy")
    started = client.put("/api/v1/course", headers=headers, json={"runs_as": "ros2_run"}).json()
    assert (started["distro"], started["runs_as"]) == ("jazzy", "ros2_run")
    one = client.get("/api/v1/assignments/square", headers=school.as_("li")).json()
    assert one["runs_as"] == "ros2_run"
    refused = client.put("/api/v1/course", headers=headers, json={"distro": "kilted"})
    assert (refused.status_code, refused.json()["code"]) == (422, "invalid_request")


def test_who_is_not_in_the_list_is_removed_if_asked(
    client: httpx.Client, headers: dict[str, str], services: Services
) -> None:
    assert send_list(client, headers, "id,name\nli,\n", remove=True).status_code == 200
    assert [one.id for one in services.courses.members("ros")] == ["li", "ta", "wang"]


def test_codes_cannot_be_guessed(client: httpx.Client, headers: dict[str, str], clock: FakeClock) -> None:
    def status(code: str) -> int:
        return client.get("/api/v1/me", headers={"Authorization": f"Bearer {code}"}).status_code

    own = headers["Authorization"].removeprefix("Bearer ")
    for _ in range(100):  # right ones do not count
        assert status(own) == 200
    assert [status("22222-22222") for _ in range(61)] == [401] * 60 + [429]
    assert status(own) == 429
    assert status("grader_" + "x" * 43) == 401
    clock.advance(60)
    assert status(own) == 200


def test_one_member_is_put_changed_and_deleted(client: httpx.Client, headers: dict[str, str]) -> None:
    url = "/api/v1/members/zhao"
    made = client.put(url, headers=headers, json={"name": "赵", "role": "assistant", "sections": ["B", "A"]})
    assert made.json()["sections"] == ["A", "B"]
    kept = client.put(url, headers=headers, json={"email": "z@a.cn"}).json()
    assert kept == {
        "id": "zhao",
        "name": "赵",
        "role": "assistant",
        "email": "z@a.cn",
        "sections": ["A", "B"],
    }
    for field, wrong in {"email": "nowhere", "name": "a\nb", "sections": [""]}.items():
        refused = client.put(url, headers=headers, json={field: wrong}).json()
        assert (refused["code"], refused["field"]) == ("invalid_roster", field)
    assert client.post(f"{url}/tokens", headers=headers).status_code == 201  # nothing must be said
    token = client.post(f"{url}/tokens", headers=headers, json={"days": 1}).json()["token"]
    theirs = {"Authorization": f"Bearer {token}"}
    assert client.get("/api/v1/me", headers=theirs).json()["person"] == "zhao"
    assert client.delete(url, headers=headers, params={"reason": "left"}).status_code == 204
    assert client.get("/api/v1/me", headers=theirs).status_code == 401
    assert client.delete(url, headers=headers).json()["code"] == "member_not_found"
    last = client.delete("/api/v1/members/wang", headers=headers)
    assert (last.status_code, last.json()["code"], last.json()["field"]) == (422, "invalid_roster", "role")
