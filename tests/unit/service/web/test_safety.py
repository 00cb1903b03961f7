"""Nothing a student controls can become markup, script, or invisible text on any page."""

from collections.abc import Callable
from dataclasses import replace
from html.parser import HTMLParser

import pytest

from grader.contracts.grading import GradingJob, GradingResult
from grader.contracts.outcome import Endpoint, LogRecord, Note, RunOutcome, RunStatus, Stream, StudentError
from grader.render.escape import visible
from grader.service.web.static_files import address
from grader.use_cases.services import Services
from tests.fakes.grading import grade
from tests.unit.service.web.conftest import Browser

EVIL = "</pre></script><script>alert(1)</script><img src=x onerror=alert(1)>\"' onload='alert(2)' {{7*7}}"
HIDDEN = "\x1b[31mred\x1b[0m \u202egnp.exe\u2066 \x00 \u200b\ufeff \x07 \u2028end"
HOSTILE = EVIL + HIDDEN
NAME = HOSTILE.replace("\x00", "")  # PostgreSQL keeps no NUL in a text: uploads with one are refused
STUDENT = "<img src=x onerror=alert(1)><script>alert(1)</script>\u202e\x1b[31m\u2028"  # at most 64 characters
CSP = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; connect-src 'self'; "
    "form-action 'self'; base-uri 'none'; frame-ancestors 'none'"
)


