"""Every endpoint of the OpenAPI document as every role: a new endpoint without a line here fails."""

from collections.abc import Callable
from contextlib import AbstractContextManager
from datetime import timedelta
from typing import Any

import httpx
import pytest

from grader.contracts.identity import ANYBODY, Role, RosterEntry
from grader.contracts.notice import Vendor
from grader.contracts.platform import NewPlatform
from grader.outside.notices.bots import example_address
from grader.use_cases.services import Services
from tests.fakes.clock import FakeClock
from tests.fakes.places import all_taken
from tests.fakes.server import TOKEN, operations

OPERATIONS = {f"{method} {path}" for path, method in operations()}

# in a course; `classmate` is another student of it, `outsider` and `stranger` are of another course
ROLES = (
    "nobody", "wrong", "owner", "classmate", "assistant", "instructor", "outsider", "stranger",
)  # fmt: skip
PEOPLE = {
    "owner": "li",
    "classmate": "han",
    "assistant": "ta",
    "instructor": "wang",
    "outsider": "li2",
    "stranger": "zhao",
}
# the codes of `ROLES` in courses; and without courses those of anybody, of a wrong token and of the operator
Codes = tuple[tuple[int, ...], tuple[int, int, int]]
OPEN_TO_ALL = (200, 401, 200)
OPERATOR_ONLY = (401, 401, 200)
NEEDS_COURSE = (401, 401, 409)
UNKNOWN = (401, 401, 404)
NOBODYS = (409, 401, 409)
EVERYBODY: Codes = (200,) * 8, (200,) * 3
MEMBERS: Codes = (401, 401, 200, 200, 200, 200, 200, 200), OPEN_TO_ALL
SUBMISSION: Codes = (401, 401, 200, 404, 200, 200, 404, 404), OPEN_TO_ALL
STAFF: Codes = (401, 401, 403, 403, 200, 200, 403, 200), OPERATOR_ONLY
INSTRUCTORS: Codes = (401, 401, 403, 403, 403, 200, 403, 200), NEEDS_COURSE
LOOKS: dict[str, Codes] = {
    "get /api/v1/submissions": (MEMBERS[0], OPERATOR_ONLY),  # students their own
    "get /api/v1/submissions/{submission_id}": SUBMISSION,
    "get /api/v1/submissions/{submission_id}/report": SUBMISSION,
    "get /api/v1/submissions/{submission_id}/events": SUBMISSION,
    "get /api/v1/submissions/{submission_id}/trajectory": SUBMISSION,
    "get /api/v1/submissions/{submission_id}/plot.png": SUBMISSION,
    "get /api/v1/submissions/{submission_id}/plot.svg": SUBMISSION,
    "get /api/v1/submissions/{submission_id}/recording.mcap": SUBMISSION,
    "get /api/v1/assignments": MEMBERS,
    "get /api/v1/assignments/{assignment_id}": MEMBERS,
    "get /api/v1/assignments/{assignment_id}/rules": MEMBERS,
    "get /api/v1/assignments/{assignment_id}/pinned": STAFF,
    "get /api/v1/assignments/{assignment_id}/team": MEMBERS,
    "get /api/v1/assignments/{assignment_id}/teams": STAFF,
    "get /api/v1/assignments/{assignment_id}/extensions": STAFF,
    "get /api/v1/assignments/{assignment_id}/similar": STAFF,
    "get /api/v1/submissions/{submission_id}/receipt": SUBMISSION,
    "get /api/v1/submissions/{submission_id}/gradings": (
        (401, 401, 403, 404, 200, 200, 404, 404),
        OPERATOR_ONLY,
    ),
    "get /api/v1/submissions/{submission_id}/source": SUBMISSION,
    "get /api/v1/submissions/{submission_id}/judgements": (
        (401, 401, 403, 404, 200, 200, 404, 404),
        OPERATOR_ONLY,
    ),
    # the machine judges all of it: assistants and instructors are told that there is no such item
    "get /api/v1/submissions/{submission_id}/judgements/{item}": (
        (401, 401, 403, 404, 404, 404, 404, 404),
        UNKNOWN,
    ),
    "get /api/v1/submissions/{submission_id}/comments": SUBMISSION,
    "get /api/v1/judgements/waiting": STAFF,
    "get /api/v1/appeals": STAFF,
    "get /api/v1/submissions/{submission_id}/appeals": SUBMISSION,
    "get /api/v1/regrades": STAFF,
    "get /api/v1/regrades/{regrade_id}": ((401, 401, 403, 403, 404, 404, 403, 404), UNKNOWN),  # there is none
    "get /api/v1/submissions/{submission_id}/changes": SUBMISSION,
    "get /api/v1/submissions/{submission_id}/gradescope.json": SUBMISSION,
    "get /api/v1/submissions/{submission_id}/prairielearn.json": SUBMISSION,
    "get /api/v1/gradebook.csv": STAFF,
    "get /api/v1/gradebook.xlsx": STAFF,
    "get /api/v1/dashboard": STAFF,
    "get /api/v1/assignments/{assignment_id}/students": STAFF,
    "get /api/v1/dashboard/costs": STAFF,
    "get /api/v1/dashboard/events": STAFF,
    "get /api/v1/me": MEMBERS,
    "get /api/v1/members": STAFF,
    "get /api/v1/members/{person}/identities": ((401, 401, 403, 403, 403, 200, 403, 404), UNKNOWN),
    "get /api/v1/course": (STAFF[0], NEEDS_COURSE),
    "get /api/v1/course/space": (STAFF[0], NEEDS_COURSE),
    "get /api/v1/course/assignments": STAFF,
    "get /api/v1/course/assignments/{assignment_id}/folder.zip": (
        (401, 401, 403, 403, 403, 404, 403, 404),
        UNKNOWN,
    ),
    "get /api/v1/course/notices": INSTRUCTORS,
    "get /api/v1/course/platforms": INSTRUCTORS,
    "get /api/v1/course/platforms/{platform}/people": (
        (401, 401, 403, 403, 403, 404, 403, 404),
        NEEDS_COURSE,
    ),
    "get /api/v1/course/export.zip": INSTRUCTORS,
    "get /api/v1/audit": (INSTRUCTORS[0], OPERATOR_ONLY),
    "get /api/v1/problems/{code}": EVERYBODY,
    "get /api/v1/live": ((401, 401, 404, 404, 404, 404, 404, 404), NOBODYS),  # nobody has one yet
    "get /healthz": ((503,) * 8, (503,) * 3),  # no worker lives in these tests
    "get /metrics": STAFF,
}
CHANGES = {
    "post /api/v1/submissions": (202, 401, 202),
    "put /api/v1/assignments/{assignment_id}/rules": NEEDS_COURSE,
    "put /api/v1/assignments/{assignment_id}/pinned/{mistake}": NEEDS_COURSE,
    "put /api/v1/assignments/{assignment_id}/team": NOBODYS,
    "delete /api/v1/assignments/{assignment_id}/team": NOBODYS,
    "put /api/v1/assignments/{assignment_id}/teams": NEEDS_COURSE,
    "put /api/v1/assignments/{assignment_id}/extensions/{student}": NEEDS_COURSE,
    "put /api/v1/submissions/{submission_id}/judgements": (401, 401, 422),
    "put /api/v1/submissions/{submission_id}/judgements/{item}": UNKNOWN,
    "post /api/v1/submissions/{submission_id}/comments": NOBODYS,
    "post /api/v1/submissions/{submission_id}/appeals": NOBODYS,
    "put /api/v1/submissions/{submission_id}/appeals/{item}": UNKNOWN,
    "delete /api/v1/submissions/{submission_id}/appeals/{item}": (404, 401, 403),
    "post /api/v1/regrades": (401, 401, 202),
    "post /api/v1/regrades/{regrade_id}/apply": UNKNOWN,
    "post /api/v1/regrades/{regrade_id}/discard": UNKNOWN,
    "post /api/v1/regrades/{regrade_id}/undo": UNKNOWN,
    "post /api/v1/gradebook/fill": OPERATOR_ONLY,
    "put /api/v1/course": NEEDS_COURSE,
    "post /api/v1/members/import": NEEDS_COURSE,
    "put /api/v1/members/{person}": NEEDS_COURSE,
    "delete /api/v1/members/{person}": UNKNOWN,
    "post /api/v1/members/{person}/tokens": UNKNOWN,
    "delete /api/v1/members/{person}/identities/{identity}": UNKNOWN,
    "post /api/v1/course/assignments": NEEDS_COURSE,
    "delete /api/v1/course/assignments/{assignment_id}": NEEDS_COURSE,
    "put /api/v1/course/notices/webhooks/{outlet}": NEEDS_COURSE,
    "delete /api/v1/course/notices/webhooks/{outlet}": NEEDS_COURSE,
    "put /api/v1/course/notices/mail": NEEDS_COURSE,
    "post /api/v1/course/notices/{outlet}/test": NEEDS_COURSE,
    "post /api/v1/course/platforms": NEEDS_COURSE,
    "delete /api/v1/course/platforms/{platform}": NEEDS_COURSE,
    "post /api/v1/course/platforms/{platform}/people": NEEDS_COURSE,
    "post /api/v1/course/retention": NEEDS_COURSE,
    "post /api/v1/members/{person}/forget": NEEDS_COURSE,
    "post /api/v1/courses": NEEDS_COURSE,
    "put /api/v1/course/archived": NEEDS_COURSE,
    "post /api/v1/live": NOBODYS,
    "delete /api/v1/live": NOBODYS,
    "post /api/v1/practice": NOBODYS,
    "post /api/v1/practice/events": NOBODYS,
}
"""What changes something, without courses; in courses: `tests/unit/service/web/test_foreign_changes.py`."""


