"""Labels, statuses and notes as terminals, plots and pages show them."""

from collections.abc import Mapping
from typing import Final

from grader.contracts.outcome import Note, RunStatus, StudentError
from grader.contracts.rubric import ItemStatus
from grader.contracts.text import Language
from grader.messages import sentence, template
from grader.messages.details import explained

ITEM_MARK: Final[Mapping[ItemStatus, str]] = {
    ItemStatus.PASSED: "✓",
    ItemStatus.PARTIAL: "~",
    ItemStatus.FAILED: "✗",
    ItemStatus.NOT_CHECKED: "-",
    ItemStatus.NEEDS_MANUAL: "…",
}
"""Readable without colour."""


def word(key: str, language: Language, **values: object) -> str:
    """Return one of the labels in `language`, its fields filled in."""
    return sentence(language, f"word.{key}", **values)


def cleanup_sentence(error: StudentError, shown: str, language: Language) -> str:
    """Return what an exception after Ctrl+C means, and whether anything is to be done; `shown` names it."""
    if "rcl_shutdown already called" in error.message:
        where = word("at_line", language, line=error.line) if error.line else ""
        return word("cleanup_shutdown", language, where=where)
    return word("cleanup_error", language, error=shown)


def status_word(status: str, language: Language) -> str:
    """Return the word for a `GradeStatus`, a `RunStatus` or the state of a submission."""
    return sentence(language, f"status.{status}")


def item_status_word(status: ItemStatus, language: Language) -> str:
    """Return the word for the status of a rubric item."""
    return sentence(language, f"item_status.{status}")


def wall_word(wall: str, language: Language) -> str | None:
    """Return the name of a wall, None when there is no such wall."""
    return template(language, f"at_wall.{wall}")


def note_sentence(note: Note, language: Language) -> str:
    """Return what a note says; its raw text, not yet escaped, when the code is not known."""
    wording = template(language, f"note.{note.code}")
    if wording is None:
        return note.text or note.code
    text = note.text
    if note.code == "wall":
        text = wall_word(text, language) or text
    elif note.code == "forbidden":
        text = explained(RunStatus.FORBIDDEN, text).get(language)
    first, _, second = text.partition("|")
    if note.code.startswith("counted_"):
        first, second, third, fourth = text.split("|")
        return wording.format(first=first, second=second, third=third, fourth=fourth)
    return wording.format(text=text, first=first, second=second)
