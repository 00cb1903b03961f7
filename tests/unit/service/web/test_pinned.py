"""A sentence pinned to a mistake: its form, who reads it, grading again from there."""

from collections.abc import Callable
from dataclasses import replace

import httpx

from grader.contracts.grading import GradingJob, GradingResult
from tests.fakes.grading import grade
from tests.unit.service.web.conftest import Browser

CODE = "rate_off"
MADE = f"/class/assignments/square/students?mistake={CODE}"
PIN = "/class/assignments/square/pinned"


def mistaken(job: GradingJob) -> GradingResult:
    result = grade(job)
    return replace(result, report=replace(result.report, mistakes=(CODE,)))


def test_whoever_makes_the_mistake_reads_it_above_the_hint(
    browser: Browser, put: Callable[..., str], tokens: dict[str, str]
) -> None:
    made = put(b"good one", student="li", course="ros", grading=mistaken)
    other = put(b"good two", student="han", course="ros")
    browser.get("/?lang=en")
    browser.enter(token=tokens["wang"])
    assert browser.post(PIN, {"mistake": CODE, "text": " Look at <line> 3.\n"}, page=MADE).status_code == 303
    page = browser.get(MADE).text
    assert 'value="Look at &lt;line&gt; 3."' in page
    assert "Your teacher says: Look at &lt;line&gt; 3." in page  # so it was saved
    assert '<input type="hidden" name="students" value="li">' in page
    assert "li</textarea>" in browser.get("/class/regrades?assignment=square&students=li").text
    assert browser.post(PIN, {"mistake": "none", "text": "x"}, page=MADE).status_code == 422
    browser.enter(token=tokens["ta"])
    assert "Your teacher says: Look at" in browser.get(MADE).text
    browser.enter(token=tokens["li"])
    told = browser.get(made).text
    assert told.index("Look at &lt;line&gt; 3.") < told.index('id="explanation"')
    browser.enter(token=tokens["han"])
    assert "Look at" not in browser.get(other).text


def test_an_empty_one_is_taken_away(client: httpx.Client, tokens: dict[str, str]) -> None:
    headers = {"Authorization": f"Bearer {tokens['wang']}"}
    address = "/api/v1/assignments/square/pinned"
    client.put(f"{address}/{CODE}", headers=headers, json={"text": "Once."})
    assert client.get(address, headers=headers).json() == {"pinned": {CODE: "Once."}}
    assert client.put(f"{address}/{CODE}", headers=headers, json={"text": " "}).json() == {"pinned": {}}
    refused = client.put(f"{address}/{CODE}", headers=headers, json={"text": "x" * 501})
    assert refused.status_code == 422
