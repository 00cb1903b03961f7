from collections.abc import Callable, Iterator
from pathlib import Path

import httpx
import pytest

from grader.contracts.grading import GradingJob
from grader.routes.services import Services
from grader.settings import Settings
from tests.fakes import server
from tests.fakes.clock import FakeClock
from tests.fakes.grading import grade
from tests.fakes.server import FakePlotter


@pytest.fixture
def clock() -> FakeClock:
    return FakeClock()


@pytest.fixture
def plotter() -> FakePlotter:
    return FakePlotter()


@pytest.fixture
def services(tmp_path: Path, clock: FakeClock, plotter: FakePlotter) -> Iterator[Services]:
    settings = Settings(
        database_url=f"sqlite:///{tmp_path / 'grader.db'}", max_upload_bytes=2048, max_open_submissions=3
    )
    made = server.services(settings, clock, plotter)
    yield made
    made.plots.close()
    made.submissions._database.close()


@pytest.fixture
def client(services: Services) -> Iterator[httpx.Client]:
    with server.serving(server.nullcontext(services)) as made:
        yield made


@pytest.fixture
def upload(client: httpx.Client) -> Callable[..., httpx.Response]:
    def send(
        source: bytes = b"good good\n",
        assignment: str = "square",
        student: str = "s1",
        name: str = "square.py",
        headers: dict[str, str] | None = None,
    ) -> httpx.Response:
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
        claim = services.queue.claim("w")
        assert claim is not None
        job = GradingJob(
            file_name=claim.file_name,
            source=claim.source,
            assignment=services.assignments.get(claim.assignment),
        )
        assert services.queue.finish(claim, grade(job))
        return url

    return run
