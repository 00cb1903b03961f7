import hashlib
import io
import json
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

import httpx
import pytest
from mcap.reader import make_reader
from sqlalchemy import Engine, event

from grader.formats.packages.bundle import bundled
from grader.use_cases.services import Services
from tests.fakes.clock import FakeClock
from tests.fakes.grading import grade_next, trajectory
from tests.fakes.packages import below, package_files, zipped
from tests.fakes.server import PNG, FakePlotter

Upload = Callable[..., httpx.Response]


def test_an_upload_is_accepted_with_an_address(upload: Upload, client: httpx.Client) -> None:
    response = upload(b"good\n")
    assert response.status_code == 202
    receipt = response.json()
    assert receipt["status_url"] == response.headers["Location"] == f"/api/v1/submissions/{receipt['id']}"
    assert receipt["sha256"] == hashlib.sha256(b"good\n").hexdigest()
    assert receipt["received_at"] == "2026-03-02T08:00:00Z"
    assert client.get(receipt["status_url"]).json()["status"] == "queued"


def test_the_bytes_are_kept_as_they_came(upload: Upload, services: Services) -> None:
    source = "\ufeff# 方\r\n\tprint('你好')\r\n".encode()
    assert services.submissions.source(upload(source).json()["id"]) == source


def test_a_package_is_kept_without_what_lies_around_it(
    upload: Upload, client: httpx.Client, services: Services
) -> None:
    known = services.assignments.assignments  # type: ignore[attr-defined]
    services.assignments.assignments = (*known, replace(known[0], id="make", input="package"))  # type: ignore[attr-defined]
    first = upload(zipped(package_files()), "make", "s1", "my_turtle.zip")
    other = upload(zipped(below("src", package_files())), "make", "s2", "src.zip")
    assert first.status_code == other.status_code == 202
    assert first.json()["sha256"] == other.json()["sha256"]
    source = client.get(first.headers["Location"] + "/source")
    assert source.headers["content-type"] == "application/zip"
    assert source.content == bundled(zipped(package_files()))
    refused = upload(zipped({"a.py": "x"}), "make", "s1", "a.zip")
    assert (refused.status_code, refused.json()["code"]) == (422, "no_package")
    wrong = upload(zipped(package_files(**{"my_turtle/helper.py": "def broken("})), "make", "s1", "a.zip")
    assert (wrong.json()["code"], "my_turtle/my_turtle/helper.py" in wrong.text) == ("syntax_error", True)


def test_an_upload_rings_for_the_workers(upload: Upload, services: Services) -> None:
    before = services.doorbell.heard()
    upload()
    assert services.doorbell.heard() == before + 1


def test_waiting_submissions_know_their_place(upload: Upload, client: httpx.Client, clock: FakeClock) -> None:
    first = upload(student="a").headers["Location"]
    clock.advance(1)
    second = upload(student="b").headers["Location"]
    assert [client.get(url).json()["queue_position"] for url in (first, second)] == [0, 1]


def test_whoever_waits_is_told_when_to_ask_again(
    upload: Upload, client: httpx.Client, services: Services, clock: FakeClock
) -> None:
    url = upload().headers["Location"]
    waiting = client.get(url)
    assert waiting.headers["Retry-After"] == "2"
    tag = waiting.headers["ETag"]
    assert client.get(url, headers={"If-None-Match": tag}).status_code == 304
    grade_next(services.queue, services.assignments)
    graded = client.get(url, headers={"If-None-Match": tag})
    assert graded.status_code == 200
    assert "Retry-After" not in graded.headers
    assert client.get(url, headers={"If-None-Match": graded.headers["ETag"]}).content == b""


@pytest.mark.parametrize("person", ["li", "wang"])
def test_a_submission_is_read_in_one_transaction_of_few_statements(
    upload: Upload, client: httpx.Client, services: Services, school: Any, person: str
) -> None:
    """Whoever waits asks again and again: by far the most requests of an evening."""
    url = upload(student="", headers=school.as_("li")).headers["Location"]
    engine = services.queue._database.engine
    for _ in ("waiting", "graded"):
        client.get(url, headers=school.as_(person))  # what the process remembers for seconds is there now
        with executed(engine) as statements:
            assert client.get(url, headers=school.as_(person)).status_code == 200
        assert [one for one in statements if one.startswith("BEGIN")] == ["BEGIN DEFERRED"]
        assert len(statements) - 1 <= 5
        grade_next(services.queue, services.assignments)


