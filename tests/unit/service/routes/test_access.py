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

OPERATIONS = sorted(f"{method} {path}" for path, method in operations())

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
EVERYBODY = (200,) * 8
MEMBERS = (401, 401, 200, 200, 200, 200, 200, 200)
SUBMISSION = (401, 401, 200, 404, 200, 200, 404, 404)
STAFF = (401, 401, 403, 403, 200, 200, 403, 200)
INSTRUCTORS = (401, 401, 403, 403, 403, 200, 403, 200)
IN_COURSES: dict[str, tuple[int, ...]] = {
    "post /api/v1/submissions": (401, 401, 202, 202, 202, 202, 202, 202),
    "get /api/v1/submissions": MEMBERS,  # students their own
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
    "put /api/v1/assignments/{assignment_id}/rules": INSTRUCTORS,
    "get /api/v1/assignments/{assignment_id}/pinned": STAFF,
    "put /api/v1/assignments/{assignment_id}/pinned/{mistake}": (401, 401, 403, 403, 403, 422, 403, 422),
    "get /api/v1/assignments/{assignment_id}/team": MEMBERS,
    # the assignment is not for teams, and staff forms none
    "put /api/v1/assignments/{assignment_id}/team": (401, 401, 409, 409, 409, 409, 409, 409),
    "delete /api/v1/assignments/{assignment_id}/team": (401, 401, 409, 409, 409, 409, 409, 409),
    "get /api/v1/assignments/{assignment_id}/teams": STAFF,
    "put /api/v1/assignments/{assignment_id}/teams": INSTRUCTORS,
    "get /api/v1/assignments/{assignment_id}/extensions": STAFF,
    "get /api/v1/assignments/{assignment_id}/similar": STAFF,
    # the student is of the first course: the other's instructor is told that there is none
    "put /api/v1/assignments/{assignment_id}/extensions/{student}": (401, 401, 403, 403, 403, 200, 403, 422),
    "get /api/v1/submissions/{submission_id}/receipt": SUBMISSION,
    "get /api/v1/submissions/{submission_id}/gradings": (401, 401, 403, 404, 200, 200, 404, 404),
    "get /api/v1/submissions/{submission_id}/source": SUBMISSION,
    "get /api/v1/submissions/{submission_id}/judgements": (401, 401, 403, 404, 200, 200, 404, 404),
    # without a comment nobody corrects what the machine judged, assistants not at all
    "put /api/v1/submissions/{submission_id}/judgements": (401, 401, 403, 404, 403, 422, 404, 404),
    # the machine judges all of it: assistants and instructors are told that there is no such item
    "get /api/v1/submissions/{submission_id}/judgements/{item}": (401, 401, 403, 404, 404, 404, 404, 404),
    "put /api/v1/submissions/{submission_id}/judgements/{item}": (401, 401, 403, 404, 404, 404, 404, 404),
    "get /api/v1/submissions/{submission_id}/comments": SUBMISSION,
    "post /api/v1/submissions/{submission_id}/comments": (401, 401, 201, 404, 201, 201, 404, 404),
    "get /api/v1/judgements/waiting": STAFF,
    "get /api/v1/appeals": STAFF,
    "get /api/v1/submissions/{submission_id}/appeals": SUBMISSION,
    # none are taken
    "post /api/v1/submissions/{submission_id}/appeals": (401, 401, 403, 404, 403, 403, 404, 404),
    "put /api/v1/submissions/{submission_id}/appeals/{item}": (401, 401, 403, 404, 404, 404, 404, 404),
    "delete /api/v1/submissions/{submission_id}/appeals/{item}": (401, 401, 404, 404, 403, 403, 404, 404),
    "post /api/v1/regrades": (401, 401, 403, 403, 403, 202, 403, 422),  # the other course has nothing
    "get /api/v1/regrades": STAFF,
    "get /api/v1/regrades/{regrade_id}": (401, 401, 403, 403, 404, 404, 403, 404),  # there is none
    "post /api/v1/regrades/{regrade_id}/apply": (401, 401, 403, 403, 403, 404, 403, 404),
    "post /api/v1/regrades/{regrade_id}/discard": (401, 401, 403, 403, 403, 404, 403, 404),
    "post /api/v1/regrades/{regrade_id}/undo": (401, 401, 403, 403, 403, 404, 403, 404),
    "get /api/v1/submissions/{submission_id}/changes": SUBMISSION,
    "get /api/v1/submissions/{submission_id}/gradescope.json": SUBMISSION,
    "get /api/v1/submissions/{submission_id}/prairielearn.json": SUBMISSION,
    "get /api/v1/gradebook.csv": STAFF,
    "get /api/v1/gradebook.xlsx": STAFF,
    "post /api/v1/gradebook/fill": STAFF,
    "get /api/v1/dashboard": STAFF,
    "get /api/v1/assignments/{assignment_id}/students": STAFF,
    "get /api/v1/dashboard/costs": STAFF,
    "get /api/v1/dashboard/events": STAFF,
    "get /api/v1/me": MEMBERS,
    "put /api/v1/course": INSTRUCTORS,
    "get /api/v1/members": STAFF,
    "post /api/v1/members/import": INSTRUCTORS,
    "put /api/v1/members/{person}": INSTRUCTORS,
    "delete /api/v1/members/{person}": (401, 401, 403, 403, 403, 204, 403, 404),
    "post /api/v1/members/{person}/tokens": (401, 401, 403, 403, 403, 201, 403, 404),
    "get /api/v1/members/{person}/identities": (401, 401, 403, 403, 403, 200, 403, 404),
    "delete /api/v1/members/{person}/identities/{identity}": (401, 401, 403, 403, 403, 404, 403, 404),
    "get /api/v1/course": STAFF,
    "get /api/v1/course/space": STAFF,
    "get /api/v1/course/assignments": STAFF,
    "post /api/v1/course/assignments": (401, 401, 403, 403, 403, 422, 403, 422),  # it is no zip
    "get /api/v1/course/assignments/{assignment_id}/folder.zip": (401, 401, 403, 403, 403, 404, 403, 404),
    "delete /api/v1/course/assignments/{assignment_id}": (401, 401, 403, 403, 403, 404, 403, 404),
    "get /api/v1/course/notices": INSTRUCTORS,
    "put /api/v1/course/notices/webhooks/{outlet}": (401, 401, 403, 403, 403, 204, 403, 204),
    "delete /api/v1/course/notices/webhooks/{outlet}": (401, 401, 403, 403, 403, 404, 403, 404),
    "put /api/v1/course/notices/mail": (401, 401, 403, 403, 403, 204, 403, 204),
    "post /api/v1/course/notices/{outlet}/test": (401, 401, 403, 403, 403, 404, 403, 404),
    "get /api/v1/course/platforms": INSTRUCTORS,
    "post /api/v1/course/platforms": (401, 401, 403, 403, 403, 409, 403, 409),  # not set up
    "delete /api/v1/course/platforms/{platform}": (401, 401, 403, 403, 403, 404, 403, 404),
    "get /api/v1/course/platforms/{platform}/people": (401, 401, 403, 403, 403, 404, 403, 404),
    "post /api/v1/course/platforms/{platform}/people": (401, 401, 403, 403, 403, 404, 403, 404),
    "get /api/v1/course/export.zip": INSTRUCTORS,
    "post /api/v1/course/retention": INSTRUCTORS,
    "post /api/v1/members/{person}/forget": (401, 401, 403, 403, 403, 200, 403, 404),
    "post /api/v1/courses": (401, 401, 403, 403, 403, 201, 403, 422),  # the id is taken by then
    "put /api/v1/course/archived": INSTRUCTORS,
    "get /api/v1/audit": INSTRUCTORS,
    "get /api/v1/problems/{code}": EVERYBODY,
    "post /api/v1/live": (401, 401, 201, 201, 201, 201, 201, 201),
    "get /api/v1/live": (401, 401, 404, 404, 404, 404, 404, 404),  # nobody has one yet
    "delete /api/v1/live": (401, 401, 204, 204, 204, 204, 204, 204),
    "post /api/v1/practice": MEMBERS,
    "post /api/v1/practice/events": MEMBERS,
    "get /healthz": (503,) * 8,  # no worker lives in these tests
    "get /metrics": STAFF,
}

