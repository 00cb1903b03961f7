"""Both languages are complete, and the switch is remembered."""

import re
from pathlib import Path

import pytest

from grader.service.web.pages import FOLDER
from tests.unit.service.web.conftest import Browser

TEMPLATES = sorted((FOLDER / "templates").glob("*.html"))


@pytest.mark.parametrize("path", TEMPLATES, ids=lambda path: path.name)
def test_templates_hold_no_words_of_their_own(path: Path) -> None:
    text = re.sub(r"\{%.*?%\}|\{\{.*?\}\}", " ", path.read_text(), flags=re.DOTALL)
    text = re.sub(r"<[^>]*>|&\w+;|[\w-]+=\"[^\"]*\"", " ", text)
    alone = {
        "UTC",
        "A",
        "B",
        "s",
        "instance",
        "grader",
        "n",
        "x",
        "Gradescope",
        "PrairieLearn",
        "JSON",
        "course",
        "create",
        "ros",
        "instructor",
        "wang",
        "roster",
        "class",
        "csv",
    }
    assert set(re.findall(r"[^\W\d_]+", text)) <= alone


def test_scripts_hold_no_words_of_their_own() -> None:
    for path in (FOLDER / "static").glob("*.js"):
        assert not re.search(r"[\u4e00-\u9fff]", path.read_text()), path.name


def test_chinese_is_the_default(browser: Browser) -> None:
    answer = browser.client.get("/", headers={"Accept": "text/html", "Accept-Language": "en-US"})
    assert '<html lang="zh-CN">' in answer.text
    assert answer.headers["content-language"] == "zh-CN"


def test_the_switch_is_remembered(browser: Browser) -> None:
    chosen = browser.get("/?lang=en")
    assert '<html lang="en">' in chosen.text
    assert "grader_language=en" in chosen.headers["set-cookie"]
    assert '<html lang="en">' in browser.get("/assignments/square").text
    assert '<html lang="zh-CN">' in browser.get("/?lang=zh").text
    assert '<html lang="zh-CN">' in browser.get("/").text


def test_the_switch_keeps_the_view(instructor: Browser) -> None:
    assert (
        'href="/evil.example/x?lang=en"'
        in instructor.get(f"{instructor.client.base_url}//evil.example/x").text
    )
    assert 'href="/class?show=stuck&amp;lang=en"' in instructor.get("/class?show=stuck").text


def test_an_unknown_language_changes_nothing(browser: Browser) -> None:
    answer = browser.get("/?lang=xx")
    assert '<html lang="zh-CN">' in answer.text


def test_problems_speak_the_pages_language(browser: Browser) -> None:
    browser.get("/?lang=en")
    assert "There is nothing at this address" in browser.get("/nothing").text
    assert "There is no such assignment" in browser.get("/assignments/nothing").text


def test_what_a_page_sends_itself_is_refused_in_its_language(
    browser: Browser, tokens: dict[str, str]
) -> None:
    browser.enter(token=tokens["li"])
    for page, where in (
        ("/playground", 'id="start" method="post" action="([^"]*)"'),
        ("/assignments/square/practice", 'data-run="([^"]*)"'),
    ):
        (address,) = re.findall(where, browser.get(page).text)
        headers = {"Accept": "application/json", "Accept-Language": "en"}
        refused = browser.client.post(address, files={"form_token": (None, "x")}, headers=headers)
        assert (refused.status_code, refused.json()["title"]) == (403, "这个表单已经失效"), page
