"""The plot shows what was measured, is the same twice, and leaves matplotlib's settings alone."""

import hashlib
import subprocess
import sys
from dataclasses import replace
from itertools import combinations

import matplotlib
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import Polygon
from matplotlib.text import Text

from grader.contracts.assignment import Case
from grader.contracts.figure import FigureSketch, SketchCorner, SketchLabel, SketchSide, SketchSolid
from grader.contracts.outcome import LogRecord, RunStatus
from grader.contracts.robot import BACK_M, FRONT_M, HALF_WIDTH_M
from grader.contracts.rubric import ItemStatus
from grader.contracts.text import Language
from grader.contracts.trajectory import Contact, Trajectory
from grader.render.dial import draw_dial
from grader.render.loglines import draw_log
from grader.render.plan import draw_plan
from grader.render.plot import plot
from grader.render.scene import Scene, compose
from grader.render.typeface import rc
from tests.examples import examples
from tests.rows import slow_but
from tests.unit.render.samples import (
    FIGURES,
    SECOND,
    START_M,
    IdealTurtle,
    assignment,
    figure_of,
    item,
    outcome,
    polygon,
    polygon_sketch,
    regular,
    report,
    square_report,
    t,
)

EVIL = "\x1b[31m $\\frac{$ 🎉 鱻 \u202e\n" * 3


def spin(turned_rad: float, ok: bool | None) -> tuple[Trajectory, FigureSketch]:
    motion = (
        IdealTurtle().go(0.0, float(np.sign(turned_rad)) * 1.5, abs(turned_rad) / 1.5).stop().trajectory()
    )
    corner = SketchCorner(at_m=(START_M, START_M), angle_deg=float(np.rad2deg(turned_rad)), ok=ok)
    return motion, FigureSketch(view="heading", corners=(corner,), wanted_turn_deg=360.0)


def scene(
    motion: Trajectory | None, sketch: FigureSketch | None, language: Language = "zh", **changes: object
) -> Scene:
    return compose(assignment(), report(**changes), motion, sketch, language)


def drawn(draw: object, shown: Scene) -> Axes:
    figure = Figure(figsize=(6, 5), dpi=120)
    FigureCanvasAgg(figure)
    with matplotlib.rc_context(dict(rc())):
        axes = figure.add_axes((0.1, 0.2, 0.85, 0.75))
        draw(axes, shown)  # type: ignore[operator]
    return axes


def words(axes: Axes) -> list[str]:
    return [text.get_text() for text in axes.findobj(Text) if isinstance(text, Text) and text.get_text()]


PLOTS = {
    "square": figure_of("square"),
    "wrong pentagon": figure_of("pentagon", wrong=True),
    "no sketch": (figure_of("square")[0], None),
    "spin": spin(7.0, True),
    "log": (IdealTurtle().trajectory(), FigureSketch(view="log")),
    "still": (IdealTurtle().stop().trajectory(), FigureSketch()),
    "nothing recorded": (None, None),
}


@pytest.mark.parametrize("case", PLOTS.values(), ids=PLOTS.keys())
def test_the_same_bytes_twice(case: tuple[Trajectory | None, FigureSketch | None]) -> None:
    motion, sketch = case
    arguments = (assignment(), square_report(), motion, sketch)
    svg = plot(*arguments, form="svg")
    assert svg == plot(*arguments, form="svg")
    assert svg.startswith(b"<?xml")
    assert b"<dc:date>" not in svg
    assert b"Matplotlib" not in svg


def test_the_same_bytes_in_another_process() -> None:
    motion, sketch = figure_of("square", wrong=True)
    here = hashlib.sha256(plot(assignment(), square_report(), motion, sketch, form="svg")).hexdigest()
    program = (
        "import hashlib; from grader.render.plot import plot; from tests.unit.render.samples import *;"
        "m, s = figure_of('square', True);"
        "print(hashlib.sha256(plot(assignment(), square_report(), m, s, form='svg')).hexdigest())"
    )
    there = subprocess.run(
        [sys.executable, "-c", program],
        env={"PYTHONHASHSEED": "1", "PATH": ""},  # this process's own is random
        capture_output=True,
        text=True,
        check=True,
    ).stdout
    assert there.strip() == here


def test_a_png_has_its_size_and_is_the_same_twice() -> None:
    motion, sketch = figure_of("square")
    png = plot(assignment(), square_report(), motion, sketch)
    assert png == plot(assignment(), square_report(), motion, sketch)
    assert png.startswith(b"\x89PNG\r\n\x1a\n")
    assert (int.from_bytes(png[16:20]), int.from_bytes(png[20:24])) == (1440, 810)


def test_a_users_settings_do_not_show_and_are_left_alone() -> None:
    motion, sketch = figure_of("square")
    before = dict(matplotlib.rcParams)
    plain = plot(assignment(), report(), motion, sketch)
    assert dict(matplotlib.rcParams) == before
    with matplotlib.rc_context({"font.size": 30, "axes.grid": True, "lines.linewidth": 9}):
        assert plot(assignment(), report(), motion, sketch) == plain