# without courses: anybody, a wrong token, the operator
OPEN_TO_ALL = (200, 401, 200)
OPERATOR_ONLY = (401, 401, 200)
WITHOUT_COURSES: dict[str, tuple[int, int, int]] = {
    "post /api/v1/submissions": (202, 401, 202),
    "get /api/v1/submissions": OPERATOR_ONLY,
    "get /api/v1/submissions/{submission_id}": OPEN_TO_ALL,
    "get /api/v1/submissions/{submission_id}/receipt": OPEN_TO_ALL,
    "get /api/v1/submissions/{submission_id}/report": OPEN_TO_ALL,
    "get /api/v1/submissions/{submission_id}/events": OPEN_TO_ALL,
    "get /api/v1/submissions/{submission_id}/trajectory": OPEN_TO_ALL,
    "get /api/v1/submissions/{submission_id}/plot.png": OPEN_TO_ALL,
    "get /api/v1/submissions/{submission_id}/plot.svg": OPEN_TO_ALL,
    "get /api/v1/submissions/{submission_id}/recording.mcap": OPEN_TO_ALL,
    "get /api/v1/assignments": OPEN_TO_ALL,
    "get /api/v1/assignments/{assignment_id}": OPEN_TO_ALL,
    "get /api/v1/assignments/{assignment_id}/pinned": OPERATOR_ONLY,
    "put /api/v1/assignments/{assignment_id}/pinned/{mistake}": (401, 401, 409),
    "get /api/v1/assignments/{assignment_id}/team": OPEN_TO_ALL,
    "put /api/v1/assignments/{assignment_id}/team": (409, 401, 409),
    "delete /api/v1/assignments/{assignment_id}/team": (409, 401, 409),
    "get /api/v1/assignments/{assignment_id}/teams": OPERATOR_ONLY,
    "put /api/v1/assignments/{assignment_id}/teams": (401, 401, 409),
    "get /api/v1/assignments/{assignment_id}/rules": OPEN_TO_ALL,
    "put /api/v1/assignments/{assignment_id}/rules": (401, 401, 409),
    "get /api/v1/assignments/{assignment_id}/extensions": OPERATOR_ONLY,
    "get /api/v1/assignments/{assignment_id}/similar": OPERATOR_ONLY,
    "put /api/v1/assignments/{assignment_id}/extensions/{student}": (401, 401, 409),
    "get /api/v1/submissions/{submission_id}/gradings": OPERATOR_ONLY,
    "get /api/v1/submissions/{submission_id}/source": OPEN_TO_ALL,
    "get /api/v1/submissions/{submission_id}/judgements": OPERATOR_ONLY,
    "put /api/v1/submissions/{submission_id}/judgements": (401, 401, 422),
    "get /api/v1/submissions/{submission_id}/judgements/{item}": (401, 401, 404),
    "put /api/v1/submissions/{submission_id}/judgements/{item}": (401, 401, 404),
    "get /api/v1/submissions/{submission_id}/comments": OPEN_TO_ALL,
    "post /api/v1/submissions/{submission_id}/comments": (409, 401, 409),
    "get /api/v1/judgements/waiting": OPERATOR_ONLY,
    "get /api/v1/appeals": OPERATOR_ONLY,
    "get /api/v1/submissions/{submission_id}/appeals": OPEN_TO_ALL,
    "post /api/v1/submissions/{submission_id}/appeals": (409, 401, 409),
    "put /api/v1/submissions/{submission_id}/appeals/{item}": (401, 401, 404),
    "delete /api/v1/submissions/{submission_id}/appeals/{item}": (404, 401, 403),
    "post /api/v1/regrades": (401, 401, 202),
    "get /api/v1/regrades": OPERATOR_ONLY,
    "get /api/v1/regrades/{regrade_id}": (401, 401, 404),
    "post /api/v1/regrades/{regrade_id}/apply": (401, 401, 404),
    "post /api/v1/regrades/{regrade_id}/discard": (401, 401, 404),
    "post /api/v1/regrades/{regrade_id}/undo": (401, 401, 404),
    "get /api/v1/submissions/{submission_id}/changes": OPEN_TO_ALL,
    "get /api/v1/submissions/{submission_id}/gradescope.json": OPEN_TO_ALL,
    "get /api/v1/submissions/{submission_id}/prairielearn.json": OPEN_TO_ALL,
    "get /api/v1/gradebook.csv": OPERATOR_ONLY,
    "get /api/v1/gradebook.xlsx": OPERATOR_ONLY,
    "post /api/v1/gradebook/fill": OPERATOR_ONLY,
    "get /api/v1/dashboard": OPERATOR_ONLY,
    "get /api/v1/assignments/{assignment_id}/students": OPERATOR_ONLY,
    "get /api/v1/dashboard/costs": OPERATOR_ONLY,
    "get /api/v1/dashboard/events": OPERATOR_ONLY,
    "get /api/v1/me": OPEN_TO_ALL,
    "put /api/v1/course": (401, 401, 409),
    "get /api/v1/members": OPERATOR_ONLY,
    "post /api/v1/members/import": (401, 401, 409),
    "put /api/v1/members/{person}": (401, 401, 409),
    "delete /api/v1/members/{person}": (401, 401, 404),
    "post /api/v1/members/{person}/tokens": (401, 401, 404),
    "get /api/v1/members/{person}/identities": (401, 401, 404),
    "delete /api/v1/members/{person}/identities/{identity}": (401, 401, 404),
    "get /api/v1/course": (401, 401, 409),
    "get /api/v1/course/space": (401, 401, 409),
    "get /api/v1/course/assignments": OPERATOR_ONLY,
    "post /api/v1/course/assignments": (401, 401, 409),
    "get /api/v1/course/assignments/{assignment_id}/folder.zip": (401, 401, 404),
    "delete /api/v1/course/assignments/{assignment_id}": (401, 401, 409),
    "get /api/v1/course/notices": (401, 401, 409),
    "put /api/v1/course/notices/webhooks/{outlet}": (401, 401, 409),
    "delete /api/v1/course/notices/webhooks/{outlet}": (401, 401, 409),
    "put /api/v1/course/notices/mail": (401, 401, 409),
    "post /api/v1/course/notices/{outlet}/test": (401, 401, 409),
    "get /api/v1/course/platforms": (401, 401, 409),
    "post /api/v1/course/platforms": (401, 401, 409),
    "delete /api/v1/course/platforms/{platform}": (401, 401, 409),
    "get /api/v1/course/platforms/{platform}/people": (401, 401, 409),
    "post /api/v1/course/platforms/{platform}/people": (401, 401, 409),
    "get /api/v1/course/export.zip": (401, 401, 409),
    "post /api/v1/course/retention": (401, 401, 409),
    "post /api/v1/members/{person}/forget": (401, 401, 409),
    "post /api/v1/courses": (401, 401, 409),
    "put /api/v1/course/archived": (401, 401, 409),
    "get /api/v1/audit": OPERATOR_ONLY,
    "get /api/v1/problems/{code}": (200, 200, 200),
    "post /api/v1/live": (409, 401, 409),
    "get /api/v1/live": (409, 401, 409),
    "delete /api/v1/live": (409, 401, 409),
    "post /api/v1/practice": (409, 401, 409),
    "post /api/v1/practice/events": (409, 401, 409),
    "get /healthz": (503, 503, 503),
    "get /metrics": OPERATOR_ONLY,
}


