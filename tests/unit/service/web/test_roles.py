"""Every page as every role: a new page without a line here fails. Forms: `test_foreign_changes.py`."""

import shutil
from dataclasses import dataclass, replace
from datetime import datetime, timedelta
from pathlib import Path

import httpx
import pytest
from fastapi.routing import APIRoute

from grader.contracts.grading import AssignmentSource
from grader.contracts.identity import Role, RosterEntry
from grader.contracts.regrade import Wanted
from grader.operation.settings import Settings
from grader.service.web.access import SESSION_COOKIE
from grader.service.web.forms import COOKIE, FIELD
from grader.service.web.routing import ROUTERS
from grader.store.audit import Signature
from grader.use_cases.services import Services
from tests.fakes import server
from tests.fakes.clock import FakeClock
from tests.fakes.courses import PreparedCourses
from tests.unit.service.web.conftest import PAGE, grade_all, put_in

FORM_TOKEN = "t" * 32
OPERATIONS = sorted(
    f"{method} {route.path}"
    for router in ROUTERS
    for route in router.routes
    if isinstance(route, APIRoute)
    for method in route.methods
)
LOOKS = [operation for operation in OPERATIONS if operation.startswith("GET")]

# `classmate` is another student of the course, `stranger` the instructor of another one
ROLES = ("nobody", "owner", "classmate", "assistant", "instructor", "stranger")
EVERYBODY = (200,) * 6
OWN = (303, 200, 404, 200, 200, 404)
MEMBERS = (303, 200, 200, 200, 200, 200)
STAFF = (303, 403, 403, 200, 200, 200)
COURSE = (303, 403, 403, 200, 200, 404)  # of this course: a stranger is told that there is none
INSTRUCTORS = (303, 403, 403, 403, 200, 200)
EXPECTED: dict[str, tuple[int, ...]] = {
    "GET /": MEMBERS,
    "GET /enter": EVERYBODY,
    "GET /guide": EVERYBODY,
    "GET /download/{name}": (404,) * 6,  # no version of that name
    "GET /enter/with/{provider_id}": (404,) * 6,  # there is no such provider
    "GET /enter/with/{provider_id}/back": (404,) * 6,
    "GET /lti/keys": (409,) * 6,
    "GET /lti/login": (409,) * 6,  # the service's own address is not set up
    "GET /lti/pick/{secret}": (410,) * 6,  # who has no secret, or one that is over
    "GET /lti/register/{secret}": (410,) * 6,
    "GET /class/platforms": INSTRUCTORS,
    "GET /class/notices": INSTRUCTORS,
    "GET /assignments/{assignment_id}": MEMBERS,
    "GET /playground": MEMBERS,
    "GET /assignments/{assignment_id}/practice": MEMBERS,
    "GET /submissions": MEMBERS,
    "GET /submissions/{submission_id}": OWN,
    "GET /submissions/{submission_id}/events": OWN,
    "GET /submissions/{submission_id}/explanation/events": OWN,
    "GET /submissions/{submission_id}/state.json": OWN,
    "GET /submissions/{submission_id}/trajectory.json": OWN,
    "GET /submissions/{submission_id}/sketch.json": OWN,
    "GET /submissions/{submission_id}/explanation": tuple(202 if one == 200 else one for one in OWN),
    "GET /submissions/{submission_id}/plot.png": OWN,
    "GET /submissions/{submission_id}/film.png": (303, 404, 404, 404, 404, 404),  # no PyBullet world
    "GET /submissions/{submission_id}/recording.mcap": OWN,
    "GET /submissions/{submission_id}/source": OWN,
    "GET /class": STAFF,
    "GET /class/assignments/{assignment_id}": STAFF,
    "GET /class/assignments/{assignment_id}/students": STAFF,
    "GET /class/students/{student}": COURSE,
    "GET /class/compare": COURSE,
    "GET /class/service": STAFF,
    "GET /class/similar/{assignment_id}": STAFF,
    "GET /class/similar/{assignment_id}/pair": (303, 403, 403, 404, 404, 404),  # nobody is like themselves
    "GET /class/submissions/{submission_id}/gradings": COURSE,
    "GET /class/submissions/{submission_id}/gradings/compare": COURSE,
    "GET /class/submissions/{submission_id}/{platform}.json": COURSE,
    "GET /class/gradebook": STAFF,
    "GET /class/gradebook.csv": STAFF,
    "GET /class/gradebook.xlsx": STAFF,
    "GET /class/regrades": STAFF,
    "GET /class/regrades/{regrade_id}": COURSE,
    "GET /class/regrades/{regrade_id}/state.json": COURSE,
    "GET /class/regrades/{regrade_id}/changes/{submission_id}": COURSE,
    "GET /class/rules": STAFF,
    "GET /class/rubric/{assignment_id}": STAFF,
    "GET /class/rules/{assignment_id}": STAFF,
    "GET /class/rules/{assignment_id}/section": INSTRUCTORS,
    "GET /class/receipts": STAFF,
    "GET /submissions/{submission_id}/receipt.txt": OWN,
    "GET /class/teams/{assignment_id}": STAFF,
    "GET /class/guide": STAFF,
    "GET /class/guide/exercises": STAFF,
    "GET /class/own/template.zip": INSTRUCTORS,
    "GET /class/judgements": STAFF,
    "GET /class/judgements/phrases": STAFF,
    "GET /class/judgements/{submission_id}/whole": (303, 403, 403, 404, 404, 404),
    "GET /class/judgements/{submission_id}": (303, 403, 403, 404, 404, 404),  # nobody judges a motion
    "GET /class/judgements/{submission_id}/several": (303, 403, 403, 403, 200, 404),
    "GET /class/appeals": STAFF,
    "GET /class/appeals/{submission_id}": (303, 403, 403, 404, 404, 404),  # nobody asked
    "GET /class/people": STAFF,
    "GET /class/people/{person}": COURSE,
    "GET /class/course": STAFF,
    "GET /class/own": STAFF,
    "GET /class/own/{assignment_id}/folder.zip": (303, 403, 403, 403, 404, 404),
    "GET /class/course/export.zip": INSTRUCTORS,
    "GET /class/audit": INSTRUCTORS,
}


