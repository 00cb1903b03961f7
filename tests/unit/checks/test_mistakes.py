"""Mistakes recognised from the outcome and the commands; what holds for every mistake."""

import ast
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from grader.checks import evaluate, mistakes
from grader.contracts.outcome import Endpoint, Note, RunOutcome, RunStatus, Stream, StudentError
from grader.contracts.trajectory import Trajectory
from grader.contracts.verdict import Run, Verdict
from grader.messages import exceptions
from tests.unit.checks.ideal_turtle import drive, outcome_of, polygon_legs, run_of
from tests.unit.checks.shipped import assignment, graded, score
from tests.unit.messages.catalogs import catalog_texts

TWIST = "geometry_msgs/msg/Twist"
TWIST_CLASS = "<class 'geometry_msgs.msg._twist.Twist'>"
AT_REST = drive([(2.0, 0.0, 0.0)])


def silent(status: RunStatus = RunStatus.FINISHED, **changes: object) -> Verdict:
    values: dict[str, object] = {"status": status, "duration_ns": 1_000, "nodes": ("/mover",), **changes}
    trajectory = drive([], horizon_s=2.0)
    outcome = RunOutcome(**values)  # type: ignore[arg-type]
    return evaluate(assignment("square"), [Run(trajectory=trajectory, outcome=outcome)])


def publisher(name: str = "/turtle1/cmd_vel", kind: str = TWIST) -> Endpoint:
    return Endpoint(kind="publisher", node="/mover", name=name, type=kind)


def error(kind: str, message: str, *lines: str) -> StudentError:
    frames = "".join(f'  File "a.py", line 17, in f\n{line}\n         ^^^^^\n' for line in lines)
    return StudentError(type=kind, message=message, line=17, traceback=f"T\n{frames}{kind}: {message}\n")


NO_TYPE = "isinstance() arg 2 must be a type, a tuple of types, or a union"