def send(
    client: httpx.Client, operation: str, submission: str, headers: dict[str, str], student: str = ""
) -> int:
    method, path = operation.split()
    path = path.replace("{submission_id}", submission).replace("{assignment_id}", "square")
    path = path.replace("{code}", "empty").replace("{student}", "li")
    path = path.replace("{outlet}", "class").replace("{regrade_id}", "none").replace("{item}", "none")
    path = path.replace("{platform}", "none").replace("{person}", "new" if method == "put" else "han")
    body: dict[str, Any] = {"json": {"points": 1} if "judgements" in path else {}} if method == "put" else {}
    if path.endswith("/course"):
        body = {"json": {"distro": "humble"}}
    elif "/pinned/" in path:
        body = {"json": {"text": "x"}}
    elif method == "put" and path.endswith("/teams"):
        body = {"json": {"teams": []}}
    if path.endswith("/webhooks/class") and method == "put":
        body = {"json": {"vendor": "wecom", "address": example_address(Vendor.WECOM).replace("…", "x")}}
    if path.endswith("/course/platforms") and method == "post":
        body = {"json": dict.fromkeys(NewPlatform.__dataclass_fields__, "https://moodle.example")}
    if path.endswith("/notices/mail"):
        body = {"json": {"due": False, "graded": False, "faults": False}}
    if path.endswith("/comments") and method == "post":
        body = {"json": {"text": "x"}}
    if path.endswith("/judgements") and method == "put":
        body = {"json": {"items": [{"item": "closed", "points": 1}]}}
    if path.endswith("/appeals") and method == "post":
        body = {"json": {"item": "closed", "reason": "x"}}
    if "/appeals/" in path and method == "put":
        body = {"json": {"state": "refused", "text": "x"}}
    if "regrades" in path and method == "post":
        body = {"json": {"reason": "x"} if "none" in path else {"assignment": "square"}}
    if operation == "post /api/v1/submissions":
        body = {
            "files": {"file": ("a.py", b"x = 1\n")},
            "data": {"assignment": "square", "student": student},
        }
    if operation.startswith("post /api/v1/practice"):
        body = {"files": {"file": ("a.py", b"x = 1\n")}, "data": {"assignment": "square"}}
    if operation == "post /api/v1/members/import":
        body = {"files": {"file": ("class.csv", b"id,name\nzhou,x\n")}}
    if operation == "post /api/v1/course/assignments":
        body = {"files": {"file": ("walk.zip", b"none")}}
    if operation == "post /api/v1/gradebook/fill":
        body = {"files": {"file": ("s.csv", b"id,points\nli,\n")}, "params": {"column": "points"}}
    if operation == "post /api/v1/members/{person}/tokens":
        body = {"json": {}}
    if operation == "post /api/v1/course/retention":
        body = {"json": {"older_than_days": 400}}
    if path.endswith("/forget"):
        body = {"json": {}}
    if operation == "post /api/v1/courses":
        body = {"json": {"id": "next"}}
    if operation == "put /api/v1/course/archived":
        body = {"json": {"archived": True}}
    with client.stream(method, path, headers=headers, **body) as response:  # some answers never end
        return response.status_code


