"""The published rubric names every item with its points and what it wants."""

import io
from dataclasses import replace

from grader.contracts.rubric import PublishedItem, PublishedRubric
from grader.contracts.text import Language
from grader.render.rubric import render_list, render_rubric
from grader.render.terminal import console
from tests.unit.render.samples import assignment, t

RUBRIC = PublishedRubric(
    assignment="square",
    title=t("正方形", "Square"),
    brief=t("让小车走一个正方形。", "Drive a square."),
    horizon_s=60.0,
    max_score=10.0,
    items=(
        PublishedItem(
            id="corners",
            title=t("外角 90°", "Exterior angles 90°"),
            points=2.5,
            measure=t("偏差最大的外角", "the angle furthest off"),
            wanted=t("90° ± 3°"),
            partial=t("[偏差 10° 起不得分]", "[nothing from 10° off]"),
            needs=t("先要通过:四条边", "needs: Four sides"),
        ),
    ),
    remarks=t("只看小车的运动。", "Only the motion counts."),
)


def shown(language: Language) -> str:
    stream = io.StringIO()
    console(stream, 100).print(render_rubric(assignment(), RUBRIC, language=language))
    return stream.getvalue()


def test_a_text_has_no_time_limit() -> None:
    stream = io.StringIO()
    text = replace(assignment(), input="text")
    console(stream, 100).print(render_rubric(text, RUBRIC, language="zh"))
    assert "满分 10" in stream.getvalue()
    assert "时限" not in stream.getvalue()
    assert "时限 60 虚拟秒" in shown("zh")


def test_another_release_than_humble_is_named() -> None:
    stream = io.StringIO()
    console(stream, 100).print(render_rubric(replace(assignment(), distro="jazzy"), RUBRIC, language="zh"))
    assert "ROS 2 Jazzy" in stream.getvalue()
    assert "ROS 2" not in shown("zh")


def test_everything_published_is_shown() -> None:
    text = shown("zh")
    for part in (
        "正方形",
        "square",
        "满分 10",
        "60 虚拟秒",
        "让小车走一个正方形。",
        "外角 90°",
        "2.5",
        "90° ± 3°",
    ):
        assert part in text
    for part in ("偏差最大的外角", "[偏差 10° 起不得分]", "先要通过:四条边", "只看小车的运动。"):
        assert part in text


def test_english_has_no_chinese() -> None:
    assert not [character for character in shown("en") if "\u3000" <= character <= "\uffef"]


def test_the_list_has_a_line_for_each_assignment() -> None:
    stream = io.StringIO()
    console(stream, 80).print(render_list([assignment()] * 3, language="zh"))
    assert stream.getvalue().count("正方形") == 3
    assert len([line for line in stream.getvalue().splitlines() if line.strip()]) == 2 + 3
    assert "分值" in stream.getvalue()
