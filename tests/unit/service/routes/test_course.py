"""A course from one term to the next."""

import hashlib
import io
import json
import zipfile
from collections.abc import Callable
from datetime import UTC, datetime
from typing import Any

import httpx
import pytest

from grader.contracts.identity import Caller, Role
from grader.contracts.rules import Rules, Shown
from grader.store.audit import Signature
from grader.use_cases.course_export import export
from grader.use_cases.services import Services
from tests.fakes.grading import grade_next
from tests.unit.service.routes.conftest import School

DUE = datetime(2026, 3, 20, 15, 59, 59, tzinfo=UTC)


@pytest.fixture
def ruled(services: Services, school: School) -> Services:
    """Let the course of `school` have rules: a due date for one assignment, another one as a draft."""
    signed = Signature(services.clock(), "ros", "wang")
    services.rules.set("square", Rules(due=DUE, attempts=3), signed)
    services.rules.set("spin", Rules(shown=Shown.DRAFT), signed)
    return services


def test_a_copy_has_the_rules_and_nobody_but_its_teacher(
    client: httpx.Client, upload: Callable[..., httpx.Response], school: School, ruled: Services
) -> None:
    upload(student="", headers=school.as_("li"))
    body = {"id": "ros-2027", "title": "Next", "move_days": 364}
    answer = client.post("/api/v1/courses", json=body, headers=school.as_("wang"))
    assert answer.status_code == 201
    made = answer.json()
    assert (made["course"]["title"], made["person"]) == ("Next", "wang")
    new = {"Authorization": f"Bearer {made['token']}"}
    assert client.get("/api/v1/me", headers=new).json()["role"] == "instructor"
    assert [one["id"] for one in client.get("/api/v1/members", headers=new).json()["members"]] == ["wang"]
    assert client.get("/api/v1/submissions", headers=new).json()["submissions"] == []
    known = ruled.rules.of("ros-2027")
    assert known.of("square") == Rules(due=datetime(2027, 3, 19, 15, 59, 59, tzinfo=UTC), attempts=3)
    assert known.of("spin").shown is Shown.DRAFT
    told = {
        one["action"] for one in client.get("/api/v1/audit", headers=school.as_("wang")).json()["entries"]
    }
    assert "course.copy" in told
    again = client.post("/api/v1/courses", json=body, headers=school.as_("wang"))
    assert (again.status_code, again.json()["code"], again.json()["field"]) == (422, "invalid_course", "id")
    untold = client.post(
        "/api/v1/courses", json={**body, "id": "x", "title": "a\nb"}, headers=school.as_("wang")
    )
    assert (untold.status_code, untold.json()["field"]) == (422, "title")


def archive(client: httpx.Client, school: School, archived: bool) -> httpx.Response:
    return client.put("/api/v1/course/archived", json={"archived": archived}, headers=school.as_("wang"))


CHANGES: list[tuple[str, str, dict[str, Any]]] = [
    ("put", "/api/v1/assignments/square/rules", {"attempts": 1}),
    ("put", "/api/v1/assignments/square/extensions/li", {"extra_attempts": 1}),
    ("put", "/api/v1/members/new", {"name": "x"}),
    ("delete", "/api/v1/members/han", {}),
    ("post", "/api/v1/regrades", {"assignment": "square"}),
    ("post", "{submission}/comments", {"text": "x"}),
]


def test_only_true_and_false_say_whether_a_course_is_archived(client: httpx.Client, school: School) -> None:
    for value in ("yes", "false", 1, None):
        body = {"archived": value}
        refused = client.put("/api/v1/course/archived", json=body, headers=school.as_("wang"))
        assert (refused.status_code, refused.json()["field"]) == (422, "archived"), value


def test_an_archived_course_can_only_be_read(
    client: httpx.Client,
    upload: Callable[..., httpx.Response],
    graded: Callable[..., str],
    school: School,
) -> None:
    submission = graded(student="", headers=school.as_("li"))
    assert archive(client, school, True).json()["archived_at"] is not None
    for person, student in (("li", ""), ("wang", ""), ("wang", "li")):
        refused = upload(student=student, headers=school.as_(person))
        assert (refused.status_code, refused.json()["code"]) == (409, "course_archived")
    for method, path, body in CHANGES:
        kwargs = {"json": body} if body else {}
        url = path.format(submission=submission)
        refused = client.request(method, url, headers=school.as_("wang"), **kwargs)
        assert (refused.status_code, refused.json()["code"]) == (409, "course_archived"), path
    for path in (submission, "/api/v1/gradebook.csv", "/api/v1/dashboard", "/api/v1/audit"):
        assert client.get(path, headers=school.as_("wang")).status_code == 200
    assert client.get("/api/v1/me", headers=school.as_("li")).json()["course"]["archived_at"] is not None
    assert archive(client, school, False).json()["archived_at"] is None
    assert upload(student="", headers=school.as_("li")).status_code == 202


def test_a_course_with_an_open_regrade_is_not_archived(
    client: httpx.Client, graded: Callable[..., str], school: School
) -> None:
    graded(student="", headers=school.as_("li"))
    client.post("/api/v1/regrades", json={"assignment": "square"}, headers=school.as_("wang"))
    assert archive(client, school, True).json()["code"] == "regrade_open"


