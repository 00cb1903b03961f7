"""Every page of a course as Chromium shows it: axe-core finds nothing serious, nothing is wider than its window.

In both colours and at three widths. axe-core comes with axe-playwright-python, of which nothing else is used.
"""

from collections.abc import Iterator
from datetime import timedelta

import pytest

from grader.contracts.identity import Caller, Role
from grader.contracts.regrade import Wanted
from grader.contracts.rules import Rules
from grader.service.web.routing import ROUTERS
from grader.store.audit import Signature
from grader.use_cases import appealing, commenting
from tests.e2e.axe import assert_sound
from tests.e2e.chromium import PATIENCE_S, Browser
from tests.e2e.school import COURSE, ESSAY, SQUARE, School, school
from tests.fakes.waiting import wait_until
from tests.unit.similarity.students import own_code, renamed

pytestmark = pytest.mark.browser
STUDENT, OTHER = "20260101", "20260102"
MORE = ("robot/stop_before_wall", "pybullet/pb_sphere", "nodes/add_server")
WORK = (
    (STUDENT, SQUARE, "wrong/one_radian.py"),
    (STUDENT, SQUARE, "wrong/crashed_thread.py"),
    (STUDENT, SQUARE, "solution.py"),
    (OTHER, SQUARE, "wrong/one_radian.py"),
    (OTHER, "square_input", "solution.py"),
    (OTHER, "stop_before_wall", "solution.py"),
    (OTHER, "pb_sphere", "solution.py"),
    (OTHER, "add_server", "solution.py"),
    (STUDENT, ESSAY, "solution.txt"),
)
NO_PAGE = (
    ".json",
    ".csv",
    ".xlsx",
    ".zip",
    ".png",
    ".mcap",
    ".txt",
    "/source",
    "/events",
    "/explanation",
    "/download/{name}",
)
ELSEWHERE = ("/enter/with/", "/lti/")  # another site's way in
OF_STUDENT = {
    "/": ("/",),
    "/enter": ("/enter",),
    "/guide": ("/guide",),
    "/playground": ("/playground",),
    "/submissions": ("/submissions",),
    "/assignments/{assignment_id}": (f"/assignments/{SQUARE}", f"/assignments/{ESSAY}"),
    "/assignments/{assignment_id}/practice": (f"/assignments/{SQUARE}/practice",),
    "/submissions/{submission_id}": tuple(
        f"/submissions/{{s{place}}}" for place, (student, *_) in enumerate(WORK) if student == STUDENT
    ),
}
OF_STAFF = {
    "/class": ("/class",),
    "/class/appeals": ("/class/appeals",),
    "/class/appeals/{submission_id}": ("/class/appeals/{s0}?item=angles",),
    "/class/assignments/{assignment_id}": (f"/class/assignments/{SQUARE}",),
    "/class/assignments/{assignment_id}/students": (f"/class/assignments/{SQUARE}/students",),
    "/class/audit": ("/class/audit",),
    "/class/compare": ("/class/compare?first={s0}&second={s2}",),
    "/class/course": ("/class/course",),
    "/class/gradebook": ("/class/gradebook",),
    "/class/guide": ("/class/guide",),
    "/class/guide/exercises": ("/class/guide/exercises",),
    "/class/judgements": ("/class/judgements",),
    "/class/judgements/phrases": ("/class/judgements/phrases",),
    "/class/judgements/{submission_id}": ("/class/judgements/{s8}?item=timer",),
    "/class/judgements/{submission_id}/several": ("/class/judgements/{s0}/several",),
    "/class/judgements/{submission_id}/whole": ("/class/judgements/{s8}/whole",),
    "/class/notices": ("/class/notices",),
    "/class/own": ("/class/own",),
    "/class/people": ("/class/people",),
    "/class/people/{person}": (f"/class/people/{STUDENT}",),
    "/class/platforms": ("/class/platforms",),
    "/class/receipts": ("/class/receipts",),
    "/class/regrades": ("/class/regrades",),
    "/class/regrades/{regrade_id}": ("/class/regrades/{regrade}",),
    "/class/regrades/{regrade_id}/changes/{submission_id}": ("/class/regrades/{regrade}/changes/{s0}",),
    "/class/rubric/{assignment_id}": (f"/class/rubric/{SQUARE}",),
    "/class/rules": ("/class/rules",),
    "/class/rules/{assignment_id}": (f"/class/rules/{SQUARE}",),
    "/class/rules/{assignment_id}/section": (f"/class/rules/{SQUARE}/section?name=1",),
    "/class/service": ("/class/service",),
    "/class/similar/{assignment_id}": (f"/class/similar/{SQUARE}",),
    "/class/similar/{assignment_id}/pair": (f"/class/similar/{SQUARE}/pair?first={{alike0}}&second={{alike1}}",),
    "/class/students/{student}": (f"/class/students/{STUDENT}?assignment={SQUARE}",),
    "/class/submissions/{submission_id}/gradings": ("/class/submissions/{s0}/gradings",),
    "/class/submissions/{submission_id}/gradings/compare": (
        "/class/submissions/{s0}/gradings/compare?first={grading}&second={grading}",
    ),
    "/class/teams/{assignment_id}": (f"/class/teams/{SQUARE}",),
    "/submissions/{submission_id}": tuple(f"/submissions/{{s{place}}}" for place in range(len(WORK))),
}  # fmt: skip


