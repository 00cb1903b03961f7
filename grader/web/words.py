"""The pages' own words in both languages, from ``words.toml``."""

import tomllib
from functools import cache
from pathlib import Path

from grader.contracts.text import Language

_PATH = Path(__file__).with_name("words.toml")


@cache
def table() -> dict[str, dict[str, str]]:
    """Return every entry: key to language to text with fields in braces."""
    return tomllib.loads(_PATH.read_text(encoding="utf-8"))


def say(key: str, language: Language, /, **values: object) -> str:
    """Return one entry in `language`, its fields filled in, not yet escaped.

    Raises:
        KeyError: there is no such entry: a defect of the page.
    """
    text = table()[key][language]
    return text.format(**values) if values else text
