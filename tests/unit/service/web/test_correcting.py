"""What the machine judged wrongly, corrected on the page of a submission."""

import re
from collections.abc import Callable
from html import unescape

import httpx
import pytest

from grader.contracts.rules import Corrector, Rules
from grader.store.audit import Signature
from grader.use_cases.services import Services
from tests.unit.service.web.conftest import Browser


@pytest.fixture
def driven(put: Callable[..., str], tokens: dict[str, str]) -> str:
    """Address of a submission by ``li`` of which the machine passed only the first item."""
    return put(b"good", student="li", course="ros")


@pytest.fixture
def wang(browser: Browser, tokens: dict[str, str], driven: str) -> Browser:
    browser.get("/?lang=en")
    browser.enter(token=tokens["wang"])
    return browser


def form(browser: Browser, page: str, number: int) -> dict[str, str]:
    """The hidden fields of the form at an item, counted from 1."""
    forms = re.findall(
        r'<form method="post" action="/class/judgements/.*?</form>', browser.get(page).text, re.S
    )
    fields = re.findall(r'<input type="hidden" name="(\w+)" value="([^"]*)"', forms[number - 1])
    return {name: unescape(value) for name, value in fields}


def test_an_instructor_corrects_and_the_student_reads_why(
    wang: Browser, driven: str, services: Services, tokens: dict[str, str]
) -> None:
    submission = driven.rpartition("/")[2]
    fields = form(wang, driven, 2)
    score = services.submissions.get(submission).score
    address = f"/class/judgements/{submission}"
    answer = wang.post(address, {**fields, "points": "2,5", "comment": "I saw <it>."}, page=driven)
    assert (answer.status_code, answer.headers["Location"]) == (303, driven)
    assert services.submissions.get(submission).score == score + 2.5
    again = wang.get(driven).text
    assert ">I saw &lt;it&gt;.</textarea>" in again
    history = wang.get(f"{address}?item={fields['item']}").text
    assert "The machine gave 0" in history
    assert 'name="then" value="result"' in history

    back = wang.post(address, {**form(wang, driven, 2), "points": "0", "comment": "no"}, page=driven)
    assert back.status_code == 303
    assert services.submissions.get(submission).score == score
    assert "count again" in wang.get(f"{address}?item={fields['item']}").text
    wang.post(address, {**form(wang, driven, 2), "points": "1", "comment": "I saw <it>."}, page=driven)

    wang.enter(token=tokens["li"])
    assert f'href="{driven}#source"' in wang.get("/").text  # announced as what staff wrote
    text = wang.get(driven).text
    assert "A teacher changed the points from 0 to 1: I saw &lt;it&gt;." in text
    assert "/class/judgements/" not in text


def test_a_missing_reason_is_told_at_the_field(wang: Browser, driven: str, services: Services) -> None:
    submission = driven.rpartition("/")[2]
    fields = form(wang, driven, 2)
    answer = wang.post(
        f"/class/judgements/{submission}", {**fields, "points": "3", "comment": " "}, page=driven
    )
    assert answer.status_code == 422
    assert 'id="comment-error"' in answer.text
    assert 'id="points" name="points" value="3"' in answer.text
    assert services.submissions.report(submission).judgements == ()


def test_assistants_correct_nothing(
    wang: Browser, driven: str, services: Services, tokens: dict[str, str]
) -> None:
    submission = driven.rpartition("/")[2]
    fields = form(wang, driven, 2)
    wang.enter(token=tokens["ta"])
    assert "/class/judgements/" not in wang.get(driven).text.replace('"/class/judgements"', "")
    address = f"/class/judgements/{submission}"
    assert wang.get(f"{address}?item={fields['item']}").status_code == 404
    assert wang.post(address, {**fields, "points": "3", "comment": "x"}, page=driven).status_code == 403
    assert services.submissions.report(submission).judgements == ()


def several(
    browser: Browser, driven: str, points: dict[str, str], reason: str = "I saw it."
) -> httpx.Response:
    """Send the form about all items with other `points` for some, in their order from 0."""
    page = f"/class/judgements/{driven.rpartition('/')[2]}/several"
    text = browser.get(page).text
    fields = {name: re.findall(f'name="{name}" value="([^"]*)"', text) for name in ("item", "seen", "points")}
    for number, typed in points.items():
        fields["points"][int(number)] = typed
    return browser.post(page, {**fields, "comment": reason}, page=page)


def test_several_items_are_corrected_with_one_reason_or_none(
    wang: Browser, driven: str, services: Services, tokens: dict[str, str]
) -> None:
    submission = driven.rpartition("/")[2]
    score = services.submissions.get(submission).score
    assert "Correct several items at once" in wang.get(driven).text
    for wrong, reason in (({"1": "2", "2": "999"}, "x"), ({"1": "2"}, " "), ({}, "x"), ({"1": "two"}, "x")):
        assert several(wang, driven, wrong, reason).status_code == 422
        assert services.submissions.report(submission).judgements == ()
    answer = several(wang, driven, {"1": "2,5", "2": "1"})
    assert (answer.status_code, answer.headers["Location"]) == (303, f"{driven}#items")
    assert {one.points for one in services.submissions.report(submission).judgements} == {2.5, 1.0}
    assert services.submissions.get(submission).score == score + 3.5


def test_assistants_correct_where_the_rules_allow_it(
    wang: Browser, driven: str, services: Services, tokens: dict[str, str]
) -> None:
    wang.enter(token=tokens["ta"])
    page = f"/class/judgements/{driven.rpartition('/')[2]}/several"
    assert wang.get(page).status_code == 403
    signed = Signature(services.clock(), "ros", "wang")
    services.rules.set("square", Rules(corrected_by=Corrector.STAFF), signed)
    assert several(wang, driven, {"1": "2"}).status_code == 303