def test_an_upload_of_somebody_who_was_just_removed_is_not_stored(
    services: Services, school: School, upload: Callable[..., httpx.Response], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Between finding out who asks and storing the file somebody else may remove them."""
    accept = services.intake.accept

    def late(*given: Any) -> Any:
        services.courses.remove("ros", ["li"], "wang")
        return accept(*given)

    monkeypatch.setattr(services.intake, "accept", late)
    refused = upload(student="", headers=school.as_("li"))
    assert (refused.status_code, refused.json()["code"]) == (422, "unknown_student")
    assert services.submissions.of_student("li", course="ros") == ()


def test_a_removed_student_is_in_no_export_and_comes_back_with_the_work(
    client: httpx.Client, graded: Callable[..., str], school: School
) -> None:
    submission = graded(student="", headers=school.as_("li"))
    wang = school.as_("wang")

    def students() -> list[str]:
        rows = client.get("/api/v1/gradebook.csv", headers=wang).text.splitlines()[1:]
        canvas = client.get("/api/v1/gradebook.csv?format=canvas", headers=wang).text
        matrix = client.get("/api/v1/dashboard", headers=wang).json()["students"]
        found = [one.split(",")[0] for one in rows]
        assert [one["student"] for one in matrix] == [one for one in found if one == "li"]  # who has work
        assert (",li," in canvas) == ("li" in found)
        return found

    assert students() == ["han", "li"]
    before = client.get("/api/v1/gradebook.csv", headers=wang).text
    client.delete("/api/v1/members/li", headers=wang)
    assert students() == ["han"]
    listed = client.get("/api/v1/submissions", headers=wang).json()["submissions"]
    assert [one["student"] for one in listed] == []
    assert client.get(submission, headers=wang).status_code == 200  # stored, and staff may look
    client.put("/api/v1/members/li", json={"name": "li"}, headers=wang)
    assert client.get("/api/v1/gradebook.csv", headers=wang).text == before


def test_forgetting_and_erasing_over_http(
    client: httpx.Client, graded: Callable[..., str], school: School
) -> None:
    submission = graded(student="", headers=school.as_("li"))
    wang = school.as_("wang")
    body = {"older_than_days": 1, "dry_run": True}
    assert client.post("/api/v1/course/retention", json=body, headers=wang).json()["submissions"] == 0
    space = client.get("/api/v1/course/space", headers=wang).json()
    assert (space["submissions"], space["sources_bytes"] > 0) == (1, True)
    told = client.post("/api/v1/members/li/forget", json={"reason": "asked for"}, headers=wang).json()
    assert told["submissions"] == 1
    assert client.get(submission, headers=wang).status_code == 404
    assert client.get("/api/v1/me", headers=school.as_("li")).status_code == 401
    assert client.get("/api/v1/course/space", headers=wang).json()["submissions"] == 0
    entry = client.get("/api/v1/audit", headers=wang).json()["entries"][0]
    assert (entry["actor"], entry["subject"]) == ("wang", f"member {told['pseudonym']}")
    again = client.post("/api/v1/members/li/forget", json={}, headers=wang)
    assert (again.status_code, again.json()["code"]) == (404, "member_not_found")
    assert client.post("/api/v1/members/ta/forget", json={}, headers=wang).json()["code"] == "only_students"


def test_everything_of_a_course_comes_as_one_zip_part_by_part(
    client: httpx.Client,
    graded: Callable[..., str],
    upload: Callable[..., httpx.Response],
    school: School,
    services: Services,
) -> None:
    wang = school.as_("wang")
    url = graded(source=b"good # \xe5\xa5\xbd\n", student="", headers=school.as_("li"))
    client.post(f"{url}/comments", json={"text": "why?"}, headers=wang)
    for number in range(30):
        services.clock.advance(10)
        upload(student="", headers=school.as_("wang"), source=b"x = 1\n" * 200 + b"# %d\n" % number)
        while grade_next(services.queue, services.assignments):
            pass
    caller = Caller(course="ros", person="wang", role=Role.INSTRUCTOR)
    parts = [len(one) for one in export(services, caller)]
    content = client.get("/api/v1/course/export.zip", headers=wang).content
    assert len(content) == pytest.approx(sum(parts), rel=0.1)
    assert max(parts[:-2]) < 20_000  # each part is of one file: nobody keeps the whole
    with zipfile.ZipFile(io.BytesIO(content)) as made:
        assert made.testzip() is None
        manifest = json.loads(made.read("manifest.json"))
        assert {one["path"] for one in manifest["files"]} == {*made.namelist()} - {"manifest.json"}
        for one in manifest["files"]:
            assert hashlib.sha256(made.read(one["path"])).hexdigest() == one["sha256"]
        folder = f"submissions/li/square/{url.rpartition('/')[2]}"
        assert made.read(f"{folder}/source.py").decode() == "good # 好\n"
        assert made.read(f"{folder}/report.json") == client.get(f"{url}/report", headers=wang).content
        assert json.loads(made.read(f"{folder}/submission.json"))["comments"][0]["text"] == "why?"
        assert made.read("gradebook.csv").decode() == client.get("/api/v1/gradebook.csv", headers=wang).text
        assert "course.create" in {one["action"] for one in json.loads(made.read("audit.json"))}
    assert (manifest["course"]["id"], manifest["submissions"]) == ("ros", 31)
