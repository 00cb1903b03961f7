"""What somebody writes in the editor: kept for them alone, within bounds, until it is the starter again."""

import html
import json
import re
from collections.abc import Callable
from typing import Any

import pytest

from grader.contracts.explanation import ChangedText, Explanation, ProvenChange
from grader.contracts.text import Text
from grader.service.web.line_links import lines_named, linked
from grader.store.audit import Signature
from grader.use_cases.services import Services
from tests.unit.service.web.conftest import Browser

PAGE = "/assignments/square/practice"


@pytest.fixture
def li(browser: Browser, tokens: dict[str, str]) -> Browser:
    browser.enter(token=tokens["li"])
    return browser


def keep(browser: Browser, content: bytes) -> Any:
    return browser.post(f"{PAGE}/draft", {}, page=PAGE, files={"file": ("square.py", content)})


def opened(browser: Browser, query: str = "?lang=en") -> dict[str, Any]:
    found = re.search(r"data-opened='([^']*)'", browser.get(PAGE + query).text)
    assert found is not None
    shown: dict[str, Any] = json.loads(html.unescape(found[1]))
    return shown


def test_a_draft_is_its_author_s_alone_and_goes_with_the_starter(
    li: Browser, tokens: dict[str, str], services: Services
) -> None:
    assert opened(li) == {"draft": None}
    assert keep(li, "x = '</script>' # 好\n".encode()).json() == {"problem": None}
    assert opened(li) == {"draft": "x = '</script>' # 好\n"}
    li.enter(token=tokens["han"])
    assert opened(li) == {"draft": None}
    li.enter(token=tokens["li"])
    assert keep(li, services.assignments.of("ros").starter("square")).status_code == 200
    assert opened(li) == {"draft": None}


def test_what_python_does_not_take_is_kept_and_told(li: Browser) -> None:
    problem = keep(li, b"x = 1\ndef broken(\n").json()["problem"]
    assert problem["line"] == 2
    assert problem["text"]
    assert opened(li)["draft"] == "x = 1\ndef broken(\n"


def test_too_much_and_too_often_is_refused(li: Browser, services: Services) -> None:
    assert keep(li, b"#" * (services.settings.max_upload_bytes + 1)).status_code == 413
    answers = [keep(li, b"x = 1\n").status_code for _ in range(31)]
    assert answers[-1] == 429
    assert answers.count(200) >= 29


def test_an_archived_course_keeps_nothing_new(li: Browser, services: Services) -> None:
    assert keep(li, b"x = 1\n").status_code == 200
    services.course_life.archive(Signature(services.clock(), "ros", "wang"))
    assert keep(li, b"x = 2\n").status_code == 409
    assert opened(li) == {"draft": "x = 1\n"}


def test_drafts_of_the_forgotten_are_gone(li: Browser, services: Services) -> None:
    assert keep(li, b"x = 1\n").status_code == 200
    services.course_life.forget("li", Signature(services.clock(), "ros", "wang"))
    assert services.drafts.of("ros", "li", "square") is None


def test_a_submission_is_brought_with_its_marked_lines(
    li: Browser, put: Callable[..., str], services: Services, tokens: dict[str, str]
) -> None:
    own = put(b"one\ntwo\n", student="li", course="ros").rpartition("/")[2]
    assert opened(li, f"?lang=en&mend={own}")["brought"] == "one\ntwo\n"
    change = ProvenChange(
        code="scaled",
        text=Text(zh="写 three", en="write three"),
        lines=(ChangedText(number=2, before="two", after="three"),),
        before=1.0,
        after=2.0,
        gains=("angles",),
    )
    claim = services.explanations.claim()
    assert claim is not None
    assert services.explanations.finish(claim, Explanation(changes=(change,), tried=1), 0.5)
    marks = opened(li, f"?lang=en&mend={own}")["marks"]
    assert [mark["line"] for mark in marks] == [2]
    assert marks[0]["text"].startswith("Corner angles")  # what was measured, not what to write
    li.enter(token=tokens["han"])
    assert li.get(f"{PAGE}?mend={own}").status_code == 404


def test_lines_that_a_sentence_names_are_links() -> None:
    assert lines_named("第 12 行：……，见第3行") == (12, 3)
    assert lines_named("Line 3: see line 40, not outline 5") == (3, 40)
    assert linked("Line 3 <b>, line 9", 5) == '<a href="#L3">Line 3</a> &lt;b&gt;, line 9'
