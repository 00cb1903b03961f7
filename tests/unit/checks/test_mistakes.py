"""Mistakes recognised from the outcome and the commands; what holds for every mistake."""

import ast
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from grader.checks import evaluate, mistakes
from grader.contracts.outcome import Endpoint, Note, RunStatus, Stream
from grader.contracts.scoring import Run
from grader.contracts.trajectory import Trajectory
from grader.formats.packages import problems
from grader.grading import pipeline
from grader.messages import entries, exceptions
from tests.unit.checks.shipped import assignment, graded, score, silent
from tests.unit.checks.trajectories import drive, error, outcome_of, polygon_legs, run_of

TWIST = "geometry_msgs/msg/Twist"
AT_REST = drive([(2.0, 0.0, 0.0)])


def publisher(name: str = "/turtle1/cmd_vel", kind: str = TWIST, count: int = 0) -> Endpoint:
    return Endpoint(kind="publisher", node="/mover", name=name, type=kind, count=count)


@pytest.mark.parametrize(
    ("status", "code"),
    [
        (RunStatus.STALLED, "stalled"),
        (RunStatus.CPU_LIMIT, "cpu_limit"),
        (RunStatus.MEMORY_LIMIT, "memory_limit"),
        (RunStatus.OUTPUT_LIMIT, "output_limit"),
        (RunStatus.FORBIDDEN, "forbidden"),
    ],
)
def test_other_ends(status: RunStatus, code: str) -> None:
    assert silent(status, detail="open('/etc/passwd')").mistakes[0] == code


@pytest.mark.parametrize(
    ("status", "changes", "code", "word"),
    [
        (RunStatus.FINISHED, {"nodes": ()}, "nothing_ran", "main()"),
        (
            RunStatus.FINISHED,
            {"nodes": (), "exit_code": 2, "stderr": Stream(text="usage: a.py [-h] side\na.py: error: ...\n")},
            "no_arguments",
            "argparse",
        ),
        (
            RunStatus.INTERRUPTED,
            {"nodes": (), "notes": (Note(code="asks_again", text=""),)},
            "asks_again",
            "float(",
        ),
        (RunStatus.FINISHED, {}, "no_publisher", "/turtle1/cmd_vel"),
        (RunStatus.FINISHED, {"endpoints": (publisher("/rosout"),)}, "no_publisher", "/turtle1/cmd_vel"),
        (
            RunStatus.INTERRUPTED,
            {
                "endpoints": (
                    publisher("/chatter", "std_msgs/msg/String"),
                    publisher("/tf", "tf2_msgs/msg/TFMessage"),
                )
            },
            "no_publisher",
            "/turtle1/cmd_vel",
        ),
        (RunStatus.INTERRUPTED, {"endpoints": (publisher("/cmd_vel"),)}, "nothing_sent", "/cmd_vel"),
        (RunStatus.INTERRUPTED, {"endpoints": (publisher("/cmd_vel", count=3),)}, "wrong_topic", "/cmd_vel"),
        (
            RunStatus.INTERRUPTED,
            {"endpoints": (publisher("/cmd_vel", "std_msgs/msg/String", count=3),)},
            "no_publisher",
            "/turtle1/cmd_vel",
        ),
        (
            RunStatus.INTERRUPTED,
            {"endpoints": (publisher(kind="std_msgs/msg/String"),)},
            "wrong_type",
            "std_msgs/msg/String",
        ),
        (RunStatus.FINISHED, {"endpoints": (publisher(),)}, "never_spun", "spin"),
        (RunStatus.INTERRUPTED, {"endpoints": (publisher(),)}, "never_published", "publish"),
    ],
)
def test_silence(status: RunStatus, changes: dict[str, object], code: str, word: str) -> None:
    scoring = silent(status, **changes)
    assert scoring.mistakes == (code,)
    assert word in scoring.hint.zh
    assert word in scoring.hint.en


def teleporting(trajectory: Trajectory, *turns_rad: float, final_reset: bool = False) -> Trajectory:
    """The motion, and in its last second these jumps, each on from the last: 2 m ahead, then a turn."""
    values = {name: getattr(trajectory, name) for name in Trajectory.__slots__}
    arrays = {name: list(values[name]) for name in ("t_ns", "x_m", "y_m", "heading_rad", "v_mps", "w_radps")}
    first = len(arrays["t_ns"])
    for turn in turns_rad:
        arrays["t_ns"].append(arrays["t_ns"][-1] + 1_000)
        arrays["x_m"].append(arrays["x_m"][-1] + 2.0 * math.cos(arrays["heading_rad"][-1]))
        arrays["y_m"].append(arrays["y_m"][-1] + 2.0 * math.sin(arrays["heading_rad"][-1]))
        arrays["heading_rad"].append(arrays["heading_rad"][-1] + turn)
    if final_reset:
        arrays["t_ns"].append(arrays["t_ns"][-1] + 1_000)
        for name in ("x_m", "y_m", "heading_rad"):
            arrays[name].append(arrays[name][0])
    count = len(arrays["t_ns"])
    for name in ("v_mps", "w_radps"):
        arrays[name] += [0.0] * (count - first)
    values |= {name: np.array(column) for name, column in arrays.items()}
    values |= {"jumps": tuple(range(first, count)), "end_ns": int(arrays["t_ns"][-1])}
    return Trajectory(**values)


