import io
import json
import logging
from collections.abc import Callable, Iterator
from typing import Any

import httpx
import pytest

from grader.operation import logs
from grader.use_cases.services import Services
from tests.fakes.server import TOKEN


class Log:
    """What the service writes, in JSON."""

    def __init__(self) -> None:
        self._stream = io.StringIO()
        self.handler = logs.handler("json", self._stream)

    def of(self, request_id: str) -> list[dict[str, Any]]:
        lines = [json.loads(line) for line in self._stream.getvalue().splitlines()]
        return [one for one in lines if one.get("request_id") == request_id]

    def text(self) -> str:
        return self._stream.getvalue()


@pytest.fixture
def log() -> Iterator[Log]:
    made, logger = Log(), logging.getLogger("grader")
    logger.addHandler(made.handler)
    logger.setLevel(logging.DEBUG)
    yield made
    logger.removeHandler(made.handler)
    logger.setLevel(logging.NOTSET)


def test_an_upload_is_one_line_that_says_what_became_of_it(
    upload: Callable[..., httpx.Response], log: Log
) -> None:
    response = upload(student="s1", headers={"X-Request-ID": "proxy-0001.a_b"})
    assert response.headers["X-Request-ID"] == "proxy-0001.a_b"
    (line,) = log.of("proxy-0001.a_b")
    assert {
        name: line[name] for name in ("method", "route", "status", "code", "assignment", "submission")
    } == {
        "method": "POST",
        "route": "/api/v1/submissions",
        "status": 202,
        "code": "accepted",
        "assignment": "square",
        "submission": response.json()["id"],
    }
    assert line["duration_ms"] >= 0


@pytest.mark.parametrize(
    "given", ["short", "x" * 65, "12345678 INFO forged", "12345678;a=b", "日志日志日志日志".encode()]
)
def test_an_id_that_is_not_well_formed_is_replaced(
    client: httpx.Client, log: Log, given: str | bytes
) -> None:
    response = client.get("/api/v1/problems/empty", headers={"X-Request-ID": given})
    own = response.headers["X-Request-ID"]
    assert own != given
    assert len(own) == 32
    assert len(log.of(own)) == 1
    assert "forged" not in log.text()


def test_a_refusal_is_found_by_what_its_document_says(
    upload: Callable[..., httpx.Response], log: Log
) -> None:
    response = upload(source=b"def broken(")
    document = response.json()
    assert document["request_id"] == response.headers["X-Request-ID"]
    (line,) = log.of(document["request_id"])
    assert (line["code"], line["instance"], line["status"]) == ("syntax_error", document["instance"], 422)
    assert "broken" not in log.text()


def test_a_bug_has_the_id_of_its_request_on_every_line(
    client: httpx.Client, services: Services, monkeypatch: pytest.MonkeyPatch, log: Log
) -> None:
    def bug() -> None:
        raise ZeroDivisionError("a detail")

    monkeypatch.setattr(services.assignments, "all", bug)
    response = client.get("/api/v1/assignments")
    request_id = response.headers["X-Request-ID"]
    assert response.json()["request_id"] == request_id
    answered, failed = log.of(request_id)
    assert (answered["status"], answered["route"]) == (500, "/api/v1/assignments")
    assert "ZeroDivisionError: a detail" in failed["exception"]
    assert response.json()["instance"] in failed["message"]


def test_the_log_has_no_tokens_and_nothing_as_it_was_sent(
    client: httpx.Client, graded: Callable[..., str], school: Any, log: Log
) -> None:
    graded(student="", headers=school.as_("li"), source=b"good  # my secret thought\n")
    client.get("/api/v1/dashboard?search=needle", headers=school.as_("wang"))
    client.get(
        "/nothing/needle", headers={"Authorization": f"Bearer {TOKEN}", "Cookie": "grader_session=needle"}
    )
    text = log.text()
    secrets = [*school.tokens.values(), TOKEN, "needle", "secret thought"]
    assert [secret for secret in secrets if secret in text] == []


def test_machines_that_ask_often_do_not_fill_the_log(client: httpx.Client, log: Log) -> None:
    levels = {}
    for path in ("/healthz", "/metrics", "/static/progress.js", "/api/v1/problems/empty"):
        (line,) = log.of(client.get(path).headers["X-Request-ID"])
        levels[path] = line["level"]
    assert set(levels.values()) == {"DEBUG", "INFO"}
    assert levels["/api/v1/problems/empty"] == "INFO"
    assert levels["/healthz"] == levels["/static/progress.js"] == "DEBUG"
