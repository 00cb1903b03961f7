"""Checks of handed-in texts: numbers with units, and essays for a person to grade."""

import math
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from grader.checks import evaluate, evaluate_text, problems, published_rubric
from grader.checks.kinds.number import given_answers
from grader.checks.summary import summarise
from grader.contracts.errors import AssignmentError
from grader.contracts.rubric import ItemStatus, RubricItem
from grader.contracts.text import EMPTY
from grader.messages.quantity import quantities
from tests.unit.checks.shipped import assignment, item, score
from tests.unit.checks.trajectories import drive, run_of

TASK = assignment("calculation")


@pytest.mark.parametrize(
    "text",
    [
        "12 s",
        "12秒",
        "12.0 seconds\n",
        "4×3÷1=12 秒钟",
        "答：大约 12 Sec.",
        "１２ 秒",
        "0.2 分钟",
        "12 (s)",
        "边长 3 m，速度 1 m/s：12 s，要转 4 次弯",
        "18.3 s",
        "18.28秒",
        "12 s (4 sides, 3 s each)",
        "12 s ± 0.1 s",
        "12±0.5s",
        "总时间为12秒，其中每边3秒。",
        "答：18.28 秒。其中直行 12 秒，转弯 6.28 秒。",
        "18.28 s = 12 s + 4 × 1.57 s",
        "3 s per side, 12 s in all",
        "16.7 s",
        "12 s，加上转弯共 18.3 s",
        "12,0 s",
        "18,28秒",
        "每条边 3，12 秒",
        "4 条边,12 s, 不含转弯",
        "十二秒",
        "一共十二秒钟",
        "答：十八点二八秒",
        "共要一二秒",
        "twelve seconds",
        "零点二分钟",
        "每条边三秒，四条边共十二秒",
        "每边 3 秒，12 秒",
        "12 s，加上转弯也可能算 18.28 s",
        "12 s or 18.28 s",
    ],
)
def test_right_answers(text: str) -> None:
    scoring = evaluate_text(TASK, text)
    assert score(scoring) == 100, scoring
    assert scoring.mistakes == ()


@pytest.mark.parametrize(
    ("text", "points", "mistakes"),
    [
        ("12", 80, ()),
        ("3 s", 20, ("known_wrong_answer",)),
        ("9 s", 20, ("known_wrong_answer",)),
        ("3 s for each side, 9 s for three", 20, ("known_wrong_answer",)),
        ("9 s, since 12 s is too much and 3 s too little", 20, ("known_wrong_answer",)),
        ("14.28 s", 20, ("known_wrong_answer",)),
        ("13 s", 20, ()),
        ("12 m", 0, ("other_unit",)),
        ("12 m/s", 0, ("other_unit",)),
        ("面积是9平方米", 0, ("other_unit",)),
        ("9 m²", 0, ("other_unit",)),
        ("一共要一百二十秒", 20, ()),
        ("12 s (if the turns are not counted)\n... it may also be 9 s", 20, ("known_wrong_answer",)),
        ("9 s，也可能是 12 s", 20, ("known_wrong_answer",)),
        ("9 s or 12 s", 20, ("known_wrong_answer",)),
        ("9 秒、12 秒", 20, ("known_wrong_answer",)),
        ("9 秒 12 秒", 20, ("known_wrong_answer",)),
        ("", 0, ("no_number",)),
        ("nan s inf s 1e309 s", 0, ()),
        ("12 s 13 s", 20, ()),
        ("12 s or 13 s", 20, ()),
        ("12 s，或者 13 s", 20, ()),
        ("12 s + 1 s = 13 s", 20, ()),
        ("12 s × 4 = 48 s", 20, ("known_wrong_answer",)),
    ],
)
def test_wrong_answers(text: str, points: float, mistakes: tuple[str, ...]) -> None:
    scoring = evaluate_text(TASK, text)
    assert score(scoring) == points, scoring
    assert scoring.mistakes == mistakes
    assert scoring.hint.zh


