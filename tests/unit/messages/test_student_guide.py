"""The guide for students quotes hints that exist, and its commands can be typed."""

import re
import shlex
from importlib import import_module
from pathlib import Path

import pytest

from grader.commands.cli import Parser
from grader.contracts.text import Language
from grader.messages import entries, outline

DOCS = Path(__file__).resolve().parents[3] / "docs"
PAGES: dict[Language, Path] = {"zh": DOCS / "student.zh.md", "en": DOCS / "student.md"}
HINTS: dict[Language, dict[str, str]] = {
    language: {
        key: outline(language, key) or ""
        for key in entries(language, "grader")
        if key.startswith(("mistake.", "cause.")) or key.endswith(".hint")
    }
    for language in PAGES
}


def rows(page: Path) -> list[str]:
    return [
        line.split("|")[1].strip()
        for line in page.read_text(encoding="utf-8").splitlines()
        if line[:2] == "| "
    ][1:]


@pytest.mark.parametrize("language", PAGES)
def test_every_quoted_hint_exists(language: Language) -> None:
    quoted = rows(PAGES[language])
    assert len(quoted) == len(set(quoted)) == 20
    for quote in quoted:
        assert sum(hint.startswith(quote) for hint in HINTS[language].values()) == 1, quote


def test_both_languages_quote_the_same_hints_in_the_same_order() -> None:
    keys = {
        language: [
            next(key for key, hint in HINTS[language].items() if hint.startswith(quote))
            for quote in rows(page)
        ]
        for language, page in PAGES.items()
    }
    assert keys["zh"] == keys["en"]


@pytest.mark.parametrize("page", PAGES.values(), ids=lambda page: page.name)
def test_every_command_can_be_typed(page: Path) -> None:
    pytest.importorskip("httpx")  # of `grader submit`
    text = page.read_text(encoding="utf-8")
    typed = re.findall(r"^    (grader .*?)(?:  +#.*)?$", text, re.MULTILINE)
    typed += re.findall(r"`(grader [^`>]*?)(?: >[^`]*)?`", text)
    commands = [words[1:] for line in typed if len(words := shlex.split(line)) > 2 and words[1] != "ch"]
    assert len(commands) >= 8
    for name, *arguments in commands:
        module = import_module(f"grader.commands.{name}")
        parser = Parser(prog=name)
        module.configure(parser)
        parser.parse_args(arguments)