def headers_of(school: Any, role: str) -> dict[str, str]:
    if role == "nobody":
        return {}
    if role == "wrong":
        return {"Authorization": f"Bearer {TOKEN}"}  # the operator's, which opens nothing in a course
    headers: dict[str, str] = school.as_(PEOPLE[role])
    return headers


# what only looks changes nothing for the next: one course is enough for all of it
LOOKS = [one for one in OPERATIONS if one.startswith("get")]
TOGETHER = [LOOKS, *([one] for one in OPERATIONS if one not in LOOKS)]
together = pytest.mark.parametrize("operations", TOGETHER, ids=["looks", *(one for (one,) in TOGETHER[1:])])


@together
def test_in_courses(
    operations: list[str],
    client: httpx.Client,
    services: Services,
    school: Any,
    graded: Callable[..., str],
) -> None:
    submission = graded(student="", headers=school.as_("li")).rpartition("/")[2]
    elsewhere = _assistant_of_another_section(services)
    for operation in operations:
        bound = send(client, operation, submission, elsewhere)
        answers = tuple(send(client, operation, submission, headers_of(school, role)) for role in ROLES)
        assert answers == IN_COURSES[operation], operation
        as_unbound = answers[ROLES.index("assistant")]
        assert bound == (404 if "{submission_id}" in operation else as_unbound), operation


