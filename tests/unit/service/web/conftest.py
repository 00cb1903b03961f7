import re
import shutil
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path

import httpx
import pytest
from fastapi import FastAPI

from grader.catalog import Catalog
from grader.contracts.errors import UnknownAssignmentError
from grader.contracts.grading import AssignmentSource, GradingJob, GradingResult
from grader.contracts.submission import NewSubmission
from grader.service.web.forms import COOKIE, FIELD
from grader.use_cases.services import Services
from tests.fakes import server
from tests.fakes.clock import FakeClock
from tests.fakes.courses import PreparedCourses
from tests.fakes.grading import grade, grade_next
from tests.fakes.provider import FakeProvider, provider

_TOKEN = re.compile(rf'name="{FIELD}" value="([^"]+)"')
PAGE = {"Accept": "text/html,application/xhtml+xml"}


class Shipped:
    """The assignments that come with the grader, read once."""

    def __init__(self) -> None:
        self._all = Catalog().all()

    def all(self):
        return self._all

    def of(self, course):
        return self

    def look_again(self):
        pass

    def troubles(self):
        return {}

    def starter(self, assignment_id: str) -> bytes:
        return b"import rclpy\n"

    def files(self, assignment_id: str):
        return Catalog().files(assignment_id)

    def given_code(self):
        return ()

    def get(self, assignment_id: str):
        for one in self._all:
            if one.id == assignment_id:
                return one
        raise UnknownAssignmentError(assignment_id)


class Browser:
    """A browser without scripts: keeps cookies, sends forms with the token of the page they are on."""

    def __init__(self, client: httpx.Client) -> None:
        self.client = client

    def get(self, path: str, **kwargs):
        return self.client.get(path, headers=PAGE, follow_redirects=False, **kwargs)

    def post(self, path: str, data: dict[str, str], files=None, page: str | None = None):
        """Send the form of a page, which is looked at the first time only: all pages have the same token."""
        known = self.client.cookies.get(COOKIE)
        if known is None and (found := _TOKEN.search(self.get(page or path).text)):
            known = found[1]
        fields = {**({} if known is None else {FIELD: known}), **data}
        return self.client.post(path, data=fields, files=files, headers=PAGE, follow_redirects=False)

    def enter(self, **said: str):
        return self.post("/enter", said)

    def hand_in(self, assignment: str, source: bytes, name: str = "square.py", **fields: str):
        return self.post(
            f"/assignments/{assignment}", fields, files={"file": (name, source, "text/x-python")}
        )


@pytest.fixture(scope="module")
def listening() -> Iterator[FakeProvider]:
    """A provider of identities, or a learning platform."""
    with provider() as known:
        yield known


@pytest.fixture(scope="session")
def shipped() -> AssignmentSource:
    return Shipped()


@pytest.fixture
def sqlite_url(request: pytest.FixtureRequest, tmp_path: Path, migrated_file: Path) -> str:
    """A migrated database, with the courses in it where a test asks for `tokens`: a copy takes less than rows."""
    with_courses = "tokens" in request.fixturenames
    file = request.getfixturevalue("courses").file if with_courses else migrated_file
    return f"sqlite:///{shutil.copy(file, tmp_path / 'grader.db')}"


@pytest.fixture
def services(sqlite_url: str, shipped: AssignmentSource) -> Iterator[Services]:
    settings = server.settings(database_url=sqlite_url, max_upload_bytes=4096)
    with server.services(settings, FakeClock()) as made:
        yield replace(made, assignments=shipped)


@pytest.fixture
def client(running: tuple[FastAPI, str], services: Services) -> Iterator[httpx.Client]:
    app, address = running
    app.state.services = services
    with httpx.Client(base_url=address, timeout=30.0, trust_env=False, verify=False) as client:
        yield client


@pytest.fixture
def browser(client: httpx.Client) -> Browser:
    return Browser(client)


@pytest.fixture
def instructor(client: httpx.Client) -> Browser:
    browser = Browser(client)
    assert browser.enter(token=server.TOKEN).headers["Location"] == "/class"
    return browser


def put_in(
    services: Services,
    source: bytes = b"good",
    *,
    student: str = "s1",
    assignment: str = "square",
    name: str = "square.py",
    course: str | None = None,
    grading: Callable[[GradingJob], GradingResult] | None = grade,
) -> str:
    """Store a submission past all checks of uploads, grade it unless told otherwise, return its address."""
    new = NewSubmission(course=course, student=student, assignment=assignment, file_name=name, source=source)
    added = services.intake.accept(new, services.clock())[0]
    if grading is not None:
        assert grade_next(services.queue, services.assignments, grading)
    services.clock.advance(60.0)
    return f"/submissions/{added.id}"


def grade_all(services: Services, change: Callable[[GradingJob], GradingJob] = lambda job: job) -> None:
    """Grade what waits, with what `change` makes of each job."""
    while grade_next(services.queue, services.assignments, lambda job: grade(change(job))):
        pass


@pytest.fixture
def put(services: Services) -> Callable[..., str]:
    return partial(put_in, services)


@pytest.fixture
def grade_waiting(services: Services) -> Callable[..., None]:
    return partial(grade_all, services)


@pytest.fixture(scope="session")
def courses(migrated_file: Path, tmp_path_factory: pytest.TempPathFactory) -> PreparedCourses:
    path = Path(shutil.copy(migrated_file, tmp_path_factory.mktemp("courses") / "grader.db"))
    people = {"li": "student", "han": "student", "ta": "assistant", "wang": "instructor"}
    return PreparedCourses(path, {"ros": people})


@pytest.fixture
def tokens(sqlite_url: str, courses: PreparedCourses) -> dict[str, str]:
    """The tokens of the people of a course, which is there from the start."""
    return dict(courses.tokens)
