"""The part of a page that tells what was tried: asked for apart from the marks, and never of what is hidden."""

import json
from collections.abc import Callable
from dataclasses import replace

import pytest

from grader.contracts.explanation import ChangedText, Explanation, ProvenChange, StatedCause
from grader.contracts.grading import GradingJob, GradingResult
from grader.contracts.report import report_from
from grader.contracts.rubric import RubricItem
from grader.contracts.rules import HintRule, Rules
from grader.contracts.text import Text
from grader.store.audit import Signature
from grader.use_cases.services import Services
from tests.fakes.grading import grade
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


def explain(services: Services, *, hidden: tuple[str, ...] = ()) -> bool:
    """Explain what waits longest; False when nothing does."""
    claim = services.explanations.claim()
    if claim is None:
        return False
    return services.explanations.finish(claim, Explanation(changes=(CHANGE,), tried=3, hidden=hidden), 0.5)


def test_what_was_tried_is_told_apart_from_the_marks(
    browser: Browser, put: Callable[..., str], services: Services
) -> None:
    browser.get("/?lang=en")
    browser.enter(student="s1")
    address = put(b"good  # told once")
    page = browser.get(address).text
    assert f'data-address="{address}/explanation"' in page
    assert "trying changes" in page
    assert browser.get(f"{address}/explanation").status_code == 202
    assert explain(services)
    assert not explain(services)
    part = browser.get(f"{address}/explanation")
    assert part.status_code == 200
    again = browser.get(address).text  # what somebody sees whose browser runs no scripts
    for text in (part.text, again):
        assert '<a href="#L1">Line 1</a>: write &lt;2&gt;' in text
        assert "<del>   1 - a &lt; 1</del>" in text
        assert "<ins>   1 + a &lt; 2</ins>" in text
    assert "trying changes" not in again
    assert not explain(services)


def test_what_stands_first_does_not_get_weaker(
    browser: Browser, put: Callable[..., str], services: Services
) -> None:
    """While changes are tried, the guess is a further hint below the fact that the first step begins with."""
    browser.get("/?lang=en")
    browser.enter(student="s1")
    address = put(b"good  # first things first", grading=guessed)
    lacking = next(item for item in items_of(services, address) if item.id == "angles")
    fact = f"</strong> {lacking.title.en}"
    page = browser.get(address).text
    assert page.index(fact) < page.index("<summary>One more hint</summary>") < page.index("a mere guess")
    gaining = replace(CHANGE, gains=(lacking.id,))
    claim = services.explanations.claim()
    assert claim is not None
    assert services.explanations.finish(claim, Explanation(changes=(gaining,), tried=1), 0.5)
    page = browser.get(address).text
    assert page.index(fact) < page.index("<summary>One more hint</summary>")
    assert "a mere guess" not in page


def test_a_stated_cause_is_told_beside_the_hint(
    browser: Browser, put: Callable[..., str], services: Services
) -> None:
    browser.get("/?lang=en")
    browser.enter(student="s1")
    address = put(b"good  # stated")
    claim = services.explanations.claim()
    assert claim is not None
    cause = StatedCause(code="never_true", line=3, text=Text(zh="第 3 行", en="Line 3 never ran"))
    assert services.explanations.finish(claim, Explanation(cause=cause), 0.1)
    part = browser.get(f"{address}/explanation").text
    assert "Line 3 never ran</p>" in part  # the file ends before it
    assert 'class="change"' not in part


def test_the_stream_tells_when_the_explanation_is_there(
    browser: Browser, put: Callable[..., str], services: Services
) -> None:
    browser.enter(student="s1")
    address = put(b"good  # streamed")
    with browser.client.stream("GET", f"{address}/explanation/events") as answer:
        data = (line for line in answer.iter_lines() if line.startswith("data:"))
        assert json.loads(next(data)[5:]) == {"open": True}
        assert explain(services)
        services.doorbell.ring()
        assert json.loads(next(data)[5:]) == {"open": False}
        assert next(data, None) is None  # it ends


def test_nothing_is_tried_for_full_marks(
    browser: Browser, put: Callable[..., str], services: Services
) -> None:
    browser.enter(student="s1")
    address = put(b"good", grading=full_marks)
    assert "data-address" not in browser.get(address).text
    assert_nothing_tried(browser.get(f"{address}/explanation").text)
    assert not explain(services)


