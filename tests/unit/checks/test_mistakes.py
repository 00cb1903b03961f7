"""Every recognised mistake, from the outcome, the commands or the shape of the motion."""

import ast
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from grader.checks import evaluate, mistakes
from grader.contracts.outcome import Endpoint, Note, RunOutcome, RunStatus, StudentError
from grader.contracts.trajectory import Command, Trajectory
from grader.contracts.verdict import Run, Verdict
from tests.unit.checks.ideal_turtle import Leg, drive, outcome_of, polygon_legs, run_of
from tests.unit.checks.shipped import assignment, graded, score
from tests.unit.messages.catalogs import catalog_texts

TWIST = "geometry_msgs/msg/Twist"
AT_REST = drive([(2.0, 0.0, 0.0)])


def silent(status: RunStatus = RunStatus.FINISHED, **changes: object) -> Verdict:
    values: dict[str, object] = {"status": status, "duration_ns": 1_000, "nodes": ("/mover",), **changes}
    trajectory = drive([], horizon_s=2.0)
    outcome = RunOutcome(**values)  # type: ignore[arg-type]
    return evaluate(assignment("square"), [Run(trajectory=trajectory, outcome=outcome)])


def publisher(name: str = "/turtle1/cmd_vel", kind: str = TWIST) -> Endpoint:
    return Endpoint(kind="publisher", node="/mover", name=name, type=kind)


def error(kind: str, message: str) -> StudentError:
    return StudentError(type=kind, message=message, line=17, traceback="")


@pytest.mark.parametrize(
    ("problem", "code", "words"),
    [
        (
            error("AssertionError", "The 'x' field must be of type 'float'"),
            "int_in_float",
            ("17", "x", "1.0"),
        ),
        (error("AttributeError", "'Twist' object has no attribute 'liner'"), "unknown_field", ("liner",)),
        (error("AttributeError", "'Car' object has no attribute 'pub'"), "crashed", ("'pub'",)),
        (
            error("TypeError", "create_publisher() missing 1 required positional argument: 'qos_profile'"),
            "missing_qos",
            ("17", "10"),
        ),
        (error("NotInitializedException", "('rclpy.init() ...')"), "not_initialized", ("rclpy.init()",)),
        (error("EOFError", "EOF when reading a line"), "no_input", ("input()",)),
        (error("NameError", "name 'Twst' is not defined"), "unknown_name", ("Twst",)),
        (error("ModuleNotFoundError", "No module named 'rospy'"), "ros_1", ("rospy", "ROS 2")),
        (error("ModuleNotFoundError", "No module named 'cv2'"), "missing_module", ("cv2",)),
        (error("ModuleNotFoundError", "No module named 'pynput'"), "no_terminal", ("17",)),
        (error("TypeError", "got an unexpected keyword argument 'queue_size'"), "missing_qos", ("17", "10")),
        (
            error("FileNotFoundError", "[Errno 2] No such file or directory: 'a.csv'"),
            "missing_file",
            ("a.csv",),
        ),
        (error("OSError", "[Errno 28] No space left on device"), "disk_full", ("16 MiB",)),
        (error("OSError", "[Errno 22] Invalid argument"), "crashed", ("OSError",)),
        (error("error", "(25, 'Inappropriate ioctl for device')"), "no_terminal", ("7",)),
        (error("TclError", "no display name and no $DISPLAY environment variable"), "no_display", ("17",)),
        (error("ZeroDivisionError", "division by zero"), "crashed", ("ZeroDivisionError", "17")),
        (None, "killed", ("SIGSEGV",)),
    ],
)
def test_crashes(problem: StudentError | None, code: str, words: tuple[str, ...]) -> None:
    verdict = silent(RunStatus.CRASHED, error=problem, signal="SIGSEGV")
    assert verdict.mistakes[0] == code
    assert all(word in verdict.hint.zh and word in verdict.hint.en for word in words)


@pytest.mark.parametrize(
    ("status", "code"),
    [
        (RunStatus.SYNTAX_ERROR, "syntax_error"),
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
        (RunStatus.FINISHED, {}, "no_publisher", "/turtle1/cmd_vel"),
        (RunStatus.FINISHED, {"endpoints": (publisher("/rosout"),)}, "no_publisher", "/turtle1/cmd_vel"),
        (RunStatus.INTERRUPTED, {"endpoints": (publisher("/cmd_vel"),)}, "wrong_topic", "/cmd_vel"),
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
    verdict = silent(status, **changes)
    assert verdict.mistakes == (code,)
    assert word in verdict.hint.zh
    assert word in verdict.hint.en


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
    verdict = evaluate(assignment("square"), [Run(trajectory=replace(still, commands=()), outcome=outcome)])
    assert (verdict.mistakes, score(verdict)) == (("teleported",), 0)
    assert "瞬移" in verdict.hint.zh
    assert "teleporting is not driving" in verdict.hint.en


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
        (
            Note(code="incompatible_qos", text="/turtle1/cmd_vel"),
            {"endpoints": (publisher(),)},
            "incompatible_qos",
        ),
    ],
)
def test_notes(note: Note, changes: dict[str, object], code: str) -> None:
    verdict = silent(notes=(note,), **changes)
    assert verdict.mistakes[0] == code


