"""Staff and a student write to each other on the page of a submission."""

from collections.abc import Callable

import pytest

from grader.contracts.comment import MOST_COMMENTS
from grader.store.audit import Signature
from grader.use_cases.services import Services
from tests.unit.service.web.conftest import Browser


@pytest.fixture
def own(put: Callable[..., str], tokens: dict[str, str]) -> str:
    return put(b"one\ntwo\n", student="li", course="ros")


def write(browser: Browser, own: str, text: str, line: str = "") -> int:
    answer = browser.post(f"{own}/comments", {"text": text, "line": line}, page=own)
    return (
        int(answer.headers["Location"].rpartition("-")[2])
        if answer.status_code == 303
        else -answer.status_code
    )


def test_comments_go_both_ways_and_are_counted_until_they_are_seen(
    browser: Browser, own: str, tokens: dict[str, str]
) -> None:
    browser.get("/?lang=en")
    browser.enter(token=tokens["ta"])
    assert write(browser, own, "Why <this>?", line="2") == 1
    assert write(browser, own, "Well done.") == 2
    browser.enter(token=tokens["li"])
    assert f'href="{own}#source">New comments on your work: 2</a>' in browser.get("/").text
    text = browser.get(own).text
    at_line = text[text.index('id="L2"') :]
    assert "Why &lt;this&gt;?" in at_line[: at_line.index("</li>")]
    assert "Well done." in text
    assert "New comments" not in browser.get("/").text
    assert write(browser, own, "Because.") == 3
    browser.enter(token=tokens["wang"])
    assert "new comments by students" in browser.get("/class").text
    assert "Because." in browser.get(own).text
    assert "new comments by students" not in browser.get("/class").text
    browser.enter(token=tokens["han"])
    assert "New comments" not in browser.get("/").text


@pytest.mark.parametrize(
    ("text", "line"), [("  ", ""), ("x" * 2_001, ""), ("a\x07", ""), ("x", "3"), ("x", "0"), ("x", "two")]
)
def test_what_is_no_comment_is_refused(
    browser: Browser, own: str, tokens: dict[str, str], services: Services, text: str, line: str
) -> None:
    browser.enter(token=tokens["li"])
    assert write(browser, own, text, line) == -422
    assert services.comments.of(own.rpartition("/")[2]) == ()


def test_a_submission_takes_so_many_comments(
    browser: Browser, own: str, tokens: dict[str, str], services: Services
) -> None:
    signed = Signature(services.clock(), "ros", "li")
    for _ in range(MOST_COMMENTS):
        services.comments.add(own.rpartition("/")[2], "x", None, signed, by_student=True)
    browser.enter(token=tokens["li"])
    assert write(browser, own, "x") == -422
