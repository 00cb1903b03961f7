"""No word may be missing in either language, and both must take the same values."""

from string import Formatter

import pytest

from grader.contracts.outcome import Note, RunStatus
from grader.contracts.report import GradeStatus
from grader.contracts.rubric import ItemStatus
from grader.contracts.submission import SubmissionState
from grader.render.labels import (
    GRADE_STATUS,
    ITEM_MARK,
    ITEM_STATUS,
    NOTES,
    RUN_STATUS,
    SUBMISSION_STATE,
    WORDS,
    note_sentence,
    word,
)

STATUSES = {
    repr(status): text
    for table in (ITEM_STATUS, GRADE_STATUS, RUN_STATUS, SUBMISSION_STATE)
    for status, text in table.items()
}
ALL = {**WORDS, **NOTES, **STATUSES}


def fields(sentence: str) -> set[str | None]:
    return {name for _, name, _, _ in Formatter().parse(sentence) if name is not None}


def test_both_languages_say_it() -> None:
    halves = {
        name: text
        for name, text in ALL.items()
        if not text.zh.strip() or not text.en.strip() or fields(text.zh) != fields(text.en)
    }
    assert halves == {}


def test_english_is_english() -> None:
    wide = {
        name: text.en for name, text in ALL.items() if any("\u3000" <= one <= "\uffef" for one in text.en)
    }
    assert wide == {}


def test_every_status_has_its_words() -> None:
    assert set(ITEM_STATUS) == set(ITEM_MARK) == set(ItemStatus)
    assert set(GRADE_STATUS) == set(GradeStatus)
    assert set(RUN_STATUS) == set(RunStatus)
    assert set(SUBMISSION_STATE) == set(SubmissionState)


def test_marks_differ_without_colour() -> None:
    assert len(set(ITEM_MARK.values())) == len(ItemStatus)


@pytest.mark.parametrize(
    ("note", "zh"),
    [
        (Note(code="wall", text="right"), "小车撞到了右墙"),
        (Note(code="type_mismatch", text="/turtle1/cmd_vel"), "/turtle1/cmd_vel 上的消息类型不对，连接不上"),
        (Note(code="forbidden", text="{0} {evil}"), "不允许的操作：{0} {evil}"),
        (Note(code="new_code", text="said so"), "said so"),
        (Note(code="new_code"), "new_code"),
    ],
)
def test_notes(note: Note, zh: str) -> None:
    assert note_sentence(note, "zh") == zh


def test_values_are_filled_in() -> None:
    assert word("gap", "en", length="0.29 m") == "gap 0.29 m"
    assert word("gap", "zh", length="0.29 m") == "缺口 0.29 m"