@pytest.mark.parametrize("endpoints", [(), (publisher(),)])
def test_teleporting_is_not_driving(endpoints: tuple[Endpoint, ...]) -> None:
    still = teleporting(drive([], horizon_s=2.0), *[math.pi / 2] * 4)
    outcome = outcome_of(still, endpoints=endpoints)
    scoring = evaluate(assignment("square"), [Run(trajectory=replace(still, commands=()), outcome=outcome)])
    assert (scoring.mistakes, score(scoring)) == (("teleported",), 0)
    assert "瞬移" in scoring.hint.zh
    assert "teleporting is not driving" in scoring.hint.en


def test_one_teleport_or_a_reset_among_commands_is_no_mistake() -> None:
    one_side = drive(polygon_legs(4, laps=0.25))
    assert "teleported" in graded("square", teleporting(one_side, 1.5, 1.5)).mistakes
    assert "teleported" not in graded("square", teleporting(one_side, 1.5, final_reset=True)).mistakes
    assert "teleported" not in graded("square", teleporting(one_side, final_reset=True)).mistakes


@pytest.mark.parametrize(
    ("note", "changes", "code"),
    [
        (Note(code="thread_exception", text="Thread-1, line 9: boom"), {}, "thread_crashed"),
        (Note(code="forbidden", text="os.system: ros2"), {}, "forbidden"),
        (Note(code="caught", text="line 9: NameError: x"), {"endpoints": (publisher(),)}, "error_caught"),
        (
            Note(code="incompatible_qos", text="/turtle1/cmd_vel"),
            {"endpoints": (publisher(),)},
            "incompatible_qos",
        ),
    ],
)
def test_notes(note: Note, changes: dict[str, object], code: str) -> None:
    scoring = silent(notes=(note,), **changes)
    assert scoring.mistakes[0] == code


@pytest.mark.parametrize(
    ("code", "place", "end"),
    [("thread_exception", "Thread-1 (go), line 9", "."), ("caught", "line 9", "Mend it first:")],
)
def test_what_ended_a_thread_or_was_caught_is_explained_as_well(code: str, place: str, end: str) -> None:
    text = f"{place}: AssertionError: The 'x' field must be of type 'float'"
    hint = silent(notes=(Note(code=code, text=text),)).hint
    assert (text in hint.zh) == (code == "thread_exception")  # what was caught is told once
    assert "第 9 行：字段 x 必须是浮点数" in hint.zh
    assert f"{end} Line 9: the field x must be a float" in hint.en


def test_a_caught_error_without_a_known_meaning_is_quoted() -> None:
    text = "line 9: AssertionError: more"
    assert text in silent(notes=(Note(code="caught", text=text),)).hint.zh


def test_sideways() -> None:
    assert graded("square", AT_REST, notes=(Note(code="lateral_command"),)).mistakes == ("sideways",)


def test_zero_and_infinite_commands() -> None:
    assert graded("square", AT_REST).mistakes == ("only_stops",)
    assert graded("square", AT_REST, nonfinite_commands=3).mistakes == ("nonfinite_commands",)


def test_no_mistake_is_claimed_when_all_is_right() -> None:
    """A crash after the figure was complete costs nothing; the summary mentions it."""
    trajectory = drive(polygon_legs(4))
    outcome = outcome_of(trajectory, RunStatus.CRASHED, error=error("RCLError", "late"))
    scoring = evaluate(assignment("square"), [Run(trajectory=trajectory, outcome=outcome)])
    assert score(scoring) == 100
    assert scoring.mistakes == ()
    assert "17" in scoring.summary.zh
    assert "RCLError" in scoring.summary.en


def test_the_hint_of_an_item_is_the_mistake_that_spoilt_it() -> None:
    scoring = graded("square", drive(polygon_legs(4, corners_deg=[57.3] * 4)))
    hints = {each.id: each.hint.en for each in scoring.items if each.hint.en}
    assert "about 1 radian" in hints["angles"]
    assert "lengths" not in hints


def codes_in_source() -> set[str]:
    """Every string in the recognisers that has a text ``mistake.<string>``."""
    files = [
        *Path(mistakes.__file__).parent.rglob("*.py"),
        Path(exceptions.__file__),
        Path(problems.__file__),
        Path(pipeline.__file__),  # a package whose interfaces cannot be read
    ]
    strings = {
        node.value
        for path in files
        for node in ast.walk(ast.parse(path.read_text()))
        if isinstance(node, ast.Constant) and isinstance(node.value, str)
    }
    strings |= {code for code, _ in exceptions.signs()}
    return {each for each in strings if f"mistake.{each}" in entries("en", "grader")}


def test_the_recognisers_cover_every_mistake_text() -> None:
    texts = {each for each in entries("zh", "grader") if each.startswith("mistake.")}
    assert {f"mistake.{code}" for code in codes_in_source()} == texts


def test_run_of_is_well_behaved() -> None:
    """The outcome the other tests start from recognises nothing by itself."""
    assert evaluate(assignment("square"), [run_of(drive(polygon_legs(4)))]).mistakes == ()