@pytest.mark.parametrize(
    ("problem", "code", "words"),
    [
        (
            error("AssertionError", "The 'x' field must be of type 'float'"),
            "int_in_float",
            ("17", "x", "1.0"),
        ),
        (error("AttributeError", "'Twist' object has no attribute 'liner'"), "unknown_field", ("liner",)),
        (
            error("TypeError", "Vector3.__init__() takes 1 positional argument but 4 were given"),
            "fields_by_position",
            ("x=1.0",),
        ),
        (error("AttributeError", "'Car' object has no attribute 'pub'"), "unknown_attribute", ("'pub'",)),
        (
            error("AttributeError", "module 'rclpy' has no attribute 'sleep'"),
            "unknown_attribute",
            ("17", "'sleep'"),
        ),
        (error("AttributeError", "'NoneType' object has no attribute 'theta'"), "still_none", ("is None",)),
        (
            error("AttributeError", "property 'timers' of 'Car' object has no setter"),
            "name_taken",
            ("my_timers",),
        ),
        (error("AttributeError", "'Car' object has no attribute '_logger'"), "no_super_init", ("super()",)),
        (
            error("TypeError", "Node.__init__() missing 1 required positional argument: 'node_name'"),
            "no_super_init",
            ("17",),
        ),
        (
            error("InvalidTopicNameException", "Invalid topic name: must not:\n 'a b'\n   ^"),
            "bad_name",
            ("must not",),
        ),
        (error("TypeError", "'NoneType' object is not callable"), "callback_called", ("create_timer",)),
        (error("TypeError", "'property' object is not iterable"), "class_for_object", ("Twist()",)),
        (error("AttributeError", "'property' object has no attribute 'x'"), "class_for_object", ("Twist()",)),
        (
            error("TypeError", f"Expected {TWIST_CLASS}, got {TWIST_CLASS.replace('.T', '.Metaclass_T')}"),
            "class_for_object",
            ("17",),
        ),
        (error("TypeError", f"Expected {TWIST_CLASS}, got <class 'str'>"), "crashed", ("str",)),
        (
            error("TypeError", "Car.tick() takes 0 positional arguments but 1 was given"),
            "wrong_parameters",
            ("self",),
        ),
        (error("TypeError", "main() missing 1 required positional argument: 'args'"), "crashed", ("args",)),
        (
            error("TypeError", "Node.create_timer() missing 1 required positional argument: 'callback'"),
            "crashed",
            ("callback",),
        ),
        (
            error("TypeError", "Duration.__init__() takes 1 positional argument but 2 were given"),
            "fields_by_position",
            ("seconds=1.0",),
        ),
        (
            error("TypeError", "unsupported operand type(s) for -: 'builtin_function_or_method' and 'float'"),
            "function_not_called",
            ("time.time()",),
        ),
        (error("AttributeError", "'method' object has no attribute 'now'"), "function_not_called", ("17",)),
        (
            error("TypeError", "unsupported operand type(s) for /: 'str' and 'float'"),
            "text_for_number",
            ("float(",),
        ),
        (error("TypeError", 'can only concatenate str (not "int") to str'), "text_for_number", ("f-string",)),
        (
            error("TypeError", "'NoneType' object does not support the context manager protocol"),
            "with_init",
            ("with rclpy.init()", "Humble"),
        ),
        (error("TypeError", ""), "no_response", ("return response",)),
        (
            error("TypeError", "RcutilsLogger.info() takes 2 positional arguments but 3 were given"),
            "log_not_text",
            ("{x}",),
        ),
        (
            error("TypeError", "rclpy_resolve_name(): incompatible function arguments."),
            "wrong_order",
            ("17",),
        ),
        (
            error("TypeError", "Expected QoSProfile or int, but received <class 'method'>"),
            "wrong_order",
            ("Pose",),
        ),
        (
            error("ImportError", "cannot import name 'twist' from 'geometry_msgs.msg' (/opt/ros/a.py)"),
            "missing_module",
            ("'twist' from 'geometry_msgs.msg'",),
        ),
        (error("IndexError", "list index out of range"), "crashed", ("IndexError",)),
        (
            error("IndexError", "list index out of range", "    main(sys.argv)", "    x = sys.argv[1]"),
            "no_arguments",
            ("argparse",),
        ),
        (
            error("IndexError", "list index out of range", "    main(sys.argv[1:])", "    x = sides[4]"),
            "crashed",
            ("IndexError",),
        ),
        (
            error("AttributeError", "'Car' object has no attribute '_logger'", "    self._logger.info('')"),
            "unknown_attribute",
            ("_logger",),
        ),
        (error("AttributeError", "'Car' object has no attribute 'method'"), "unknown_attribute", ("17",)),
        (
            error("AttributeError", "property 'speed' of 'Car' object has no setter"),
            "unknown_attribute",
            ("speed",),
        ),
        (error("TypeError", "f() got an unexpected keyword argument 'method'"), "crashed", ("'method'",)),
        (error("TypeError", NO_TYPE, "    self.pub.publish(msg)"), "wrong_order", ("17",)),
        (error("TypeError", NO_TYPE, "    if isinstance(x, 'int'):"), "crashed", ("isinstance()",)),
        (error("OperationalError", "unable to open database file"), "no_real_file", ("np.save",)),
        (
            replace(error("OSError", "[Errno 9] Bad file descriptor"), traceback="T\n  a.tofile('a')\n"),
            "no_real_file",
            ("np.tofile",),
        ),
        (error("OSError", "[Errno 9] Bad file descriptor"), "crashed", ("OSError",)),
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
        (error("ValueError", ""), "crashed", ("ValueError: ",)),
        (error("ZeroDivisionError", "division by zero"), "crashed", ("ZeroDivisionError", "17")),
        (None, "killed", ("SIGSEGV",)),
    ],
)
def test_crashes(problem: StudentError | None, code: str, words: tuple[str, ...]) -> None:
    verdict = silent(RunStatus.CRASHED, error=problem, signal="SIGSEGV")
    assert verdict.mistakes[0] == code
    assert all(word in verdict.hint.zh and word in verdict.hint.en for word in words)
    assert "/opt/ros" not in verdict.hint.zh  # where a module stands tells a student nothing
    assert ":）" not in verdict.hint.zh


@pytest.mark.parametrize(
    ("kind", "message", "code"),
    [
        ("SyntaxError", "'(' was never closed", "syntax_error"),
        ("SyntaxError", "invalid character '（' (U+FF08)", "foreign_character"),
        ("SyntaxError", "invalid non-printable character U+00A0", "foreign_character"),
        ("TabError", "inconsistent use of tabs and spaces in indentation", "indentation"),
    ],
)
def test_what_is_not_python(kind: str, message: str, code: str) -> None:
    verdict = silent(RunStatus.SYNTAX_ERROR, error=error(kind, message))
    assert verdict.mistakes == (code,)
    assert "17" in verdict.hint.zh
    assert "17" in verdict.hint.en


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


def test_what_ended_a_thread_is_explained_as_well() -> None:
    text = "Thread-1 (go), line 9: AssertionError: The 'x' field must be of type 'float'"
    hint = silent(notes=(Note(code="thread_exception", text=text),)).hint
    assert text in hint.zh
    assert "第 9 行：字段 x 必须是浮点数" in hint.zh
    assert ". Line 9: the field x must be a float" in hint.en


def test_sideways() -> None:
    assert graded("square", AT_REST, notes=(Note(code="lateral_command"),)).mistakes == ("sideways",)


def test_zero_and_infinite_commands() -> None:
    assert graded("square", AT_REST).mistakes == ("zero_commands",)
    assert graded("square", AT_REST, nonfinite_commands=3).mistakes == ("nonfinite_commands",)


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
    files = [*Path(mistakes.__file__).parent.glob("*.py"), Path(exceptions.__file__)]
    strings = {
        node.value
        for path in files
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