class Elements(HTMLParser):
    """Collects what a browser would make of a page."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str]]] = []
        self.inside: list[str] = []
        self.inline: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag, attrs) -> None:
        self.tags.append((tag, {name: value or "" for name, value in attrs}))
        self.inside.append(tag)

    def handle_endtag(self, tag) -> None:
        while self.inside and self.inside.pop() != tag:
            pass

    def handle_data(self, data) -> None:
        if self.inside and self.inside[-1] in ("script", "style") and data.strip():
            self.inline.append(data)


def assert_harmless(text: str) -> None:
    page = Elements(text)
    assert page.inline == []
    for tag, attributes in page.tags:
        assert not [name for name in attributes if name.startswith("on") or name == "style"], (
            tag,
            attributes,
        )
        for name in ("href", "src", "action"):
            assert attributes.get(name, "/").startswith(("/", "?", "#")), attributes
            assert not attributes.get(name, "/").startswith("//"), attributes
    assert {attributes["src"].rpartition("/")[0] for tag, attributes in page.tags if tag == "script"} == {
        address()
    }
    assert "49" not in [attributes.get("value") for _, attributes in page.tags]
    assert visible(text) == text  # nothing that moves, hides or reorders


def hostile_grade(job: GradingJob) -> GradingResult:
    result = grade(job)
    outcome = RunOutcome(
        status=RunStatus.CRASHED,
        duration_ns=1,
        error=StudentError(type=HOSTILE, message=HOSTILE, line=3, traceback=HOSTILE),
        cleanup_error=StudentError(type=HOSTILE, message=HOSTILE, line=3, traceback=HOSTILE),
        detail=HOSTILE,
        stdout=Stream(text=HOSTILE, dropped_bytes=1),
        stderr=Stream(text=HOSTILE),
        nodes=(HOSTILE,),
        endpoints=(Endpoint(kind="publisher", node=HOSTILE, name=HOSTILE, type=HOSTILE),),
        logs=(LogRecord(t_ns=0, level=40, name=HOSTILE, message=HOSTILE),),
        notes=(Note(code="forbidden", text=HOSTILE), Note(code=HOSTILE, text=HOSTILE)),
    )
    run = replace(result.report.runs[0], outcome=outcome)
    return replace(result, report=replace(result.report, runs=(run,)))


@pytest.fixture
def pages(instructor: Browser, put: Callable[..., str]) -> list[str]:
    """Every page that shows something of a student whose everything is hostile."""
    source = f"good # {NAME}".encode()
    first = put(source, student=STUDENT, name=f"{NAME}.py", grading=hostile_grade)
    second = put(source + b"\ngood", student=STUDENT, name=f"{NAME}.py", grading=hostile_grade)
    waiting = put(student=STUDENT, name=f"{NAME}.py", grading=None)
    from urllib.parse import quote

    ids = [one.rpartition("/")[2] for one in (first, second)]
    addresses = [
        first, waiting, "/class", f"/class?search={quote(HOSTILE)}&sort={quote(EVIL[:60])}", "/class/service",
        f"/class/students/{quote(STUDENT, safe='')}", f"/class/compare?first={ids[0]}&second={ids[1]}",
        f"/class/submissions/{ids[0]}/gradings", f"/class/gradebook?search={quote(HOSTILE)}",
        f"/class/people?search={quote(HOSTILE)}", "/class/regrades", "/class/judgements", "/class/rules",
        f"/class/regrades?students={quote(HOSTILE)}", "/class/rules/square?student=%3Cb%3E",
        f"/class/assignments/square?x={quote(HOSTILE)}", f"/enter?next={quote('/' + EVIL)}", f"/{quote(HOSTILE)}",
    ]  # fmt: skip
    return [
        instructor.get(address + ("&" if "?" in address else "?") + "lang=en").text for address in addresses
    ]


def test_hostile_text_is_shown_and_harmless(pages: list[str]) -> None:
    for text in pages:
        assert_harmless(text)
    assert "&lt;script&gt;alert(1)&lt;/script&gt;" in pages[0]
    assert "\\x1b[31mred" in pages[0]
    assert "\\u202egnp.exe" in pages[0]
    assert sum("onerror" in text for text in pages) >= 6  # it is there, as text


def test_hostile_file_names_are_harmless_when_refused(browser: Browser) -> None:
    answer = browser.hand_in("square", b"x", name="<img src=x onerror=alert(1)>\u202e.exe", student="s1")
    assert answer.status_code == 415
    assert "&lt;img" in answer.text
    assert_harmless(answer.text)


def test_hostile_source_is_harmless_when_refused(browser: Browser) -> None:
    answer = browser.hand_in("square", f"def broken( # {EVIL}\u202e".encode(), student="s1")
    assert answer.status_code == 422
    assert_harmless(answer.text)


def test_hostile_ids_are_harmless_when_refused(browser: Browser) -> None:
    for answer in (browser.hand_in("square", b"good", student=EVIL), browser.enter(student=HOSTILE[:150])):
        assert answer.status_code == 422
        assert_harmless(answer.text)


def test_data_for_scripts_is_json_and_nothing_else(instructor: Browser, put: Callable[..., str]) -> None:
    address = put(student=STUDENT, grading=hostile_grade)
    for name in ("state", "trajectory", "sketch"):
        answer = instructor.get(f"{address}/{name}.json")
        assert answer.headers["content-type"] == "application/json"
        assert answer.headers["x-content-type-options"] == "nosniff"


@pytest.mark.parametrize("path", ["/", "/assignments/square", "/enter", "/nothing"])
def test_every_page_carries_the_strict_policy(browser: Browser, path: str) -> None:
    headers = browser.get(path).headers
    assert headers["content-security-policy"] == CSP
    assert headers["x-content-type-options"] == "nosniff"
    assert headers["referrer-policy"] == "no-referrer"
    assert headers["cache-control"] == "no-store"


@pytest.mark.parametrize("path", ["/class/?show=stuck", "/api/v1/submissions/", "/static"])
def test_an_address_with_another_slash_leads_to_no_other_host(browser: Browser, path: str) -> None:
    foreign = {"Host": "evil.example", "X-Forwarded-Proto": "https"}
    answer = browser.client.get(path, headers=foreign, follow_redirects=False)
    assert answer.status_code == 307
    assert answer.headers["location"] == {"/static": "/static/"}.get(
        path, path.replace("/?", "?").rstrip("/")
    )


def test_static_files_are_typed_and_bounded(browser: Browser, services: Services) -> None:
    for name, kind in (
        ("style.css", "text/css"),
        ("replay.js", "text/javascript"),
        ("icon.svg", "image/svg+xml"),
    ):
        answer = browser.client.get(f"/static/{name}")
        assert answer.headers["content-type"].startswith(kind)
        assert answer.headers["x-content-type-options"] == "nosniff"
        assert (
            answer.headers["cache-control"] == "private, no-cache"
        )  # else an upgrade is not seen for months
        again = browser.client.get(f"/static/{name}", headers={"If-None-Match": answer.headers["etag"]})
        assert again.status_code == 304
        for_ever = browser.client.get(f"{address()}/{name}")
        assert (for_ever.content, for_ever.headers["content-encoding"]) == (answer.content, "gzip")
        assert for_ever.headers["cache-control"] == "public, max-age=31536000, immutable"
        plain = browser.client.get(f"{address()}/{name}", headers={"Accept-Encoding": "identity"})
        assert (plain.content, plain.headers.get("content-encoding")) == (answer.content, None)
        before = browser.client.get(f"/static/0123456789ab/{name}")  # a page of before an upgrade
        assert (before.content, before.headers["cache-control"]) == (answer.content, "private, no-cache")
    assert browser.client.get("/static/..%2fpages.py").status_code == 404
    for path in ("/static/", "/static/a/b/style.css", f"{address()}/none.js"):
        assert browser.client.get(path).status_code == 404


def test_a_fault_of_the_service_shows_no_inside(
    browser: Browser, services: Services, monkeypatch: pytest.MonkeyPatch
) -> None:
    def broken():
        raise RuntimeError("secret /path")

    monkeypatch.setattr(services.assignments, "all", broken)
    answer = browser.get("/")
    assert answer.status_code == 500
    assert "secret" not in answer.text
    assert "urn:uuid:" in answer.text