BODIES: dict[str, dict[str, Any]] = {
    "post /api/v1/submissions": {"files": {"file": ("a.py", b"x = 1\n")}, "data": {"assignment": "square"}},
    "put /api/v1/assignments/{assignment_id}/pinned/{mistake}": {"json": {"text": "x"}},
    "put /api/v1/assignments/{assignment_id}/teams": {"json": {"teams": []}},
    "put /api/v1/submissions/{submission_id}/judgements": {
        "json": {"items": [{"item": "closed", "points": 1}]}
    },
    "put /api/v1/submissions/{submission_id}/judgements/{item}": {"json": {"points": 1}},
    "post /api/v1/submissions/{submission_id}/comments": {"json": {"text": "x"}},
    "post /api/v1/submissions/{submission_id}/appeals": {"json": {"item": "closed", "reason": "x"}},
    "put /api/v1/submissions/{submission_id}/appeals/{item}": {"json": {"state": "refused", "text": "x"}},
    "post /api/v1/regrades": {"json": {"assignment": "square"}},
    "post /api/v1/regrades/{regrade_id}/apply": {"json": {"reason": "x"}},
    "post /api/v1/regrades/{regrade_id}/discard": {"json": {"reason": "x"}},
    "post /api/v1/regrades/{regrade_id}/undo": {"json": {"reason": "x"}},
    "post /api/v1/gradebook/fill": {
        "files": {"file": ("s.csv", b"id,points\nli,\n")},
        "params": {"column": "points"},
    },
    "put /api/v1/course": {"json": {"distro": "humble"}},
    "post /api/v1/members/import": {"files": {"file": ("class.csv", b"id,name\nzhou,x\n")}},
    "post /api/v1/members/{person}/tokens": {"json": {}},
    "post /api/v1/members/{person}/forget": {"json": {}},
    "post /api/v1/course/assignments": {"files": {"file": ("walk.zip", b"none")}},
    "put /api/v1/course/notices/webhooks/{outlet}": {
        "json": {"vendor": "wecom", "address": example_address(Vendor.WECOM).replace("…", "x")}
    },
    "put /api/v1/course/notices/mail": {"json": {"due": False, "graded": False, "faults": False}},
    "post /api/v1/course/platforms": {
        "json": dict.fromkeys(NewPlatform.__dataclass_fields__, "https://moodle.example")
    },
    "post /api/v1/course/retention": {"json": {"older_than_days": 400}},
    "post /api/v1/courses": {"json": {"id": "next"}},
    "put /api/v1/course/archived": {"json": {"archived": True}},
    **{
        f"post /api/v1/practice{stream}": {
            "files": {"file": ("a.py", b"x = 1\n")},
            "data": {"assignment": "square"},
        }
        for stream in ("", "/events")
    },
}
PLACES = {
    "assignment_id": "square",
    "code": "empty",
    "student": "li",
    "outlet": "class",
    "regrade_id": "none",
    "item": "none",
    "platform": "none",
    "identity": "none",
    "mistake": "none",
}