def test_sideways() -> None:
    assert graded("square", AT_REST, notes=(Note(code="lateral_command"),)).mistakes == ("sideways",)


def test_zero_and_infinite_commands() -> None:
    assert graded("square", AT_REST).mistakes == ("zero_commands",)
    assert graded("square", AT_REST, nonfinite_commands=3).mistakes == ("nonfinite_commands",)


def test_much_curve_is_told_before_the_one_corner_it_spoils() -> None:
    rounded: list[Leg] = [(2.0, 1.0, 0.0), (math.pi / 2, 1.0, 1.0)]
    early: list[Leg] = [(2.0, 1.0, 0.0), (1.2, 1.0, 1.0)]
    verdict = graded("square", drive([*rounded, *rounded, *early, *rounded]))
    assert verdict.mistakes[:2] == ("arcs", "one_corner_off")
    assert "linear.x = 0.0" in verdict.hint.en
    little: list[Leg] = [(2.0, 1.0, 0.0), (math.pi / 2, 0.3, 1.0)]
    early = [(2.0, 1.0, 0.0), (1.2, 0.3, 1.0)]
    assert graded("square", drive([*little, *little, *early, *little])).mistakes[0] == "one_corner_off"


def once_each(legs: list[tuple[float, float, float]]) -> Trajectory:
    """Each velocity published once; the car stops a second later."""
    seen: list[tuple[float, float, float]] = []
    commands, now_s = [], 0.0
    for duration, v, w in legs:
        commands.append(Command(t_ns=round(now_s * 1e9), v_mps=v, w_radps=w))
        seen += [(min(duration, 1.0), v, w), (max(duration - 1.0, 0.0), 0.0, 0.0)]
        now_s += duration
    commands.append(Command(t_ns=round(now_s * 1e9), v_mps=0.0, w_radps=0.0))
    trajectory = drive(seen)
    values = {name: getattr(trajectory, name) for name in Trajectory.__slots__}
    return Trajectory(**{**values, "commands": tuple(commands)})


def test_published_once_is_told_before_the_angle_it_leads_to() -> None:
    verdict = graded("square", once_each([(2.0, 1.0, 0.0), (1.5708, 0.0, 1.0)] * 4))
    assert verdict.mistakes[:2] == ("published_once", "one_radian")
    assert "2 s" in verdict.hint.en


@pytest.mark.parametrize(
    ("name", "legs", "code"),
    [
        ("square", polygon_legs(4, corners_deg=[57.3] * 4), "one_radian"),
        ("triangle", polygon_legs(3, corners_deg=[57.3] * 3), "one_radian"),
        ("octagon", polygon_legs(8, 1.0, corners_deg=[57.3] * 8), "one_radian"),
        ("octagon", polygon_legs(8, 1.0, corners_deg=[54] * 8), "turns_too_far"),  # ticks of a 10 Hz timer
        ("triangle", polygon_legs(3, corners_deg=[60] * 3), "interior_angle"),
        ("pentagon", polygon_legs(5, corners_deg=[108] * 5), "interior_angle"),
        ("square", polygon_legs(4, laps=0.75), "sides_missing"),
        ("square", polygon_legs(4, laps=1.25), "sides_extra"),
        ("square", polygon_legs(4, corners_deg=[97] * 4), "turns_too_far"),
        ("square", polygon_legs(4, corners_deg=[83] * 4), "turns_too_short"),
        ("square", polygon_legs(4, corners_deg=[90, 80, 90, 90]), "one_corner_off"),
        ("square", polygon_legs(4, corners_deg=[60, 120, 60, 120]), "one_corner_off"),  # not "0° too far"
        ("square", polygon_legs(4, lengths_m=[2, 2, 2, 1.7]), "unequal_sides"),
        ("square", polygon_legs(4, corners_deg=[90, -90, 90, -90]), "zigzag"),
        ("square", [(2.0, 1.0, 0.0), (math.pi / 2, 1.0, 1.0)] * 4, "arcs"),
        ("square", [(2 * math.pi, 1.0, 1.0)], "arcs"),
        ("square", [(2.0, 1.0, 0.0)], "no_turns"),
        ("square", [(2.0, 1.0, 0.0), (1.0, 0.0, 90.0)] * 4, "degrees_as_radians"),
        ("square", polygon_legs(5), "other_figure"),
    ],
)
def test_shapes(name: str, legs: list[tuple[float, float, float]], code: str) -> None:
    verdict = graded(name, drive(legs))
    assert verdict.mistakes[0] == code
    assert score(verdict) < 100