def _assistant_of_another_section(services: Services) -> dict[str, str]:
    """Return the headers of an assistant who looks after a section that nobody of these tests is in."""
    entry = RosterEntry(id="tb", name="tb", role=Role.ASSISTANT, sections=("B",))
    services.courses.import_roster("ros", [entry], "test")
    token = services.tokens.issue("ros", "tb", timedelta(days=1), "test")[1]
    return {"Authorization": f"Bearer {token}"}


@together
def test_without_courses(operations: list[str], client: httpx.Client, graded: Callable[..., str]) -> None:
    submission = graded(student="s1").rpartition("/")[2]
    callers = ({}, {"Authorization": "Bearer wrong"}, {"Authorization": f"Bearer {TOKEN}"})
    for operation in operations:
        answers = tuple(send(client, operation, submission, headers, "s2") for headers in callers)
        assert answers == WITHOUT_COURSES[operation], operation


def test_every_line_names_an_operation() -> None:
    assert set(IN_COURSES) == set(WITHOUT_COURSES) == set(OPERATIONS)


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
    personal = {one for one in LOOKS if IN_COURSES[one][0] == 401 and not one.endswith(others)}
    with busy(services, "wang"):
        for operation in personal:
            assert send(client, operation, submission, school.as_("wang")) == 429, operation
            assert send(client, operation, submission, school.as_("ta")) == IN_COURSES[operation][4]
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