def send(
    client: httpx.Client, operation: str, submission: str, headers: dict[str, str], student: str = ""
) -> int:
    method, path = operation.split()
    person = "new" if method == "put" else "han"
    body = BODIES.get(operation, {"json": {}} if method == "put" else {})
    if operation == "post /api/v1/submissions":
        body = {**body, "data": {**body["data"], "student": student}}
    path = path.format(**PLACES, submission_id=submission, person=person)
    with client.stream(method, path, headers=headers, **body) as response:  # some answers never end
        return response.status_code


def headers_of(school: Any, role: str) -> dict[str, str]:
    if role == "nobody":
        return {}
    if role == "wrong":
        return {"Authorization": f"Bearer {TOKEN}"}  # the operator's, which opens nothing in a course
    headers: dict[str, str] = school.as_(PEOPLE[role])
    return headers


def test_in_courses(client: httpx.Client, school: Any, graded: Callable[..., str]) -> None:
    submission = graded(student="", headers=school.as_("li")).rpartition("/")[2]
    for operation, (codes, _) in LOOKS.items():
        answers = tuple(send(client, operation, submission, headers_of(school, role)) for role in ROLES)
        assert answers == codes, operation


def answers_without_courses(client: httpx.Client, operation: str, submission: str) -> tuple[int, ...]:
    callers = ({}, {"Authorization": "Bearer wrong"}, {"Authorization": f"Bearer {TOKEN}"})
    return tuple(send(client, operation, submission, headers, "s2") for headers in callers)


