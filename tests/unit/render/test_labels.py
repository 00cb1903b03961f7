"""Statuses, marks and notes have their words."""

import re
from pathlib import Path

import pytest

import grader
from grader.contracts.outcome import Note, RunStatus, StudentError
from grader.contracts.report import GradeStatus
from grader.contracts.rubric import ItemStatus
from grader.contracts.submission import SubmissionState
from grader.contracts.text import LANGUAGES, Language
from grader.render.labels import (
    ITEM_MARK,
    cleanup_sentence,
    item_status_word,
    note_sentence,
    status_word,
    word,
)
from grader.sim.frames import INTERRUPTED_NOTE, STARTED_NOTE, THREADS_NOTE


@pytest.mark.parametrize("language", LANGUAGES)
def test_every_status_has_its_words(language: Language) -> None:
    assert set(ITEM_MARK) == set(ItemStatus)
    assert all(item_status_word(status, language) for status in ItemStatus)
    assert all(status_word(each, language) for each in (*GradeStatus, *RunStatus, *SubmissionState))
    assert status_word(RunStatus.CRASHED, "en") == "the script crashed"


def test_marks_differ_without_colour() -> None:
    assert len(set(ITEM_MARK.values())) == len(ItemStatus)


@pytest.mark.parametrize(
    ("note", "zh"),
    [
        (
            Note(code="wall", text="right"),
            "小车撞到了右墙（评分项里有“碰撞”时才扣分）",
        ),
        (
            Note(code="type_mismatch", text="/turtle1/cmd_vel"),
            "/turtle1/cmd_vel 上的消息类型不对，连接不上：检查 import 和创建时的第一个参数",
        ),
        (Note(code="forbidden", text="{0} {evil}"), "不允许的操作：{0} {evil}"),
        (
            Note(code="counted_commanded", text="8.35 m|381.4°|8 m|362.1°"),
            "在你自己的 turtlesim 上，小乌龟一共走 8.35 m、转 381.4°；按你的命令应该是 8 m 和 362.1°。"
            "这次按命令的运动（虚线）给分",
        ),
        (Note(code="new_code", text="said so"), "said so"),
        (Note(code="new_code"), "new_code"),
    ],
)
def test_notes(note: Note, zh: str) -> None:
    assert note_sentence(note, "zh") == zh


@pytest.mark.parametrize("language", LANGUAGES)
def test_every_note_that_the_shim_and_the_episode_make_has_its_words(language: Language) -> None:
    root = Path(grader.__file__).parent
    sources = [path.read_text() for part in ("shim", "sim") for path in (root / part).rglob("*.py")]
    made = {code for text in sources for code in re.findall(r'\bnote(?:_once)?\(\s*"(\w+)"', text)}
    unseen = {INTERRUPTED_NOTE, STARTED_NOTE, THREADS_NOTE}
    assert {code for code in made if note_sentence(Note(code=code), language) == code} == unseen


def test_values_are_filled_in() -> None:
    assert word("gap", "en", length="0.29 m") == "gap 0.29 m"
    assert word("gap", "zh", length="0.29 m") == "缺口 0.29 m"


def test_the_lessons_own_ending_does_not_frighten() -> None:
    twice = StudentError(
        type="RCLError", message="failed to shutdown: rcl_shutdown already called", line=53, traceback=""
    )
    assert cleanup_sentence(twice, "RCLError", "en").startswith("nothing to be done")
    chinese = cleanup_sentence(twice, "RCLError: failed to shutdown", "zh")
    assert chinese.startswith("不用处理")
    assert "（第 53 行）" in chinese
    assert "failed to shutdown" not in chinese  # their own script's only English sentence, of no use to them
    other = StudentError(type="ValueError", message="?", line=3, traceback="")
    assert "mend that line" in cleanup_sentence(other, "ValueError", "en")