def test_measures_of_a_wrong_square() -> None:
    texts = words(drawn(draw_plan, scene(*figure_of("square", wrong=True))))
    assert "✗ 1.62 m" in texts
    assert "✗ 81°" in texts
    assert texts.count("2 m") == 3
    assert texts.count("90°") == 3
    assert [text for text in texts if text.startswith("缺口 0.")]


def test_a_right_square_has_no_mark_of_failure() -> None:
    texts = words(drawn(draw_plan, scene(*figure_of("square"))))
    assert not [text for text in texts if "✗" in text or "不合格" in text or "缺口" in text]
    assert texts.count("2 m") == 4


def test_turns_to_both_sides_carry_their_sign() -> None:
    motion, vertices = polygon([1.0, 1.0], [90.0, -90.0])
    sketch = polygon_sketch(vertices, [90.0, -90.0], side_m=1.0, turn_deg=90.0, ideal=[])
    texts = words(drawn(draw_plan, scene(motion, sketch)))
    assert "+90°" in texts
    assert "−90°" in texts


@pytest.mark.parametrize("name", FIGURES)
@pytest.mark.parametrize("wrong", [False, True])
@pytest.mark.parametrize("heading_deg", slow_but(1, [20.0, 0.0, 200.0]))
def test_labels_do_not_cover_each_other(name: str, wrong: bool, heading_deg: float) -> None:
    axes = drawn(draw_plan, scene(*figure_of(name, wrong, heading_deg)))
    renderer = axes.figure.canvas.get_renderer()  # type: ignore[attr-defined]
    boxes = {text: text.get_window_extent(renderer) for text in axes.texts if text.get_text()}
    for one, other in combinations(boxes, 2):
        assert not boxes[one].overlaps(boxes[other]), (one.get_text(), other.get_text())
    for text, box in boxes.items():
        assert axes.bbox.padded(4).contains(box.x0, box.y0), text.get_text()
        assert axes.bbox.padded(4).contains(box.x1, box.y1), text.get_text()


def test_equal_scales() -> None:
    axes = drawn(draw_plan, scene(*figure_of("square")))
    (x0, y0), (x1, y1) = axes.transData.transform([(0, 0), (1, 1)])
    assert x1 - x0 == pytest.approx(y1 - y0)


def test_walls_only_when_near() -> None:
    near = (
        IdealTurtle()
        .go(1.0, 0.0, 5.5)
        .trajectory((Contact(start_ns=5 * SECOND, end_ns=6 * SECOND, wall="right"),))
    )
    far = IdealTurtle().go(1.0, 0.0, 1.0).trajectory()
    assert "墙" in words(drawn(draw_plan, scene(near, None)))
    assert "墙" not in words(drawn(draw_plan, scene(far, None)))
    assert "墙" not in words(drawn(draw_plan, replace(scene(near, None), walls=False)))


def test_a_repetition_is_drawn_as_not_judged() -> None:
    motion, vertices = polygon([2.0] * 8, [90.0] * 8)
    sketch = polygon_sketch(vertices[:5], [90.0] * 4, side_m=2.0, turn_deg=90.0, ideal=regular(4, 2.0))
    assert "未计入的路径" in words(drawn(draw_plan, scene(motion, replace(sketch, end_ns=17 * SECOND))))
    assert "未计入的路径" not in words(drawn(draw_plan, scene(motion, sketch)))


def test_spin() -> None:
    assert "✗ −57.3°" in words(drawn(draw_dial, scene(*spin(-1.0, False))))
    assert "+401.1°" in words(drawn(draw_dial, scene(*spin(7.0, True))))


def test_log_lines() -> None:
    logs = tuple(LogRecord(t_ns=i * SECOND, level=20, name="n", message=f"第 {i} 条") for i in range(20))
    run = outcome(status=RunStatus.INTERRUPTED, duration_ns=20 * SECOND, logs=logs, nodes=("/hello_node",))
    texts = words(drawn(draw_log, scene(None, None, outcome=run)))
    assert "0.000 s  INFO  [n]  第 0 条" in texts
    assert "… 另有 8 条日志" in texts
    assert any(text.startswith("/hello_node") for text in texts)
    assert "没有日志到达 /rosout" in words(drawn(draw_log, scene(None, None, outcome=outcome(logs=()))))


@pytest.mark.parametrize("view", ["path", "heading", "log"])
def test_hostile_text_is_drawable(view: str) -> None:
    run = outcome(nodes=(EVIL,), logs=(LogRecord(t_ns=0, level=99, name=EVIL, message=EVIL),))
    sketch = FigureSketch(view=view, labels=(SketchLabel(at_m=(6.0, 6.0), text=t(EVIL)),))  # type: ignore[arg-type]
    motion, _ = figure_of("square")
    graded = report(summary=t(EVIL), outcome=run)
    assert plot(assignment(title=t(EVIL)), graded, motion, sketch)