@contextmanager
def executed(engine: Engine) -> Iterator[list[str]]:
    """Yield the statements that are executed meanwhile."""
    statements: list[str] = []

    def note(_connection: Any, _cursor: Any, statement: str, *_: Any) -> None:
        statements.append(statement)

    event.listen(engine, "before_cursor_execute", note)
    try:
        yield statements
    finally:
        event.remove(engine, "before_cursor_execute", note)


@pytest.mark.parametrize(
    ("sent", "kept"),
    [
        ("C:\\Users\\li\\square.py", "square.py"),
        ("../../etc/x.py", "x.py"),
        ("方.PY", "方.PY"),
        ("a\u202eb.py", "a\\u202eb.py"),
    ],
)
def test_file_names_are_only_names(upload: Upload, client: httpx.Client, sent: str, kept: str) -> None:
    url = upload(name=sent).headers["Location"]
    assert client.get(url).json()["file_name"] == kept


def test_a_graded_submission_tells_everything(graded: Callable[..., str], client: httpx.Client) -> None:
    document = client.get(graded(b"good\n"), params={"lang": "en"}).json()
    assert (document["status"], document["verdict"]) == ("graded", "graded")
    assert (document["score"], document["max_score"], document["queue_position"]) == (5.0, 10.0, None)
    assert [(item["id"], item["status"], item["earned"]) for item in document["rubric"]] == [
        ("sides", "passed", 5.0),
        ("closed", "failed", 0.0),
    ]
    assert document["rubric"][1]["hint"] == "try again"
    assert document["summary"] == "well done"
    assert document["mistakes"] == ["interior_angle", "wall_hit"]
    (run,) = document["runs"]
    assert (run["status"], run["blame"], run["duration_s"]) == ("interrupted", "nobody", 2.0)
    assert run["endpoints"][0]["name"] == "/turtle1/cmd_vel"


def test_output_is_bounded_and_shows_no_control_characters(
    graded: Callable[..., str], client: httpx.Client
) -> None:
    (run,) = client.get(graded()).json()["runs"]
    assert run["stdout"] == {"text": "<b>hi</b>\\x1b[31m\n", "dropped": 3}
    assert len(run["stderr"]["text"]) == 16_384
    assert run["stderr"]["dropped"] == 40_000 - 16_384
    assert len(run["logs"]) == 200
    assert run["logs_dropped"] == 100


def test_a_crash_shows_the_students_line(graded: Callable[..., str], client: httpx.Client) -> None:
    document = client.get(graded(b"raise ValueError('boom')\n")).json()
    assert document["verdict"] == "crashed"
    assert document["runs"][0]["error"]["line"] == 1
    assert document["runs"][0]["blame"] == "student"


@pytest.mark.parametrize(
    ("header", "query", "language"),
    [
        (None, None, "zh"),
        ("en", None, "en"),
        ("en", "zh", "zh"),
        ("zh-CN,zh;q=0.9,en;q=0.8", None, "zh"),
        ("en-GB,en;q=0.9,zh;q=0.8", None, "en"),
        ("fr,en;q=0.5,zh;q=0.1", None, "en"),
        ("fr", None, "zh"),
        ("zh;q=0,en;q=0.1", None, "en"),
        ("en;q=nan", None, "zh"),
        (";;,=;q", None, "zh"),
    ],
)
def test_language(
    graded: Callable[..., str], client: httpx.Client, header: str | None, query: str | None, language: str
) -> None:
    response = client.get(
        graded(),
        params={} if query is None else {"lang": query},
        headers={} if header is None else {"Accept-Language": header},
    )
    assert response.headers["Content-Language"] == language
    assert "Accept-Language" in response.headers["Vary"]
    assert response.json()["summary"] == {"zh": "做得不错", "en": "well done"}[language]


def test_the_report_is_served_byte_for_byte(
    graded: Callable[..., str], client: httpx.Client, services: Services
) -> None:
    first, second = graded(b"good\n"), graded(b"good\n", student="s2")
    one, two = client.get(first + "/report"), client.get(second + "/report")
    assert one.content == two.content
    digest = hashlib.sha256(one.content).hexdigest()
    assert one.headers["ETag"] == f'"{digest}"'
    assert client.get(first).json()["report_sha256"] == digest


@pytest.mark.parametrize("part", ["report", "source", "trajectory", "plot.svg"])
def test_what_a_client_has_is_not_sent_again(
    graded: Callable[..., str], client: httpx.Client, part: str
) -> None:
    url = f"{graded()}/{part}"
    first = client.get(url)
    tag = first.headers["ETag"]
    for held in (tag, f'"other", W/{tag}', "*"):
        for method in ("GET", "HEAD"):
            again = client.request(method, url, headers={"If-None-Match": held})
            assert (again.status_code, again.content) == (304, b"")
            assert again.headers["ETag"] == tag
            assert "Content-Type" not in again.headers
    assert client.get(url, headers={"If-None-Match": '"other"'}).content == first.content


