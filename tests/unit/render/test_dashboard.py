"""The dashboard as tables, tolerant of what newer or older servers send."""

import io
from collections.abc import Mapping

import pytest
from hypothesis import given
from hypothesis import strategies as st

from grader.contracts.text import Language
from grader.render.dashboard import render_dashboard
from grader.render.terminal import console

DATA = {
    "students": [
        {
            "student": "20230101 张三",
            "assignments": {
                "hello": {"best_score": 7.25, "status": "graded", "attempts": 1},
                "square": {"best_score": 10, "status": "graded", "attempts": 2},
            },
        },
        {"student": "李四", "assignments": {"square": {"best_score": None, "status": "running"}}},
    ],
    "assignments": {
        "hello": {
            "title": {"zh": "问候", "en": "Hello"},
            "max_score": 10,
            "pass_rate": 0.5,
            "mean": 7.0,
            "submissions": 4,
            "most_failed": [{"id": "alive", "count": 3}, {"id": "log", "count": 1}],
        },
        "square": {"title": "Square", "max_score": 10.0},
    },
    "queue": {"queued": 2, "running": 1},
}


def shown(data: Mapping[str, object], language: Language = "zh") -> str:
    stream = io.StringIO()
    console(stream, 100).print(render_dashboard(data, language=language))
    return stream.getvalue()


def test_students_by_assignments() -> None:
    lines = shown(DATA).split("\n")
    assert any("学生" in line and "问候" in line and "Square" in line for line in lines)
    (row,) = (line for line in lines if "张三" in line)
    assert row.split() == ["20230101", "张三", "7.25", "✓", "10", "×2"]
    (row,) = (line for line in lines if "李四" in line)
    assert row.split() == ["李四", "—", "running"]


def test_assignments_and_queue() -> None:
    text = shown(DATA, "en")
    (row,) = (line for line in text.split("\n") if "alive" in line)
    assert row.split() == ["Hello", "4", "50", "%", "7", "alive", "(3),", "log", "(1)"]
    assert "Queue: queued 2  running 1" in text


def test_a_list_of_assignments_is_as_good() -> None:
    listed = [{"id": key, **value} for key, value in DATA["assignments"].items()]  # type: ignore[attr-defined]
    assert shown({**DATA, "assignments": listed}) == shown(DATA)


def test_columns_without_assignment_data() -> None:
    assert "hello" in shown({"students": DATA["students"]})


def test_names_are_escaped() -> None:
    text = shown({"students": [{"student": "\x1b[31m[bold]x[/bold]", "assignments": {}}]})
    assert "\\x1b[31m[bold]x[/bold]" in text


JSON = st.recursive(
    st.none() | st.booleans() | st.floats(allow_nan=False) | st.integers(-10, 10) | st.text(max_size=5),
    lambda inner: (
        st.lists(inner, max_size=3)
        | st.dictionaries(
            st.sampled_from(
                ["students", "student", "assignments", "id", "best_score", "title", "most_failed", "x"]
            ),
            inner,
            max_size=4,
        )
    ),
    max_leaves=12,
)


@given(st.dictionaries(st.sampled_from(["students", "assignments", "queue"]), JSON))
def test_any_json_prints(data: dict[str, object]) -> None:
    shown(data)


@pytest.mark.parametrize("data", [{}, {"students": [], "assignments": {}}])
def test_an_empty_dashboard_prints(data: dict[str, object]) -> None:
    assert "学生" in shown(data)