def test_nothing_moved_is_said() -> None:
    assert "小车没有动" in words(drawn(draw_plan, scene(IdealTurtle().stop().trajectory(), None)))
    assert "小车没有动" in words(drawn(draw_plan, scene(None, None)))


def test_a_report_without_runs_has_no_plot() -> None:
    with pytest.raises(ValueError, match="without runs"):
        plot(assignment(), report(runs=()), None)


POINT = st.tuples(st.floats(-2, 13), st.floats(-2, 13))
SIDE = st.builds(
    SketchSide,
    start_m=POINT,
    end_m=POINT,
    length_m=st.floats(0, 20),
    ok=st.sampled_from([True, False, None]),
)
CORNER = st.builds(
    SketchCorner, at_m=POINT, angle_deg=st.floats(-360, 360), ok=st.sampled_from([True, False, None])
)


@settings(max_examples=examples(8))
@given(
    legs=st.lists(st.tuples(st.floats(-2, 2), st.floats(-3, 3), st.floats(0.01, 3)), max_size=4),
    sketch=st.builds(
        FigureSketch,
        view=st.sampled_from(["path", "heading"]),
        sides=st.lists(SIDE, max_size=4).map(tuple),
        corners=st.lists(CORNER, max_size=4).map(tuple),
        ideal_m=st.lists(POINT, max_size=5).map(tuple),
        gap=st.none() | SIDE,
        begin_ns=st.integers(0, 10 * SECOND),
        end_ns=st.none() | st.integers(0, 10 * SECOND),
        wanted_turn_deg=st.none() | st.just(360.0),
    ),
    holes=st.sets(st.integers(0, 3)),
)
def test_any_motion_can_be_drawn(
    legs: list[tuple[float, float, float]], sketch: FigureSketch, holes: set[int]
) -> None:
    turtle = IdealTurtle()
    for leg in legs:
        turtle.go(*leg)
    motion = turtle.trajectory()
    motion.x_m[[hole for hole in holes if hole < len(motion)]] = np.nan
    jumps = (len(motion) // 2,) if len(motion) > 2 else ()
    assert plot(assignment(), report(), replace(motion, jumps=jumps), sketch)


def test_a_robot_is_as_large_as_it_is_where_it_touched_and_where_it_ended() -> None:
    motion = IdealTurtle().go(0.2, 0.0, 5.0).go(0.0, 1.0, np.pi / 2).stop().trajectory()
    wall = SketchSolid(kind="wall", outline_m=((7.0, 5.0), (7.1, 5.0), (7.1, 6.0), (7.0, 6.0)))
    touched = replace(motion, contacts=(Contact(start_ns=2_000_000_000, end_ns=3_000_000_000, wall="wall"),))
    axes = drawn(draw_plan, scene(touched, FigureSketch(solids=(wall,))))
    outlines = [patch.get_xy()[:-1] for patch in axes.patches if isinstance(patch, Polygon)]
    _, there, last = outlines
    assert there.min(axis=0) == pytest.approx((START_M + 0.4 + BACK_M, START_M - HALF_WIDTH_M), abs=0.01)
    assert there.max(axis=0) == pytest.approx((START_M + 0.4 + FRONT_M, START_M + HALF_WIDTH_M), abs=0.01)
    assert last.max(axis=0) == pytest.approx((START_M + 1.0 + HALF_WIDTH_M, START_M + FRONT_M), abs=0.01)
    assert not drawn(draw_plan, scene(touched, FigureSketch())).patches  # a turtle has no outline


def test_of_several_runs_each_has_its_picture_and_points() -> None:
    task = replace(assignment(), cases=(Case(id="a"), Case(id="b", title=t("边长 2 m", "side 2 m"))))
    run = report().runs[0]
    whole = report(
        runs=(replace(run, case="a"), replace(run, case="b")),
        items=(item(id="a/sides"), item(ItemStatus.FAILED, id="b/sides")),
        score=2.0,
        max_score=4.0,
    )
    first = compose(task, whole, None, None, "zh")
    second = compose(task, whole, None, None, "zh", "b")
    assert (first.title, first.score, first.full) == ("正方形 · a", "得分 2 / 2", True)
    assert (second.title, second.score, second.full) == ("正方形 · 边长 2 m", "得分 0 / 2", False)
    with pytest.raises(ValueError, match="nothing to plot"):
        compose(task, whole, None, None, "zh", "c")


def test_the_path_as_commanded_is_drawn_where_the_turtle_drove_another() -> None:
    motion, sketch = IdealTurtle().go(1.0, 0.0, 2.1).stop().trajectory(), FigureSketch()
    beside = replace(sketch, commanded_m=((START_M, START_M), (START_M + 2.0, START_M)))
    labels = [
        {line.get_label() for line in drawn(draw_plan, scene(motion, each, "en")).get_lines()}
        for each in (sketch, beside)
    ]
    assert ["commanded" in each for each in labels] == [False, True]