@dataclass(frozen=True)
class Prepared:
    """A course with something of everything: its database, the time there, and `school`."""

    file: Path
    now: datetime
    school: dict[str, str]


@pytest.fixture(scope="module")
def prepared(
    courses: PreparedCourses, shipped: AssignmentSource, tmp_path_factory: pytest.TempPathFactory
) -> Prepared:
    """Made once, for every test to copy: making it takes longer than most tests with it."""
    file = Path(shutil.copy(courses.file, tmp_path_factory.mktemp("roles") / "grader.db"))
    with server.services(Settings(database_url=f"sqlite:///{file}"), FakeClock()) as made:
        services = replace(made, assignments=shipped)
        school = _fill(services, courses.tokens)
        now = services.clock()
    return Prepared(file, now, school)


def _fill(services: Services, tokens: dict[str, str]) -> dict[str, str]:
    services.courses.create("other", "Other", "UTC", "test")
    services.courses.import_roster("other", [RosterEntry(id="zhao", name="", role=Role.INSTRUCTOR)], "test")
    submission = put_in(services, student="li", course="ros").rpartition("/")[2]
    put_in(services, student="li", course="ros", assignment="spin")
    signed = Signature(services.clock(), "ros", "wang")
    regrade = services.regrades.open(Wanted(assignment="square"), signed).id
    grade_all(services)
    shown = {
        "owner": tokens["li"],
        "classmate": tokens["han"],
        "assistant": tokens["ta"],
        "instructor": tokens["wang"],
        "stranger": services.tokens.issue("other", "zhao", timedelta(days=1), "test")[1],
    }
    return {
        "submission_id": submission,
        "regrade_id": regrade,
        "platform": "prairielearn",
        "assignment_id": "square",
        "student": "li",
        "person": "li",
        "provider_id": "campus",
        **{role: services.callers.open_session(token) for role, token in shown.items()},
    }


@pytest.fixture
def sqlite_url(tmp_path: Path, prepared: Prepared) -> str:
    return f"sqlite:///{shutil.copy(prepared.file, tmp_path / 'grader.db')}"


@pytest.fixture
def school(services: Services, prepared: Prepared) -> dict[str, str]:
    """Ids that stand in the addresses, and everybody's session."""
    services.clock.now = prepared.now
    return {**prepared.school, "secret": "x" * 43, "name": "grader-0.0.0-py3-none-any.whl"}


def test_every_page_has_a_line() -> None:
    assert set(LOOKS) == set(EXPECTED)


def test_pages_open_for_the_right_roles(client: httpx.Client, school: dict[str, str]) -> None:
    assert {page: answers(client, school, page) for page in LOOKS} == EXPECTED


@pytest.mark.parametrize(
    ("token", "site"), [("", "same-origin"), ("x" * 32, "none"), (FORM_TOKEN, "cross-site")]
)
def test_no_form_of_another_site_is_taken(
    client: httpx.Client, school: dict[str, str], token: str, site: str
) -> None:
    """Not even from an instructor's browser, by any address."""
    cookies = f"{COOKIE}={FORM_TOKEN}; {SESSION_COOKIE}={school['instructor']}"
    headers = {**PAGE, "Cookie": cookies, "Sec-Fetch-Site": site}
    for operation in sorted(set(OPERATIONS) - set(LOOKS)):
        method, path = operation.split()
        if path.startswith("/lti/"):
            continue  # another site, the learning platform, sends these: they carry proofs of their own
        sent = {"files": {"file": ("a.csv", b"id,name\nnew,x\n")}, "data": {FIELD: token, "id": "next"}}
        answer = client.request(method, path.format_map(school), headers=headers, **sent)
        assert answer.status_code == httpx.codes.FORBIDDEN, operation
        assert "Set-Cookie" not in answer.headers, operation


def test_nothing_is_kept_on_the_way(client: httpx.Client, school: dict[str, str]) -> None:
    """What is somebody's is in no cache that others share."""
    headers = {**PAGE, "Cookie": f"{SESSION_COOKIE}={school['instructor']}"}
    for operation in LOOKS:
        with client.stream("GET", operation.split()[1].format_map(school), headers=headers) as answer:
            assert {"no-store", "private"} & set(answer.headers["Cache-Control"].split(", ")), operation


def answers(client: httpx.Client, school: dict[str, str], operation: str) -> tuple[int, ...]:
    """The status that each role gets."""
    path = operation.split()[1].format_map(school)
    query = {"first": school["submission_id"], "second": school["submission_id"]}
    if path.endswith("/section"):
        query = {"name": "A"}
    if path.endswith("gradings/compare"):
        query = {"first": "1", "second": "1"}
    statuses = []
    for role in ROLES:
        cookies = "" if role == "nobody" else f"{SESSION_COOKIE}={school[role]}"
        with client.stream("GET", path, params=query, headers={**PAGE, "Cookie": cookies}) as answer:
            if not path.endswith("/events"):  # one goes on until there is an explanation
                answer.read()
        statuses.append(answer.status_code)
    return tuple(statuses)