@pytest.mark.parametrize("encoding", ["gzip", "identity"])
def test_the_trajectory_comes_as_recorded(
    graded: Callable[..., str], client: httpx.Client, encoding: str
) -> None:
    response = client.get(graded() + "/trajectory", headers={"Accept-Encoding": encoding})
    assert response.content == trajectory()
    assert response.headers["ETag"] == f'"{hashlib.sha256(trajectory()).hexdigest()}"'
    assert response.headers.get("Content-Encoding") == ("gzip" if encoding == "gzip" else None)


def test_a_plot_is_drawn_once(graded: Callable[..., str], client: httpx.Client, plotter: FakePlotter) -> None:
    url = graded(b"good good\n")
    first = client.get(url + "/plot.png", params={"lang": "en"})
    assert first.headers["Content-Type"] == "image/png"
    assert first.content == PNG + f" square en default {len(trajectory())}".encode()
    again = client.get(url + "/plot.png", params={"lang": "en"})
    assert again.content == first.content
    same_file = client.get(graded(b"good good\n", student="s2") + "/plot.png", params={"lang": "en"})
    assert same_file.headers["ETag"] == first.headers["ETag"]
    assert plotter.drawn == 1
    assert client.get(url + "/plot.png", params={"lang": "zh"}).content != first.content
    assert plotter.drawn == 2
    drawing = client.get(url + "/plot.svg", params={"lang": "en", "case": "default"})
    assert (drawing.headers["Content-Type"], drawing.content[:5]) == ("image/svg+xml", b"<svg>")
    assert drawing.headers["ETag"] != first.headers["ETag"]
    problem = client.get(url + "/plot.svg", params={"case": "other"}).json()
    assert (problem["code"], problem["allowed"]) == ("no_trajectory", ["default"])


def test_a_run_can_be_fetched_as_a_ros_bag(graded: Callable[..., str], client: httpx.Client) -> None:
    url = graded(b"good good\n")
    bag = client.get(url + "/recording.mcap", headers={"Accept-Encoding": "identity"})
    assert bag.content == client.get(url + "/recording.mcap").content  # packed on the way
    assert bag.headers["Content-Disposition"].endswith('-default.mcap"')
    reader = make_reader(io.BytesIO(bag.content))
    assert [each.data for each in reader.iter_attachments()] == [client.get(url + "/report").content]
    summary = reader.get_summary()
    assert summary is not None
    assert "/turtle1/pose" in {channel.topic for channel in summary.channels.values()}
    assert client.get(url + "/recording.mcap", params={"case": "other"}).json()["code"] == "no_trajectory"


def test_old_plots_are_forgotten(
    graded: Callable[..., str], client: httpx.Client, plotter: FakePlotter
) -> None:
    urls = [graded(f"good # {number}\n".encode()) for number in range(9)]
    for url in [*urls, urls[0], urls[-1]]:
        client.get(url + "/plot.png")
    assert plotter.drawn == 10


def test_an_infrastructure_fault_shows_no_score(
    upload: Upload, client: httpx.Client, services: Services
) -> None:
    url = upload().headers["Location"]
    for _ in range(3):
        services.queue.fail(services.queue.claim("w"), "the car fell over")
    document = client.get(url).json()
    assert (document["status"], document["score"], document["verdict"]) == (
        "infrastructure_error",
        None,
        None,
    )
    assert "fell over" not in json.dumps(document)


def test_every_answer_says_that_it_is_data(client: httpx.Client, upload: Upload) -> None:
    for response in (upload(), upload(b""), client.get("/healthz"), client.get("/nothing")):
        assert response.headers["X-Content-Type-Options"] == "nosniff"
        assert response.headers["Content-Security-Policy"].startswith("default-src 'none'")


def test_a_monitor_may_ask_for_the_head_only(client: httpx.Client) -> None:
    asked, whole = client.head("/healthz"), client.get("/healthz")
    assert (asked.status_code, asked.content) == (whole.status_code, b"") == (503, b"")


def test_no_shared_cache_keeps_what_is_somebodys(client: httpx.Client, graded: Callable[..., str]) -> None:
    url = graded(b"good")
    for part in ("", "/report", "/trajectory", "/source", "/plot.png"):
        kept = client.get(url + part).headers["Cache-Control"]
        assert kept in ("no-store", "private, no-cache")
