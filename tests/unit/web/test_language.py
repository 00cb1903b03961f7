"""Both languages are complete, and the switch is remembered."""

import re
from pathlib import Path
from string import Formatter

import pytest

from grader.contracts.identity import Role
from grader.contracts.text import LANGUAGES
from grader.web import words
from grader.web.audit_lines import _UNITS, ACTIONS, FIELDS, KINDS
from grader.web.matrix import SHOWS
from grader.web.pages import FOLDER
from grader.web.regrade_table import PARTS
from grader.web.regrading import WHICH
from grader.web.rule_pages import COUNTS, LATE_KINDS
from grader.web.submission import _REPLAY_WORDS
from tests.unit.web.conftest import Browser

TEMPLATES = sorted((FOLDER / "templates").glob("*.html"))
_SAID = re.compile(r"""\bsay\(\s*["']([a-z_.]+)["']\s*[,)]""")
BUILT = {
    *(f"class.show.{one}" for one in SHOWS),
    *(f"replay.{one}" for one in _REPLAY_WORDS),
    *(f"regrade.which.{one}" for one in WHICH),
    *(f"regrade.part.{one}" for one in PARTS),
    *(f"rules.late.{one}" for one in LATE_KINDS),
    "rules.late_short.none", "rules.late_short.steps",
    *(f"rules.counts.{one}" for one in COUNTS),
    *(f"people.role.{one}" for one in Role),
    *(f"audit.action.{one}" for one in ACTIONS),
    *(f"audit.kind.{one}" for one in KINDS),
    *FIELDS.values(),
    *(key for _, key in _UNITS),
    "figure.side", "figure.corner", "figure.gap",
}  # fmt: skip


def fields(text: str) -> set[str]:
    return {name for _, name, _, _ in Formatter().parse(text) if name}


def test_every_entry_is_complete() -> None:
    incomplete = {
        key: entry
        for key, entry in words.table().items()
        if set(entry) != set(LANGUAGES)
        or not all(text.strip() for text in entry.values())
        or len({frozenset(fields(text)) for text in entry.values()}) != 1
    }
    assert incomplete == {}


def test_no_word_is_missing_and_none_is_left_over() -> None:
    sources = [*TEMPLATES, *FOLDER.glob("*.py")]
    said = {key for path in sources for key in _SAID.findall(path.read_text())}
    refused = set(re.findall(r'"(rules\.error\.\w+)"', (FOLDER / "rule_form.py").read_text()))
    refused |= {f"judge.error.{one}" for one in ("points", "comment", "reason", "same", "meanwhile")}
    counted = {"rules.error.count_from_0", "rules.error.count_from_1"}
    assert said | BUILT | refused | counted | {"rules.error.student"} == set(words.table())


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
    assert 'href="/class?show=stuck&amp;lang=en"' in instructor.get("/class?show=stuck").text


def test_an_unknown_language_changes_nothing(browser: Browser) -> None:
    answer = browser.get("/?lang=xx")
    assert '<html lang="zh-CN">' in answer.text


def test_problems_speak_the_pages_language(browser: Browser) -> None:
    browser.get("/?lang=en")
    assert "There is nothing at this address" in browser.get("/nothing").text
    assert "There is no such assignment" in browser.get("/assignments/nothing").text