def test_looks_without_courses(client: httpx.Client, graded: Callable[..., str]) -> None:
    submission = graded(student="s1").rpartition("/")[2]
    for operation, (_, codes) in LOOKS.items():
        assert answers_without_courses(client, operation, submission) == codes, operation


@pytest.mark.parametrize("operation", CHANGES)
def test_changes_without_courses(client: httpx.Client, graded: Callable[..., str], operation: str) -> None:
    submission = graded(student="s1").rpartition("/")[2]
    assert answers_without_courses(client, operation, submission) == CHANGES[operation]


def test_every_line_names_an_operation() -> None:
    assert {*LOOKS, *CHANGES} == OPERATIONS


def test_what_was_handed_in_openly_belongs_to_no_course(
    client: httpx.Client, services: Services, graded: Callable[..., str]
) -> None:
    url = graded(student="li")
    assert client.get(url).status_code == 200
    services.courses.create("ros", "ros", "Asia/Shanghai", "test")
    people = {"li": Role.STUDENT, "wang": Role.INSTRUCTOR}
    roster = [RosterEntry(id=one, name=one, role=role) for one, role in people.items()]
    services.courses.import_roster("ros", roster, "test")
    assert client.get(url).status_code == 401
    for person in people:
        token = services.tokens.issue("ros", person, timedelta(days=1), "test")[1]
        assert client.get(url, headers={"Authorization": f"Bearer {token}"}).status_code == 404