@pytest.mark.parametrize(
    ("name", "legs", "code"),
    [
        ("square", polygon_legs(4, laps=0.75), "sides_missing"),
        ("octagon", polygon_legs(8, 1.0, corners_deg=[54] * 8), "turns_too_far"),
    ],
)
def test_who_publishes_stop_until_the_horizon_had_time_enough(name: str, legs: list[Leg], code: str) -> None:
    verdict = graded(name, drive([*legs, (20.0, 0.0, 0.0)]), RunStatus.INTERRUPTED)
    assert verdict.mistakes == (code,)


def test_too_slow_and_never_ending() -> None:
    slow = drive(polygon_legs(4, v_mps=0.1), horizon_s=60.0)
    assert graded("square", slow, RunStatus.INTERRUPTED).mistakes[0] == "too_slow"
    spinning = drive([(2.0, 1.0, 0.0), (90.0, 0.0, 1.0)], horizon_s=60.0)
    assert graded("square", spinning, RunStatus.INTERRUPTED).mistakes[0] == "endless_turn"
    straying = drive([*polygon_legs(4), (60.0, 0.1, 0.0)], horizon_s=60.0)
    verdict = graded("square", straying, RunStatus.INTERRUPTED)
    assert verdict.mistakes == ("never_stops",)
    assert score(verdict) == 95


def test_spinning_for_ever_after_the_figure_is_only_a_missing_stop() -> None:
    spinning = drive([*polygon_legs(4, last_turn=False), (60.0, 0.0, 1.0)], horizon_s=60.0)
    verdict = graded("square", spinning, RunStatus.INTERRUPTED)
    assert verdict.mistakes == ("never_stops",)
    assert score(verdict) == 95


@pytest.mark.parametrize("left_s", [0.2, 1.2, 1.9])
@pytest.mark.parametrize("name", ["square", "triangle"])
def test_who_is_cut_in_the_last_turn_or_side_is_not_told_to_stop(name: str, left_s: float) -> None:
    legs = polygon_legs({"square": 4, "triangle": 3}[name], pause_s=0.0)
    cut = drive(legs, horizon_s=sum(leg[0] for leg in legs) - left_s)
    verdict = graded(name, cut, RunStatus.INTERRUPTED)
    assert verdict.mistakes[0] == "time_was_up"
    assert "never_stops" not in verdict.mistakes
    assert graded(name, cut).mistakes[-1] == "never_stops"  # a script that ended by itself had its time


def test_a_script_that_ends_without_a_stop() -> None:
    trajectory = drive(polygon_legs(4))
    values = {name: getattr(trajectory, name) for name in Trajectory.__slots__}
    moving = Command(t_ns=trajectory.commands[-1].t_ns + 1, v_mps=0.0, w_radps=1.0)
    coasting = Trajectory(**{**values, "commands": (*trajectory.commands, moving)})
    assert graded("square", coasting).mistakes == ("never_stops",)


def test_no_mistake_is_claimed_when_all_is_right() -> None:
    """A crash after the figure was complete costs nothing; the summary mentions it."""
    trajectory = drive(polygon_legs(4))
    outcome = outcome_of(trajectory, RunStatus.CRASHED, error=error("RCLError", "late"))
    verdict = evaluate(assignment("square"), [Run(trajectory=trajectory, outcome=outcome)])
    assert score(verdict) == 100
    assert verdict.mistakes == ()
    assert "17" in verdict.summary.zh
    assert "RCLError" in verdict.summary.en


def test_the_hint_of_an_item_is_the_mistake_that_spoilt_it() -> None:
    verdict = graded("square", drive(polygon_legs(4, lengths_m=[2, 2, 2, 1.7])))
    hints = {each.id: each.hint.en for each in verdict.items if each.hint.en}
    assert "Side 4" in hints["lengths"]
    assert "angles" not in hints


def codes_in_source() -> set[str]:
    """Every string in the recognisers that has a text ``mistake.<string>``."""
    strings = {
        node.value
        for path in Path(mistakes.__file__).parent.glob("*.py")
        for node in ast.walk(ast.parse(path.read_text()))
        if isinstance(node, ast.Constant) and isinstance(node.value, str)
    }
    return {each for each in strings if f"mistake.{each}" in catalog_texts("en")}


def test_the_recognisers_cover_every_mistake_text() -> None:
    texts = {each for each in catalog_texts("zh") if each.startswith("mistake.")}
    assert {f"mistake.{code}" for code in codes_in_source()} == texts


def test_run_of_is_well_behaved() -> None:
    """The outcome the other tests start from recognises nothing by itself."""
    assert evaluate(assignment("square"), [run_of(drive(polygon_legs(4)))]).mistakes == ()
