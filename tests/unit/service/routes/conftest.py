import shutil
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import count
from pathlib import Path
from typing import Any

import httpx
import pytest
from fastapi import FastAPI

from grader.contracts.grading import GradingJob, GradingResult
from grader.use_cases.services import Services
from tests.fakes import server
from tests.fakes.clock import FakeClock
from tests.fakes.courses import PreparedCourses
from tests.fakes.essays import ANSWER, grade_essay, question
from tests.fakes.grading import grade_next
from tests.fakes.server import FakePlotter


@pytest.fixture
def clock() -> FakeClock:
    return FakeClock()


@pytest.fixture
def plotter() -> FakePlotter:
    return FakePlotter()


@pytest.fixture
def sqlite_url(request: pytest.FixtureRequest, tmp_path: Path, migrated_file: Path) -> str:
    """A migrated database, with the courses in it where a test asks for `school`: a copy takes less than rows."""
    with_courses = "school" in request.fixturenames
    file = request.getfixturevalue("courses").file if with_courses else migrated_file
    return f"sqlite:///{shutil.copy(file, tmp_path / 'grader.db')}"


@pytest.fixture
def services(sqlite_url: str, clock: FakeClock, plotter: FakePlotter) -> Iterator[Services]:
    settings = server.settings(database_url=sqlite_url, max_upload_bytes=2048, max_open_submissions=3)
    with server.services(settings, clock, plotter) as made:
        yield made


@pytest.fixture(scope="session")
def connected(running: tuple[FastAPI, str]) -> Iterator[httpx.Client]:
    with httpx.Client(base_url=running[1], timeout=30.0, trust_env=False, verify=False) as client:
        yield client


@pytest.fixture
def client(running: tuple[FastAPI, str], connected: httpx.Client, services: Services) -> httpx.Client:
    running[0].state.services = services
    return connected


@pytest.fixture
def upload(client: httpx.Client) -> Callable[..., httpx.Response]:
    number = count()

    def send(
        source: bytes | None = None,
        assignment: str = "square",
        student: str = "s1",
        name: str = "square.py",
        headers: dict[str, str] | None = None,
    ) -> httpx.Response:
        if source is None:  # the same bytes again would be recognised
            source = f"good good  # {next(number)}\n".encode()
        return client.post(
            "/api/v1/submissions",
            files={"file": (name, source, "text/x-python")},
            data={"assignment": assignment, "student": student},
            headers=headers,
        )

    return send


@pytest.fixture
def graded(upload: Callable[..., httpx.Response], services: Services) -> Callable[..., str]:
    """Upload a file and grade what is first in the queue; return the address of the submission."""

    def run(*args: object, **kwargs: object) -> str:
        url = upload(*args, **kwargs).headers["Location"]
        assert grade_next(services.queue, services.assignments)
        return url

    return run


@pytest.fixture(scope="session")
def courses(migrated_file: Path, tmp_path_factory: pytest.TempPathFactory) -> PreparedCourses:
    """A course with people and their tokens, beside another course."""
    path = Path(shutil.copy(migrated_file, tmp_path_factory.mktemp("courses") / "grader.db"))
    ros = {"li": "student", "han": "student", "ta": "assistant", "wang": "instructor"}
    return PreparedCourses(path, {"ros": ros, "other": {"li2": "student", "zhao": "instructor"}})


@dataclass(frozen=True)
class School:
    """The courses, and who may ask there."""

    tokens: dict[str, str]

    def as_(self, person: str) -> dict[str, str]:
        """Return the headers that `person` sends."""
        return {"Authorization": f"Bearer {self.tokens[person]}"}


@pytest.fixture
def school(sqlite_url: str, client: httpx.Client, courses: PreparedCourses) -> School:
    return School(dict(courses.tokens))


def work(services: Services, grade: Callable[[GradingJob], GradingResult]) -> int:
    """Let `grade` grade all that waits; return how many it were."""
    done = 0
    while grade_next(services.queue, services.assignments, grade):
        done += 1
    return done


@pytest.fixture
def answered(
    upload: Callable[..., httpx.Response], services: Services, school: Any, clock: FakeClock
) -> Callable[..., str]:
    """Hand in an answer and let the machine read it; return the submission's address."""
    services.assignments.assignments = (question(),)

    def run(student: str = "li", answer: bytes = ANSWER) -> str:
        clock.advance(10)
        response = upload(answer, "essay", "", "a.txt", headers=school.as_(student))
        work(services, grade_essay)
        return str(response.headers["Location"])

    return run


@pytest.fixture
def give(client: httpx.Client, school: Any) -> Callable[..., httpx.Response]:
    """Give points for an item of a submission."""

    def send(
        url: str, item: str, points: object, by: str = "ta", seen: str | None = None, comment: str = ""
    ) -> httpx.Response:
        headers = school.as_(by) | ({} if seen is None else {"If-Match": seen})
        body = {"points": points, "comment": comment}
        return client.put(f"{url}/judgements/{item}", json=body, headers=headers)

    return send