def test_a_student_hands_in_for_nobody_else(upload: Callable[..., httpx.Response], school: Any) -> None:
    assert upload(student="li", headers=school.as_("li")).json()["student"] == "li"
    assert upload(student="", headers=school.as_("li")).json()["student"] == "li"
    for person in ("han", "ta"):
        response = upload(student="li", headers=school.as_(person))
        assert (response.status_code, response.json()["code"]) == (403, "forbidden")
    assert upload(student="li", headers=school.as_("wang")).json()["student"] == "li"
    response = upload(student="nobody", headers=school.as_("wang"))
    assert response.json()["code"] == "unknown_student"


def test_handing_in_for_somebody_else_is_written_down(
    client: httpx.Client, upload: Callable[..., httpx.Response], school: Any, clock: FakeClock
) -> None:
    upload(student="li", headers=school.as_("li"))
    upload(student="", headers=school.as_("wang"))
    clock.advance(1.0)  # of two uploads at one instant, neither is the latest
    submission = upload(source=b"x = 1\n", student="li", headers=school.as_("wang")).json()["id"]
    assert upload(source=b"x = 1\n", student="li", headers=school.as_("wang")).json()["repeated"]
    entries = client.get("/api/v1/audit", headers=school.as_("wang")).json()["entries"]
    (entry,) = (one for one in entries if one["action"] == "submission.hand_in")
    assert (entry["actor"], entry["subject"]) == ("wang", f"submission {submission}")
    assert entry["after"]["student"] == "li"


def test_the_dashboard_shows_the_students_of_ones_own_course(
    client: httpx.Client, upload: Callable[..., httpx.Response], school: Any
) -> None:
    for person in ("li", "wang", "li2"):
        upload(student="", headers=school.as_(person))
    for teacher, student in (("ta", "li"), ("zhao", "li2")):
        document = client.get("/api/v1/dashboard", headers=school.as_(teacher)).json()
        assert [one["student"] for one in document["students"]] == [student]


def test_a_token_ends(client: httpx.Client, school: Any, clock: FakeClock) -> None:
    assert client.get("/api/v1/me", headers=school.as_("li")).json()["role"] == "student"
    clock.advance(24 * 3600)
    response = client.get("/api/v1/me", headers=school.as_("li"))
    assert response.status_code == 401
    assert response.headers["WWW-Authenticate"].startswith("Bearer")


def test_a_revoked_token_opens_nothing(client: httpx.Client, school: Any, services: Services) -> None:
    _, second = services.tokens.issue("ros", "li", timedelta(days=1), "test")
    assert services.tokens.revoke("ros", "test", person="li") == 2
    for token in (second, school.tokens["li"]):
        assert client.get("/api/v1/me", headers={"Authorization": f"Bearer {token}"}).status_code == 401
    assert client.get("/api/v1/me", headers=school.as_("han")).status_code == 200


def test_too_many_uploads_wait(
    client: httpx.Client, upload: Callable[..., httpx.Response], services: Services, clock: FakeClock
) -> None:
    most = services.settings.uploads_per_minute
    codes = [upload(student="s1", source=b"").json()["code"] for _ in range(most + 1)]
    assert codes == ["empty"] * most + ["too_many_requests"]
    assert upload(student="s2").status_code == 202
    response = upload(student="s1")
    assert response.status_code == 429
    clock.advance(int(response.headers["Retry-After"]))
    assert upload(student="s1").status_code == 202


def test_a_students_requests_are_limited_and_nobody_elses(
    client: httpx.Client, school: Any, services: Services
) -> None:
    for _ in range(services.settings.requests_per_minute):
        services.allowances.requests.take("ros/li")
    assert client.get("/api/v1/me", headers=school.as_("li")).status_code == 429
    assert client.get("/api/v1/me", headers=school.as_("han")).status_code == 200


def busy(services: Services, person: str) -> AbstractContextManager[None]:
    """Have `person` of the course as many requests under way as may be."""
    places = services.allowances.requests_at_once
    return all_taken(services.settings.requests_at_once, lambda: places.one_more(f"ros/{person}"))


