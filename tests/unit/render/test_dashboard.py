"""The dashboard as tables, tolerant of what newer or older servers send."""

import io
from collections.abc import Mapping

import pytest
from hypothesis import given
from hypothesis import strategies as st
from rich.cells import cell_len

from grader.contracts.text import Language
from grader.render.dashboard import render_dashboard
from grader.render.terminal import console

TITLES = {
    "hello": "你好 ROS 2",
    "straight": "直线前进",
    "backward": "直线后退",
    "spin": "原地转圈",
    "square": "正方形",
    "triangle": "等边三角形",
    "pentagon": "正五边形",
}
FULL = {"best_score": 100.0, "max_score": 100.0, "status": "graded", "attempts": 2}
DATA = {
    "students": [
        {
            "student": "20230101 张三",
            "total_score": 607.25,
            "assignments": dict.fromkeys(TITLES, FULL) | {"hello": {"best_score": 7.25, "attempts": 1}},
        },
        {"student": "李四", "assignments": {"square": {"best_score": None, "status": "running"}}},
    ],
    "assignments": [
        {
            "id": key,
            "title": title,
            "max_score": 10.0,
            "pass_rate": 0.5,
            "mean_score": 8.625,
            "submissions": 4,
            "most_failed_items": [
                {"id": "alive", "title": "一直运行", "count": 3},
                {"id": "log", "title": "日志", "count": 1},
            ],
        }
        for key, title in TITLES.items()
    ],
    "queue": {"queued": 2, "running": 1},
}


def shown(data: Mapping[str, object], language: Language = "zh", width: int = 100) -> str:
    stream = io.StringIO()
    console(stream, width).print(render_dashboard(data, language=language))
    return stream.getvalue()


def row(text: str, start: str) -> list[str]:
    (line,) = (line for line in text.split("\n") if line.strip().startswith(start))
    return line.split()


def test_students_by_assignments() -> None:
    text = shown(DATA)
    assert row(text, "学生") == ["学生", "你好", "ROS", "2", *list(TITLES.values())[1:], "总分"]
    assert row(text, "20230101") == ["20230101", "张三", "7.25", *["✓100×2"] * 6, "607.25"]
    assert row(text, "李四") == ["李四", "—", "—", "—", "—", "评分中", "—", "—", "—"]


def test_what_has_not_passed_is_marked_and_the_marks_are_explained() -> None:
    cells = {"hello": {**FULL, "best_score": 40.0, "passed": False}}
    text = shown({**DATA, "pass_fraction": 0.6, "students": [{"student": "s1", "assignments": cells}]})
    assert row(text, "s1")[1] == "✗40×2"
    assert "✗ 不到 60 %" in text


def test_assignments_and_queue() -> None:
    text = shown(DATA, "en")
    assert row(text, "正方形") == ["正方形", "4", "50", "%", "8.62", "一直运行", "×3,", "日志", "×1"]
    assert "Queue: queued 2  running 1" in text


def test_a_whole_course_fits_eighty_columns() -> None:
    text = shown(DATA, width=80)
    assert max(cell_len(line) for line in text.split("\n")) <= 80
    assert row(text, "20230101")[2:] == ["7.25", *["✓100×2"] * 6, "607.25"]


def test_names_are_escaped() -> None:
    text = shown({"students": [{"student": "\x1b[31m[bold]x[/bold]", "assignments": {}}]})
    assert "\\x1b[31m[bold]x[/bold]" in text


JSON = st.recursive(
    st.none() | st.booleans() | st.floats(allow_nan=False) | st.integers(-10, 10) | st.text(max_size=5),
    lambda inner: (
        st.lists(inner, max_size=3)
        | st.dictionaries(
            st.sampled_from(["student", "assignments", "id", "best_score", "title", "most_failed_items"]),
            inner,
            max_size=4,
        )
    ),
    max_leaves=12,
)


@given(st.dictionaries(st.sampled_from(["students", "assignments", "queue"]), JSON))
def test_any_json_prints(data: dict[str, object]) -> None:
    shown(data)


@pytest.mark.parametrize("data", [{}, {"students": [], "assignments": []}])
def test_an_empty_dashboard_prints(data: dict[str, object]) -> None:
    assert "学生" in shown(data)


def test_more_assignments_than_fit_go_on_in_a_second_table() -> None:
    names = [f"figure{number}" for number in range(9)]
    cells = {name: {"best_score": float(number), "max_score": 100.0} for number, name in enumerate(names)}
    student = {"student": "ann", "assignments": cells, "total_score": 36.0}
    text = shown(
        {"students": [student], "assignments": [{"id": name, "title": name} for name in names]}, width=80
    )
    rows = [line.split() for line in text.split("\n") if line.strip().startswith("ann")]
    assert rows == [["ann", "0", "1", "2", "3", "4", "5", "6"], ["ann", "7", "8", "36"]]


def test_what_waits_for_a_person_is_not_called_graded() -> None:
    cell = {"best_score": None, "status": "graded", "verdict": "needs_manual", "attempts": 1}
    student = {"student": "ada", "assignments": {"square": cell}}
    text = shown({**DATA, "students": [student], "waiting_for_person": 3})
    assert "待评" in row(text, "ada")
    assert "已评分" not in " ".join(row(text, "ada"))
    assert "等待人工评分 3" in text
