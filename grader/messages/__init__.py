"""Sentences for students in Chinese and English, from gettext catalogs.

Message ids name the place a sentence is used (``polygon.sides.seen``); the sentences stand in
``zh/LC_MESSAGES/grader.po`` and ``en/LC_MESSAGES/grader.po``, edited by hand. ``python -m
grader.messages.compile`` (needs Babel) writes the ``.mo`` files read here; a test keeps the two in step.
"""

import gettext
from functools import cache
from pathlib import Path
from string import Formatter

from grader.contracts.text import LANGUAGES, Language, Text

DOMAIN = "grader"
FOLDER = Path(__file__).parent
_LIST_SEPARATOR = Text(zh="、", en=", ")


class MissingMessageError(LookupError):
    """A message id has no sentence in one of the languages: a defect of the grader."""


@cache
def _catalog(language: Language) -> gettext.NullTranslations:
    path = FOLDER / language / "LC_MESSAGES" / f"{DOMAIN}.mo"
    with path.open("rb") as file:
        return gettext.GNUTranslations(file)


def sentence(language: Language, message_id: str, /, **values: object) -> str:
    """Return one sentence with `values` filled in.

    Raises:
        MissingMessageError: the catalog of `language` does not have the id.
    """
    template = _catalog(language).gettext(message_id)
    if template == message_id:
        raise MissingMessageError(f"{language}: no message {message_id!r}")
    return template.format(**{name: _in(language, value) for name, value in values.items()})


def outline(language: Language, message_id: str) -> str | None:
    """Return a sentence with each of its fields as ``…``, or None when the catalog does not have the id."""
    template = _catalog(language).gettext(message_id)
    if template == message_id:
        return None
    return "".join(text + ("" if field is None else "…") for text, field, _, _ in Formatter().parse(template))


def say(message_id: str, /, **values: object) -> Text:
    """Return a sentence in both languages; a value that is a `Text` is inserted in the language at hand."""
    zh, en = (sentence(language, message_id, **values) for language in LANGUAGES)
    return Text(zh=zh, en=en)


def join(parts: list[Text], separator: Text) -> Text:
    """Join sentences or phrases in both languages."""
    return Text(
        zh=separator.zh.join(part.zh for part in parts), en=separator.en.join(part.en for part in parts)
    )


def enumerated(parts: list[Text]) -> Text:
    """Return a list of phrases as it stands in a sentence."""
    return join(parts, _LIST_SEPARATOR)


def _in(language: Language, value: object) -> object:
    return value.get(language) if isinstance(value, Text) else value