def test_whoever_has_too_much_under_way_waits_and_nobody_else(
    client: httpx.Client, school: Any, services: Services, graded: Callable[..., str]
) -> None:
    submission = graded(student="", headers=school.as_("li")).rpartition("/")[2]
    others = ("/events", "/metrics")  # streams have a limit of their own, and machines ask for measurements
    personal = {one for one in LOOKS if LOOKS[one][0][0] == 401 and not one.endswith(others)}
    with busy(services, "wang"):
        for operation in personal:
            assert send(client, operation, submission, school.as_("wang")) == 429, operation
            assert send(client, operation, submission, school.as_("ta")) == LOOKS[operation][0][4]
        assert send(client, "post /api/v1/submissions", submission, school.as_("wang")) == 429
    assert send(client, "get /api/v1/me", submission, school.as_("wang")) == 200


@pytest.mark.parametrize(
    ("language", "title"), [("zh", "同时发出的请求太多"), ("en", "Too many requests at once")]
)
def test_too_much_at_once_is_said_in_the_readers_language(
    client: httpx.Client, school: Any, services: Services, language: str, title: str
) -> None:
    with busy(services, "li"):
        response = client.get("/api/v1/me", headers={**school.as_("li"), "Accept-Language": language})
    assert (response.status_code, response.headers["Retry-After"]) == (429, "1")
    problem = response.json()
    assert (problem["code"], problem["title"]) == ("too_many_at_once", title)


def test_what_takes_time_to_make_is_rationed_for_students(
    client: httpx.Client, school: Any, services: Services, graded: Callable[..., str], clock: FakeClock
) -> None:
    url = graded(student="", headers=school.as_("li"))
    plots = services.settings.costly_per_minute // 4
    codes = [client.get(f"{url}/plot.png", headers=school.as_("li")).status_code for _ in range(plots + 1)]
    assert codes == [200] * plots + [429]
    for costly in ("report", "trajectory", "plot.svg", "gradescope.json", "prairielearn.json"):
        response = client.get(f"{url}/{costly}", headers=school.as_("li"))
        assert (response.status_code, response.json()["code"]) == (429, "too_many_requests"), costly
        assert client.get(f"{url}/{costly}", headers=school.as_("ta")).status_code == 200
    assert client.get(url, headers=school.as_("li")).status_code == 429
    waiting = client.post(
        "/api/v1/submissions",
        files={"file": ("a.py", b"x = 2\n")},
        data={"assignment": "square"},
        headers=school.as_("li"),
    ).headers["Location"]
    assert client.get(waiting, headers=school.as_("li")).status_code == 200
    clock.advance(int(response.headers["Retry-After"]))
    assert client.get(f"{url}/report", headers=school.as_("li")).status_code == 200


def test_without_courses_the_plots_of_one_submission_are_rationed(
    client: httpx.Client, services: Services, graded: Callable[..., str]
) -> None:
    first, second = graded(student="s1"), graded(student="s2")
    costly = services.allowances.costly
    owner = f"submission {first[-36:]}"
    with all_taken(services.settings.costly_at_once, lambda: costly.one_more(ANYBODY, owner)):
        assert client.get(f"{first}/plot.png").json()["code"] == "too_many_at_once"
        assert client.get(f"{second}/plot.png").status_code == 200


def test_changes_are_written_down_without_secrets(client: httpx.Client, school: Any) -> None:
    first = client.get("/api/v1/audit", headers=school.as_("wang"), params={"limit": 2}).json()
    assert [one["action"] for one in first["entries"]] == ["token.issue", "token.issue"]
    rest = client.get(
        "/api/v1/audit", headers=school.as_("wang"), params={"before": first["next_before"]}
    ).json()
    assert rest["entries"][-1]["action"] == "course.create"
    assert rest["next_before"] is None
    assert {one["actor"] for one in rest["entries"]} == {"test"}
    assert all(token not in str((first, rest)) for token in school.tokens.values())


def test_who_is_in_the_course(client: httpx.Client, school: Any) -> None:
    document = client.get("/api/v1/members", headers=school.as_("ta"), params={"role": "student"}).json()
    assert [one["id"] for one in document["members"]] == ["han", "li"]
