import io
import json
import logging
import threading
import unicodedata
from collections.abc import Iterator
from contextvars import copy_context
from datetime import UTC, datetime

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from grader.contracts.submission import Claim
from grader.operation import logs
from grader.operation.settings import LogFormat

FORGED = "done\r\n2026-01-01T00:00:00+00:00 INFO forged\x1b[2J\u202e\u2028{}"


@pytest.fixture
def log() -> Iterator[logging.Logger]:
    logger = logging.Logger("grader.test")
    yield logger
    logger.handlers.clear()


def written(log: logging.Logger, log_format: LogFormat) -> io.StringIO:
    stream = io.StringIO()
    log.handlers = [logs.handler(log_format, stream)]
    return stream


def test_every_line_of_a_unit_of_work_says_what_it_is_about(log: logging.Logger) -> None:
    stream = written(log, "json")
    with logs.bound(submission="s-1", attempt=2):
        log.info("begun")
        with logs.bound(worker="w/0"):
            log.warning("the report could not be stored yet")
        log.info("done")
    log.info("idle")
    lines = [json.loads(line) for line in stream.getvalue().splitlines()]
    assert [(one.get("submission"), one.get("attempt"), one.get("worker")) for one in lines] == [
        ("s-1", 2, None),
        ("s-1", 2, "w/0"),
        ("s-1", 2, None),
        (None, None, None),
    ]
    assert {one["logger"] for one in lines} == {"grader.test"}
    assert lines[1]["level"] == "WARNING"
    assert lines[0]["time"].endswith("+00:00")


def test_what_a_thread_of_the_request_finds_out_is_on_the_requests_line(log: logging.Logger) -> None:
    stream = written(log, "text")
    with logs.bound(request_id="r1"):
        thread = threading.Thread(target=copy_context().run, args=(lambda: logs.note(submission="s-1"),))
        thread.start()
        thread.join()
        log.info("answered", extra={"status": 202})
    assert stream.getvalue().endswith(" grader.test: answered request_id=r1 submission=s-1 status=202\n")


def test_every_line_of_a_grading_names_it(log: logging.Logger) -> None:
    stream = written(log, "text")
    claim = Claim(
        submission_id="s-1",
        attempt=2,
        tries=1,
        worker="w/0",
        assignment="square",
        file_name="a.py",
        source=b"",
        queued_at=datetime.now(UTC),
        course=None,
        distro=None,
        runs_as=None,
    )
    with logs.about(claim):
        log.warning("try 1: the grading process died")
    assert stream.getvalue().endswith(" submission=s-1 attempt=2 assignment=square worker=w/0\n")


def test_outside_of_a_unit_of_work_nothing_is_noted() -> None:
    logs.note(submission="s-1")
    assert dict(logs.current()) == {}


@pytest.mark.parametrize("log_format", ["text", "json"])
@given(text=st.one_of(st.text(), st.just(FORGED)), name=st.text())
@example(text="", name="\xa0")
def test_nothing_written_can_forge_a_line(log_format: LogFormat, text: str, name: str) -> None:
    log = logging.Logger("grader.test")
    stream = written(log, log_format)
    log.error("%s", text, extra={"route": name})
    output = stream.getvalue()
    assert output.endswith("\n")
    assert all(one.isprintable() or unicodedata.category(one) == "Zs" for one in output[:-1])


def test_a_traceback_cannot_forge_a_line_either(log: logging.Logger) -> None:
    for log_format in ("text", "json"):
        stream = written(log, log_format)
        try:
            raise ValueError(FORGED)
        except ValueError:
            log.exception("a slot could not take work")
        first, *rest = stream.getvalue().splitlines()
        assert "a slot could not take work" in first
        assert all(line.startswith("    | ") for line in rest)
        assert "\x1b" not in stream.getvalue()
        assert "Traceback" in stream.getvalue()


def test_libraries_write_the_same_way(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    root = logging.getLogger()
    monkeypatch.setattr(root, "handlers", [])
    before = root.level
    try:
        logs.configure("json", "info")
        logging.getLogger("uvicorn.error").info("up", extra={"color_message": "\x1b[1mup"})
        logging.getLogger("alembic.runtime.migration").info("Context impl")
        line = json.loads(capsys.readouterr().err)
    finally:
        root.setLevel(before)
        logging.captureWarnings(False)
    assert (line["logger"], line["message"]) == ("uvicorn.error", "up")
    assert "color_message" not in line
