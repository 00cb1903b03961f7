"""The part of a page that tells what was tried: asked for apart from the marks, and never of what is hidden."""

from collections.abc import Callable
from dataclasses import replace

import pytest

from grader.contracts.explanation import ChangedText, Explanation, ProvenChange
from grader.contracts.grading import GradingJob, GradingResult
from grader.contracts.rules import Rules
from grader.contracts.text import Text
from grader.store.audit import Signature
from grader.use_cases.services import Services
from tests.fakes.grading import FakeGrader, grade
from tests.unit.service.web.conftest import Browser

CHANGE = ProvenChange(
    code="scaled",
    text=Text(zh="第 1 行：写 <2>", en="Line 1: write <2>"),
    lines=(ChangedText(number=1, before="a < 1", after="a < 2"),),
    before=1.0,
    after=2.0,
)


def full_marks(job: GradingJob) -> GradingResult:
    result = grade(job)
    return replace(result, report=replace(result.report, score=result.report.max_score))


@pytest.fixture
def tried(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The files whose explanation was looked for."""
    looked: list[str] = []

    def explain(_: FakeGrader, job: object) -> Explanation:
        looked.append(job.file_name)  # type: ignore[attr-defined]
        return Explanation(changes=(CHANGE,), tried=3)

    monkeypatch.setattr(FakeGrader, "explain", explain)
    return looked


def test_what_was_tried_is_told_apart_from_the_marks_and_found_once(
    browser: Browser, put: Callable[..., str], tried: list[str]
) -> None:
    browser.get("/?lang=en")
    browser.enter(student="s1")
    address = put(b"good  # told once")
    page = browser.get(address).text
    assert f'data-address="{address}/explanation"' in page
    assert tried == []
    for _ in range(2):
        part = browser.get(f"{address}/explanation").text
        assert "Line 1: write &lt;2&gt;" in part
        assert "<del>   1 - a &lt; 1</del>" in part
        assert "<ins>   1 + a &lt; 2</ins>" in part
    assert tried == ["square.py"]


def test_nothing_is_tried_for_full_marks(browser: Browser, put: Callable[..., str], tried: list[str]) -> None:
    browser.enter(student="s1")
    address = put(b"good", grading=full_marks)
    assert "data-address" not in browser.get(address).text
    assert browser.get(f"{address}/explanation").text == ""
    assert tried == []


def test_what_is_hidden_is_not_given_away(
    browser: Browser, put: Callable[..., str], services: Services, tokens: dict[str, str], tried: list[str]
) -> None:
    services.rules.set("square", Rules(hidden_items=("closed",)), Signature(services.clock(), "ros", "wang"))
    browser.enter(token=tokens["li"])
    address = put(b"good  # hidden", student="li", course="ros")
    assert "data-address" not in browser.get(address).text
    assert browser.get(f"{address}/explanation").text == ""
    assert tried == []