def test_the_known_answer_is_explained() -> None:
    assert "12 s" in item(evaluate_text(TASK, "18.3 s"), "answer").message.zh
    assert "4 条边" in evaluate_text(TASK, "3 s").hint.zh


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("12,0", [12.0]),
        ("-0,283 m", [-0.283]),
        ("1,2e1 s", [12.0]),
        ("1,200 s", [1200.0]),
        ("1,234,567.5 m", [1_234_567.5]),
        ("1,2,3 s", [1.0, 2.0, 3.0]),
        ("1, 2", [1.0, 2.0]),
        ("3，12 s", [3.0, 12.0]),
        ("12,18.28 s", [12.0, 18.28]),
        ("12,", [12.0]),
    ],
)
def test_commas_in_and_between_numbers(text: str, values: list[float]) -> None:
    assert [each.value for each in quantities(text)] == values


def test_a_quantity_in_a_fitting_unit_is_preferred_to_a_later_number() -> None:
    given = given_answers("12 s after 4 turns of 90°", "s")[0]
    assert given is not None
    assert (given.value, given.unit) == (12.0, "s")


@given(st.text())
def test_any_text_is_read(text: str) -> None:
    assert all(math.isfinite(each.value) for each in quantities(text))
    scoring = evaluate_text(TASK, text)
    assert 0 <= score(scoring) <= 100


@given(st.floats(-1e6, 1e6), st.sampled_from(["s", "秒", "m", "度", "rad/s", "m/s", "cm", ""]))
def test_a_number_and_its_unit_are_found(value: float, unit: str) -> None:
    (found,) = quantities(f"答案是 {value:.6f} {unit}。")
    assert found.value == pytest.approx(value, abs=1e-6)
    assert bool(found.unit) is bool(unit)


def test_conversions() -> None:
    (minutes,), (centimetres,), (degrees,) = (list(quantities(text)) for text in ("2 min", "50 cm", "180°"))
    assert minutes.in_unit("s") == 120.0
    assert centimetres.in_unit("m") == 0.5
    assert degrees.in_unit("rad") == pytest.approx(math.pi)
    assert degrees.in_unit("s") is None


def test_an_essay_waits_for_a_person() -> None:
    task = assignment("theory_publisher_timer")
    scoring = evaluate_text(
        task, "create_publisher 创建发布者，create_timer 创建定时器，周期性地调用回调函数。"
    )
    assert item(scoring, "written").status is ItemStatus.PASSED
    assert item(scoring, "publisher").status is ItemStatus.NEEDS_MANUAL
    assert item(scoring, "publisher").earned == 0
    assert "等待人工评分" in scoring.summary.zh
    assert scoring.hint.zh == ""
    short = evaluate_text(task, "发消息。")
    assert "太短" in short.hint.zh
    assert item(short, "publisher").status is ItemStatus.NOT_CHECKED  # nobody has to read it


def test_what_a_person_judges_is_published() -> None:
    items = {each.id: each for each in published_rubric(assignment("theory_publisher_timer")).items}
    assert items["publisher"].wanted.zh == "由人工评分"
    assert items["publisher"].needs.en


def test_scripts_and_texts_are_not_mixed_up() -> None:
    with pytest.raises(AssignmentError, match="scores scripts"):
        evaluate_text(assignment("square"), "12 s")
    with pytest.raises(AssignmentError, match="scores texts"):
        evaluate(TASK, [run_of(drive([]))])
    assert "input: text" in dict(problems(replace(TASK, input="script")))["input"].en


def test_a_question_needs_a_right_answer_and_a_known_unit() -> None:
    wrong = tuple(answer for answer in TASK.answers if not answer.right)
    assert "right" in dict(problems(replace(TASK, answers=wrong)))["answers"].en
    assert "options.unit" in dict(problems(replace(TASK, options={"unit": "furlong"})))
    assert "answers" in dict(problems(replace(assignment("square"), answers=wrong)))


@pytest.mark.parametrize("text", ["答案是12秒", "１２秒", "总时间为12s。", "时间＝１２ 秒", "第1题：12秒"])
def test_a_number_needs_no_space_before_or_behind_it(text: str) -> None:
    given = given_answers(text, "s")[0]
    assert (given.value, given.unit) == (12.0, "s")


def test_no_score_is_told_while_something_waits_for_a_person() -> None:
    failed, waits = (
        RubricItem(id=one, title=EMPTY, points=50.0, earned=0.0, status=one)
        for one in (ItemStatus.FAILED, ItemStatus.NEEDS_MANUAL)
    )
    assert "0/100" in summarise([failed, replace(waits, status=ItemStatus.FAILED)], [], []).summary.en
    assert "0/100" not in summarise([failed, waits], [], []).summary.en
