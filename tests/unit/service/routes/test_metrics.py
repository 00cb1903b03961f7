import re
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import httpx
import pytest
from fastapi import FastAPI
from pydantic import SecretStr
from sqlalchemy import text

from grader.contracts.errors import InfrastructureError, SettingsError
from grader.contracts.report import GradeStatus
from grader.contracts.submission import WorkerState
from grader.operation.metrics import Metrics, exported
from grader.use_cases.services import Services
from tests.fakes.clock import FakeClock
from tests.fakes.server import TOKEN

OPERATOR = {"Authorization": f"Bearer {TOKEN}"}


def measured(client: httpx.Client, name: str, headers: dict[str, str] = OPERATOR) -> dict[str, float]:
    """Return the samples of one measurement by their labels as they are written."""
    response = client.get("/metrics", headers=headers)
    assert response.status_code == 200, response.text
    assert response.headers["content-type"].startswith("text/plain; version=0.0.4")
    lines = re.findall(rf"^{name}(?:\{{(.*)\}})? (\S+)$", response.text, re.MULTILINE)
    return {labels: float(value) for labels, value in lines}


def test_uploads_are_counted_by_what_became_of_them(
    client: httpx.Client, upload: Callable[..., httpx.Response]
) -> None:
    upload(source=b"x = 1\n")
    upload(source=b"x = 1\n")
    upload(source=b"def broken(")
    upload(name="square.txt")
    upload(student="")
    client.post("/api/v1/submissions", json={})
    page = {"Cookie": "grader_form=x"}
    client.post("/assignments/square", files={"file": ("a.py", b"x")}, headers=page)
    assert measured(client, "grader_uploads_total") == {
        'code="accepted"': 1,
        'code="repeated"': 1,
        'code="syntax_error"': 1,
        'code="wrong_file_type"': 1,
        'code="invalid_student"': 1,
        'code="unsupported_media_type"': 1,
        'code="foreign_form"': 1,
    }


def test_requests_are_told_apart_by_template_not_by_address(
    client: httpx.Client, graded: Callable[..., str]
) -> None:
    url = graded(student="20260123")
    for path in (
        url,
        "/api/v1/submissions/nobody-knows",
        "/nothing/here",
        "/static/progress.js",
        "/openapi.json",
    ):
        client.get(path)
    client.request("BREW", "/healthz")
    count = measured(client, "grader_http_request_seconds_count")
    submission = 'method="GET",route="/api/v1/submissions/{submission_id}",status='
    assert count[submission + '"200"'] == count[submission + '"404"'] == 1
    assert count['method="GET",route="none",status="404"'] == 1
    assert count['method="GET",route="/static",status="200"'] == 1
    assert count['method="GET",route="/openapi.json",status="200"'] == 1
    assert count['method="other",route="/healthz",status="405"'] == 1
    text = client.get("/metrics", headers=OPERATOR).text
    assert not [secret for secret in ("20260123", url.rpartition("/")[2], "nobody", TOKEN) if secret in text]


def test_queue_and_workers_are_read_from_the_rows(
    client: httpx.Client, services: Services, upload: Callable[..., httpx.Response], clock: FakeClock
) -> None:
    assert measured(client, "grader_sandbox_ready") == {"": 0}
    upload(student="s1")
    clock.advance(30)
    upload(student="s2")
    upload(student="s3")
    assert services.queue.claim("w/0") is not None
    clock.advance(12)
    now = clock()
    worker = WorkerState(
        id="w",
        slots=2,
        busy=1,
        sandbox_ready=True,
        isolation="strict",
        detail="",
        started_at=now,
        seen_at=now,
    )
    services.workers.report(worker)
    assert measured(client, "grader_submissions") == {
        'priority="0",state="queued"': 2,
        'priority="0",state="running"': 1,
    }
    with services.queue._database.writing() as session:  # a re-grade, which may wait for days
        session.execute(text("UPDATE submission SET priority = 1 WHERE student = 's2' AND state = 'queued'"))
        session.execute(text("UPDATE submission SET queued_at = '2020-01-01 00:00:00' WHERE priority = 1"))
    names = ("oldest_queued_seconds", "sandbox_ready", "workers_alive", "slots", "slots_busy", "database_up")
    assert [measured(client, "grader_" + name)[""] for name in names] == [12, 1, 1, 2, 1, 1]


def test_gradings_of_this_process_are_counted(client: httpx.Client, services: Services) -> None:
    services.metrics.graded(GradeStatus.GRADED, 0.7, 3.0)
    services.metrics.graded(GradeStatus.CRASHED, 0.3, 1.0)
    services.metrics.retried()
    services.metrics.given_up(2)
    assert measured(client, "grader_gradings_total") == {'verdict="graded"': 1, 'verdict="crashed"': 1}
    assert measured(client, "grader_grading_seconds_sum") == {"": 1.0}
    assert measured(client, "grader_time_to_grade_seconds_count") == {"": 2}
    assert measured(client, "grader_retries_total") == {"": 1}
    assert measured(client, "grader_given_up_total") == {"": 2}
    (build,) = measured(client, "grader_build_info")
    assert "pybullet" in build
    assert measured(client, "grader_event_streams") == {"": 0}


def test_a_database_that_is_away_is_measured_too(
    client: httpx.Client, services: Services, monkeypatch: pytest.MonkeyPatch
) -> None:
    def away(_: float) -> Any:
        raise InfrastructureError("the database does not answer")

    monkeypatch.setattr(services.workers, "alive", away)
    assert measured(client, "grader_database_up") == {"": 0}
    assert measured(client, "grader_submissions") == {}


def test_who_may_see_the_measurements(client: httpx.Client, school: Any) -> None:
    for person, status in (("li", 403), ("ta", 200), ("wang", 200)):
        assert client.get("/metrics", headers=school.as_(person)).status_code == status
    assert client.get("/metrics", headers=OPERATOR).status_code == 401


def test_a_scraper_has_a_token_of_its_own(
    running: tuple[FastAPI, str], client: httpx.Client, services: Services
) -> None:
    own = SecretStr("the-scraper-has-this-one")
    settings = services.settings.model_copy(update={"metrics_token": own})
    running[0].state.services = replace(services, settings=settings)
    assert measured(client, "grader_database_up", {"Authorization": "Bearer the-scraper-has-this-one"})
    for wrong in (b"the-scraper-has-this-on", "令牌".encode()):
        assert client.get("/metrics", headers={b"Authorization": b"Bearer " + wrong}).status_code == 401
    assert client.get("/api/v1/audit", headers={"Authorization": "Bearer the-scraper-has-this-one"}).is_error


def test_a_process_without_http_answers_on_a_port_of_its_own() -> None:
    metrics = Metrics()
    metrics.retried()
    with exported(metrics, 0) as port:
        text = httpx.get(f"http://127.0.0.1:{port}/metrics", trust_env=False).text
        with pytest.raises(SettingsError, match="metrics_port"), exported(metrics, port):
            pass
    assert "grader_retries_total 1.0" in text
    with pytest.raises(httpx.ConnectError):
        httpx.get(f"http://127.0.0.1:{port}/metrics", trust_env=False)