@pytest.fixture(scope="module")
def course(programs: tuple[str, str], tmp_path_factory: pytest.TempPathFactory) -> Iterator[School]:
    folder = tmp_path_factory.mktemp("school")
    with school(f"sqlite:///{folder}/grader.db", folder, WORK, more=MORE) as opened:
        yield opened


@pytest.fixture(scope="module")
def address(course: School) -> str:
    return course.address


@pytest.fixture(scope="module")
def names(course: School) -> dict[str, str]:
    """What stands in addresses: submissions by their place in `WORK`, two that are alike, a re-grade on trial."""
    services, first = course.services, course.submitted[0]
    signed = Signature(services.clock(), COURSE, "wang")
    services.rules.set(SQUARE, Rules(appeals_until=signed.at + timedelta(days=1)), signed)
    li = Caller(course=COURSE, person=STUDENT, role=Role.STUDENT)
    wang = Caller(course=COURSE, person="wang", role=Role.INSTRUCTOR)
    appealing.ask(services, li, first, "angles", "我量过，是 90 度。")
    commenting.add_comment(services, wang, first, "这里先想一想转弯的时间。", 12)
    graded = services.submissions.report(first)
    assert graded is not None
    regrade = services.regrades.open(Wanted(assignment=SQUARE, which="all"), signed).id
    services.doorbell.ring()
    with course.client("wang") as client:
        wait_until(lambda: not client.get(f"/api/v1/regrades/{regrade}").json()["waiting"], PATIENCE_S)
    own = f"class Own:{own_code(1)}"
    alike = {
        "alike0": _handed_in(course, "20260104", own),
        "alike1": _handed_in(course, "20260105", renamed(own)),
    }
    known = {"regrade": regrade, "grading": str(graded.attempt), **alike}
    return {**known, **{f"s{place}": one for place, one in enumerate(course.submitted)}}


def _handed_in(course: School, student: str, script: str) -> str:
    with course.client(student) as client:
        files = {"file": ("square.py", script.encode())}
        answer = client.post("/api/v1/submissions", data={"assignment": SQUARE}, files=files)
    return str(answer.raise_for_status().headers["Location"]).rpartition("/")[2]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("person", "pages"), [(STUDENT, OF_STUDENT), ("wang", OF_STAFF)], ids=["student", "staff"]
)
def test_nothing_serious_on_any_page(
    browser: Browser,
    course: School,
    axe: str,
    names: dict[str, str],
    person: str,
    pages: dict[str, tuple[str, ...]],
) -> None:
    browser.signed_in("token", course.tokens[person])
    assert_sound(browser, axe, [one.format_map(names) for some in pages.values() for one in some])


def test_no_page_is_left_out() -> None:
    paths = {route.path for router in ROUTERS for route in router.routes if "GET" in route.methods}
    pages = {one for one in paths if not one.endswith(NO_PAGE) and not one.startswith(ELSEWHERE)}
    assert pages == OF_STUDENT.keys() | OF_STAFF.keys()