def test_an_explanation_made_before_something_was_hidden_is_thrown_away(
    browser: Browser, put: Callable[..., str], services: Services, tokens: dict[str, str]
) -> None:
    browser.enter(token=tokens["li"])
    address = put(b"good  # hidden", student="li", course="ros")
    assert explain(services)
    assert "&lt;2&gt;" in browser.get(f"{address}/explanation").text
    signed = Signature(services.clock(), "ros", "wang")
    services.rules.set("square", Rules(hidden_items=("closed",)), signed)
    assert browser.get(f"{address}/explanation").status_code == 202
    assert explain(services, hidden=("closed",))
    assert "&lt;2&gt;" in browser.get(f"{address}/explanation").text


def test_that_only_what_is_hidden_lacks_marks_is_not_given_away(
    browser: Browser, put: Callable[..., str], services: Services, tokens: dict[str, str]
) -> None:
    address = put(b"good  # hidden", student="li", course="ros")
    lacking = [item.id for item in items_of(services, address) if item.earned < item.points]
    signed = Signature(services.clock(), "ros", "wang")
    services.rules.set("square", Rules(hidden_items=tuple(lacking)), signed)
    browser.enter(token=tokens["li"])
    page = browser.get(address).text
    assert "data-address" not in page
    assert_nothing_tried(browser.get(f"{address}/explanation").text)


def test_one_of_an_assignment_that_has_changed_is_not_told(
    browser: Browser, put: Callable[..., str], services: Services, monkeypatch: pytest.MonkeyPatch
) -> None:
    browser.enter(student="s1")
    address = put(b"good  # of before")
    assert explain(services)
    changed = [replace(one, version=one.version + 1) for one in services.assignments.all()]  # type: ignore[attr-defined]
    monkeypatch.setattr(services.assignments, "_all", changed)
    assert "data-address" not in browser.get(address).text
    assert_nothing_tried(browser.get(f"{address}/explanation").text)


def assert_nothing_tried(part: str) -> None:
    assert "data-looking" not in part
    assert 'class="change"' not in part


def items_of(services: Services, address: str) -> tuple[RubricItem, ...]:
    stored = services.submissions.report(address.rpartition("/")[2])
    assert stored is not None
    return report_from(stored.content).items


@pytest.mark.parametrize("level", [HintRule.FACT, HintRule.LINE, HintRule.CHANGE])
def test_students_are_told_as_much_as_the_rules_let_be_told(
    browser: Browser,
    put: Callable[..., str],
    services: Services,
    tokens: dict[str, str],
    level: HintRule,
) -> None:
    address = put(b"good  # told in part", student="li", course="ros", grading=guessed)
    signed = Signature(services.clock(), "ros", "wang")
    services.rules.set("square", Rules(hints=level), signed)
    browser.enter(token=tokens["li"])
    before = browser.get(address).text
    assert explain(services)
    part = browser.get(f"{address}/explanation").text
    said = browser.client.get(f"/api/v1{address}", headers={"Authorization": f"Bearer {tokens['li']}"}).text
    for text in (part, said):
        assert ("a &lt; 1" in text or "a < 1" in text) is (level is not HintRule.FACT)
        assert ("&lt;2&gt;" in text or "<2>" in text) is (level is HintRule.CHANGE)
    report = browser.client.get(
        f"/api/v1{address}/report", headers={"Authorization": f"Bearer {tokens['li']}"}
    ).text
    for text in (before, report):
        assert ("a mere guess" in text) is (level is HintRule.CHANGE)
    assert "a mere guess" not in browser.get(address).text  # what was tried is there now
    wang = {"Authorization": f"Bearer {tokens['wang']}"}
    assert "a mere guess" in browser.client.get(f"/api/v1{address}/report", headers=wang).text
    exported = browser.client.get(f"/class{address}/gradescope.json", headers=wang).text
    assert "a mere guess" not in exported


def guessed(job: GradingJob) -> GradingResult:
    result = grade(job)
    items = tuple(
        replace(item, hint=Text(zh="a mere guess", en="a mere guess")) if item.earned < item.points else item
        for item in result.report.items
    )
    return replace(result, report=replace(result.report, items=items, hint=items[-1].hint))
