"""Appeals on the pages: the student's, the queue of the staff, and the answer."""

import json
from collections.abc import Callable
from datetime import timedelta

import pytest

from grader.contracts.rules import Rules
from grader.store.audit import Signature
from grader.use_cases.services import Services
from tests.unit.service.web.conftest import Browser


@pytest.fixture
def driven(put: Callable[..., str], tokens: dict[str, str], services: Services, browser: Browser) -> str:
    """Address of a submission by ``li`` of which only the first item passed; appeals are taken for a day."""
    rules = Rules(appeals_until=services.clock() + timedelta(days=1))
    services.rules.set("square", rules, Signature(services.clock(), "ros", "wang"))
    browser.get("/?lang=en")
    return put(b"good", student="li", course="ros")


@pytest.fixture
def item(driven: str, services: Services) -> str:
    """The item that the student asks about."""
    report = services.submissions.report(driven.rpartition("/")[2])
    return next(part["id"] for part in json.loads(report.content)["items"] if part["earned"] == 0.0)


def ask(browser: Browser, driven: str, item: str, reason: str = "It <came> back.") -> int:
    return browser.post(f"{driven}/appeals", {"item": item, "reason": reason}, page=driven).status_code


def test_a_student_asks_and_is_told_the_answer(
    browser: Browser, driven: str, item: str, tokens: dict[str, str]
) -> None:
    browser.enter(token=tokens["li"])
    assert browser.get(driven).text.count(f'action="{driven}/appeals"') == 1  # of all items
    assert f'<option value="{item}">' in browser.get(driven).text
    assert "You can ask for another look until" in browser.get(driven).text
    assert ask(browser, driven, item) == 303
    assert "It &lt;came&gt; back." in browser.get(driven).text
    assert "Appeals waiting for an answer: 1" in browser.get("/").text

    browser.enter(token=tokens["ta"])
    assert "appeals waiting" in browser.get("/class").text
    queue = browser.get("/class/appeals").text
    assert "It &lt;came&gt; back." in queue
    assert f"/class/appeals/{driven.rpartition('/')[2]}?item={item}" in queue
    address = f"/class/appeals/{driven.rpartition('/')[2]}"
    form = browser.get(f"{address}?item={item}").text
    assert 'value="refused"' in form
    assert 'value="corrected"' not in form  # assistants correct where the rules say so
    wrong = browser.post(address, {"item": item, "text": " "}, page=f"{address}?item={item}")
    assert wrong.status_code == 422
    assert "Choose an answer." in wrong.text
    given = {"item": item, "decision": "refused", "text": "0.4 m beside."}
    assert browser.post(address, given, page=f"{address}?item={item}").status_code == 303
    assert "<td>refused<" in browser.get("/class/appeals?state=answered").text

    browser.enter(token=tokens["li"])
    assert "New answers to your appeals: 1" in browser.get("/").text
    text = browser.get(driven).text
    assert "0.4 m beside." in text
    assert f'name="item" value="{item}"' not in text
    assert "New answers" not in browser.get("/").text


def test_an_instructor_corrects_in_answer(
    browser: Browser, driven: str, item: str, tokens: dict[str, str], services: Services
) -> None:
    submission = driven.rpartition("/")[2]
    browser.enter(token=tokens["li"])
    ask(browser, driven, item)
    browser.enter(token=tokens["wang"])
    score = services.submissions.get(submission).score
    page = f"/class/appeals/{submission}?item={item}"
    seen = browser.get(page).text.partition('name="seen" value="')[2].partition('"')[0]
    given = {"item": item, "decision": "corrected", "text": "True.", "points": "1,5", "seen": seen}
    assert (
        browser.post(f"/class/appeals/{submission}", {**given, "points": "x"}, page=page).status_code == 422
    )
    assert browser.post(f"/class/appeals/{submission}", given, page=page).status_code == 303
    assert services.submissions.get(submission).score == score + 1.5


def test_a_student_takes_it_back(browser: Browser, driven: str, item: str, tokens: dict[str, str]) -> None:
    browser.enter(token=tokens["li"])
    ask(browser, driven, item)
    assert browser.post(f"{driven}/appeals/withdraw", {"item": item}, page=driven).status_code == 303
    assert "Appeals waiting" not in browser.get("/").text
    assert ask(browser, driven, item, "again") == 303


def test_an_assistant_passes_it_on(
    browser: Browser, driven: str, item: str, tokens: dict[str, str], services: Services
) -> None:
    submission = driven.rpartition("/")[2]
    address, page = f"/class/appeals/{submission}", f"/class/appeals/{submission}?item={item}"
    browser.enter(token=tokens["li"])
    ask(browser, driven, item)
    browser.enter(token=tokens["ta"])
    given = {"item": item, "decision": "passed_on", "text": "Is the <band> right?"}
    assert browser.post(address, {**given, "text": ""}, page=page).status_code == 422
    assert browser.post(address, given, page=page).headers["Location"] == "/class/appeals"
    browser.enter(token=tokens["li"])
    assert "band" not in browser.get(driven).text
    assert "Appeals waiting for an answer: 1" in browser.get("/").text
    browser.enter(token=tokens["wang"])
    assert "Passed on by ta" in browser.get("/class/appeals").text
    shown = browser.get(page).text
    assert "Is the &lt;band&gt; right?" in shown
    assert 'value="passed_on"' not in shown
    answer = {"item": item, "decision": "refused", "text": "It is."}
    assert browser.post(address, answer, page=page).status_code == 303
    (entry,) = [one for one in services.audit.entries("ros", 20) if one.action == "appeal.pass_on"]
    assert entry.actor == "ta"
