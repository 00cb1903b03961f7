"""Every sentence that users see, in Chinese and English, from gettext files.

A message id names the place where a sentence is used (``polygon.sides.seen``). The sentences stand in
``<language>/LC_MESSAGES``: ``grader.po`` holds those of reports, terminals and plots, ``pages.po`` those of pages
and of HTTP's problem documents, which a grading never reads. ``python -m grader.messages.check`` finds what is
missing, unused or different between the languages.

The ``.po`` files are read as they stand. That takes 0.2 ms for one of 370 entries, half of what gettext takes for
a compiled ``.mo``, and there are no compiled copies to be kept in step.
"""

import re
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from string import Formatter
from typing import Final

from grader.contracts.text import LANGUAGES, Language, Text

FOLDER: Final = Path(__file__).parent
_FILES: Final = {"page": "pages", "problem": "pages"}  # by the first word of an id; any other: grader
_ENTRY: Final = re.compile(r'^msgid "(.+)"\nmsgstr "(.*)"$', re.MULTILINE)
_LIST_SEPARATOR: Final = Text(zh="、", en=", ")


class _Counting(Formatter):
    """Fills sentences in that say ``{count} {count:side|sides}``: one side, or several."""

    def format_field(self, value: object, format_spec: str) -> str:
        """Return the value, or which of two words goes with it."""
        one, bar, many = format_spec.partition("|")
        if bar:
            return one if str(value) == "1" else many
        return str(super().format_field(value, format_spec))


_COUNTING: Final = _Counting()


def _many(format_spec: str | None) -> str:
    """Return the word for several that a field chooses, nothing if it is an ordinary one."""
    return (format_spec or "").partition("|")[2]


class MissingMessageError(LookupError):
    """A message id has no sentence in one of the languages: a defect of the grader."""


def file_of(language: Language, name: str) -> Path:
    """Return the path of one of the files of sentences: ``grader`` or ``pages``."""
    return FOLDER / language / "LC_MESSAGES" / f"{name}.po"


@cache
def entries(language: Language, name: str) -> Mapping[str, str]:
    """Return id -> sentence of one file, whose entries have a line each for id and sentence."""
    found = dict(_ENTRY.findall(file_of(language, name).read_text(encoding="utf-8")))
    return {key: _unescaped(text) if "\\" in text else text for key, text in found.items()}


def template(language: Language, message_id: str, /) -> str | None:
    """Return a sentence with its fields in braces, None when there is no such id."""
    name = _FILES.get(message_id.partition(".")[0], "grader")
    return entries(language, name).get(message_id)


def sentence(language: Language, message_id: str, /, **values: object) -> str:
    """Return one sentence with `values` filled in.

    Raises MissingMessageError: there is no such id in `language`.
    """
    text = template(language, message_id)
    if text is None:
        raise MissingMessageError(f"{language}: no message {message_id!r}")
    said = {name: _in(language, value) for name, value in values.items()}
    return _COUNTING.vformat(text, (), said) if "|" in text else text.format(**said)


def outline(language: Language, message_id: str) -> str | None:
    """Return a sentence with each of its fields as ``…``, or None when there is no such id."""
    text = template(language, message_id)
    if text is None:
        return None
    parts = Formatter().parse(text)
    return "".join(before + ("" if field is None else _many(spec) or "…") for before, field, spec, _ in parts)


def say(message_id: str, /, **values: object) -> Text:
    """Return a sentence in both languages; a value that is a `Text` is inserted in the language at hand."""
    zh, en = (sentence(language, message_id, **values) for language in LANGUAGES)
    return Text(zh=zh, en=en)


def on_page(language: Language, key: str, /, **values: object) -> str:
    """Return the sentence ``page.<key>`` with `values` filled in, not yet escaped.

    A word that stands in reports, too, is ``word.<key>``. Without values the fields stay in their braces: the
    pages' scripts fill some of them in.

    Raises MissingMessageError: there is no such sentence: a defect of the page.
    """
    message_id = f"page.{key}" if template(language, f"page.{key}") is not None else f"word.{key}"
    if values:
        return sentence(language, message_id, **values)
    text = template(language, message_id)
    if text is None:
        raise MissingMessageError(f"{language}: no message {key!r} of a page")
    return text


def is_on_page(key: str) -> bool:
    """Whether the pages have such a sentence or word."""
    return any(template("en", f"{kind}.{key}") is not None for kind in ("page", "word"))


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


def _unescaped(text: str) -> str:
    return re.sub(r"\\(.)", lambda found: {"n": "\n", "t": "\t"}.get(found[1], found[1]), text)
