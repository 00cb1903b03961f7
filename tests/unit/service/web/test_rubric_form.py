"""The rubric of an assignment as a form."""

import re
from html import unescape

import pytest

from grader.catalog import Catalog
from grader.use_cases.services import Services
from tests.unit.service.web.conftest import Browser

PAGE = "/class/rubric/square"
COLUMNS = ("title_zh", "title_en", "points", "low", "high", "ramp")


@pytest.fixture
def wang(browser: Browser, tokens: dict[str, str]) -> Browser:
    browser.enter(token=tokens["wang"])
    return browser


@pytest.fixture
def typed(wang: Browser) -> dict[str, list[str]]:
    """What the form has: the rubric as it is."""
    shown = wang.get(PAGE).text
    columns = {
        name: [unescape(one) for one in re.findall(rf'<input name="{name}" value="([^"]*)"', shown)]
        for name in COLUMNS
    }
    return {**columns, "brief_zh": ["走正方形"], "brief_en": ["Drive a square"]}


def test_the_form_has_the_rubric(typed: dict[str, list[str]]) -> None:
    items = Catalog().get("square").items
    assert [float(one) for one in typed["points"]] == [item.points for item in items]
    assert [one and float(one) for one in typed["high"]] == [
        "" if item.high is None else item.high for item in items
    ]
    assert typed["title_zh"] == [item.title.zh for item in items]


def test_a_change_waits_to_be_examined(
    wang: Browser, typed: dict[str, list[str]], services: Services
) -> None:
    typed["points"][0], typed["points"][1] = "10", "10"
    answer = wang.post(PAGE, typed, page=PAGE)
    assert (answer.status_code, answer.headers["Location"]) == (303, "/class/own?done=uploaded")
    (upload,) = services.own_assignments.of("ros")
    assert (upload.assignment, upload.version) == ("square", Catalog().get("square").version + 1)
    assert "版本" in wang.get("/class/regrades").text
    early = wang.post("/class/regrades", {"assignment": "square", "which": "all"}, page="/class/regrades")
    assert (early.status_code, "新版本正在检查" in early.text) == (422, True)


@pytest.mark.parametrize(
    ("column", "value", "told"),
    [("points", "many", "items.1.points"), ("low", "nan", "items.1.low"), ("points", "0", "items.1.points")],
)
def test_a_wrong_value_is_named_and_what_was_typed_stays(
    wang: Browser, typed: dict[str, list[str]], column: str, value: str, told: str
) -> None:
    typed[column][1] = value
    answer = wang.post(PAGE, typed, page=PAGE)
    assert answer.status_code == 422
    assert told in answer.text
    assert f'<input name="{column}" value="{value}"' in answer.text
