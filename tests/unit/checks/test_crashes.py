"""Mistakes recognised from what ended a script."""

from dataclasses import replace
from re._parser import parse

import pytest

from grader.contracts.outcome import RunStatus, StudentError
from grader.messages.exceptions import signs
from tests.unit.checks.shipped import silent
from tests.unit.checks.trajectories import error

TWIST_CLASS = "<class 'geometry_msgs.msg._twist.Twist'>"
NO_TYPE = "isinstance() arg 2 must be a type, a tuple of types, or a union"


@pytest.mark.parametrize(
    ("problem", "code", "words"),
    [
        (
            error("AssertionError", "The 'x' field must be of type 'float'"),
            "int_in_float",
            ("17", "x", "1.0"),
        ),
        (
            error("AssertionError", "The 'linear' field must be a sub message of type 'Vector3'"),
            "message_in_field",
            ("linear", "Vector3", "msg.linear.x"),
        ),
        (
            error("TypeError", "'float' object cannot be interpreted as an integer"),
            "whole_number",
            ("range(4)",),
        ),
        (
            error("TypeError", "'str' object cannot be interpreted as an integer", "    range(input())"),
            "whole_number",
            ("int(",),
        ),
        (
            error("TypeError", "'str' object cannot be interpreted as an integer", "    time.sleep(t)"),
            "text_for_number",
            ("float(",),
        ),
        (error("RecursionError", "maximum recursion depth exceeded"), "recursion", ("17", "exceeded")),
        (error("ValueError", "generator already executing"), "two_spins", ("MultiThreadedExecutor",)),
        (error("NameError", "name 'name' is not defined"), "unknown_name", ("'name'",)),
        (error("NameError", "name 'name_' is not defined"), "unknown_name", ("'name_'",)),
        (error("AttributeError", "'Twist' object has no attribute 'liner'"), "unknown_field", ("liner",)),
        (error("AttributeError", "'Car' object has no attribute 'pub'"), "unknown_attribute", ("'pub'",)),
        (
            error("AttributeError", "module 'rclpy' has no attribute 'sleep'"),
            "ros_1_habit",
            ("17", "'sleep'", "time.sleep"),
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
        (
            error(
                "ValueError", "Failed to create action client due to invalid topic name 'a b' : topic name is"
            ),
            "bad_name",
            ("17", "'a b'"),
        ),
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
        (
            error("TypeError", "main() missing 1 required positional argument: 'args'"),
            "wrong_parameters",
            ("args",),
        ),
        (
            error("TypeError", "unsupported operand type(s) for -: 'builtin_function_or_method' and 'float'"),
            "function_not_called",
            ("time.time()",),
        ),
        (error("AttributeError", "'method' object has no attribute 'now'"), "function_not_called", ("17",)),
        (
            error("TypeError", "'method' object does not support the context manager protocol"),
            "name_taken",
            ("my_handle",),
        ),
        (
            error("TypeError", "unsupported operand type(s) for /: 'str' and 'float'"),
            "text_for_number",
            ("float(",),
        ),
        (error("TypeError", 'can only concatenate str (not "int") to str'), "text_for_number", ("f-string",)),
        (error("TypeError", ""), "no_request", ("return response",)),
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
            "import_statement",
            ("'twist' from 'geometry_msgs.msg'",),
        ),
        (
            error("AssertionError", "The 'result' field must be a sub message of type 'Move_Result'"),
            "no_result",
            ("Move.Result()",),
        ),
        (
            error("ImportError", "cannot import name 'Time' from 'std_msgs.msg' (/opt/ros/a.py)"),
            "missing_module",
            ("'Time' from 'std_msgs.msg'",),
        ),
        (error("IndexError", "list index out of range"), "index_range", ("0",)),
        (
            error("IndexError", "list index out of range", "    main(sys.argv)", "    x = sys.argv[1]"),
            "no_arguments",
            ("argparse",),
        ),
        (
            error("IndexError", "list index out of range", "    main(sys.argv[1:])", "    x = sides[4]"),
            "index_range",
            ("17",),
        ),
        (
            error("AttributeError", "'Car' object has no attribute '_logger'", "    self._logger.info('')"),
            "unknown_attribute",
            ("_logger",),
        ),
        (error("AttributeError", "'Car' object has no attribute 'method'"), "unknown_attribute", ("17",)),
        (
            error("AttributeError", "'Odometry' object has no attribute 'x'"),
            "message_fields",
            ("pose.pose.position",),
        ),
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
        (error("ModuleNotFoundError", "No module named 'cv2'"), "library_not_here", ("cv2",)),
        (error("ModuleNotFoundError", "No module named 'pynput'"), "no_terminal", ("17",)),
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
        (error("ZeroDivisionError", "division by zero"), "divided_by_zero", ("by zero", "17")),
        (
            error("TypeError", "init() takes 0 positional arguments but 1 was given", "    rclpy.init('a')"),
            "init_arguments",
            ("rclpy.init(args=args)", "Node('my_node')"),
        ),
        (
            error("TypeError", "create_node() missing 1 required positional argument: 'node_name'"),
            "no_node_name",
            ("rclpy.create_node('my_node')",),
        ),
        (
            error("TypeError", "'int' object is not iterable", "    for i in 4:"),
            "not_iterable",
            ("range(4)",),
        ),
        (
            error("TypeError", "'int' object is not iterable", "    x.declare_parameters('a', 2)"),
            "crashed",
            ("17",),
        ),
        (error("TypeError", "'Twist' object is not subscriptable"), "vector_index", ("msg.linear.x",)),
        (error("error", "Cannot load URDF file."), "urdf_not_found", ("plane.urdf",)),
        (error("error", "Not connected to physics server."), "bullet_not_connected", ("p.connect(p.GUI)",)),
        (None, "killed", ("SIGSEGV",)),
    ],
)
def test_crashes(problem: StudentError | None, code: str, words: tuple[str, ...]) -> None:
    scoring = silent(RunStatus.CRASHED, error=problem, signal="SIGSEGV")
    assert scoring.mistakes[0] == code
    assert all(word in scoring.hint.zh and word in scoring.hint.en for word in words)
    assert "/opt/ros" not in scoring.hint.zh  # where a module stands tells a student nothing
    assert ":）" not in scoring.hint.zh


@pytest.mark.parametrize(
    ("kind", "message", "code"),
    [
        ("SyntaxError", "'(' was never closed", "unbalanced"),
        ("SyntaxError", "invalid character '（' (U+FF08)", "foreign_character"),
        ("SyntaxError", "invalid non-printable character U+00A0", "foreign_character"),
        ("TabError", "inconsistent use of tabs and spaces in indentation", "indentation"),
    ],
)
def test_what_is_not_python(kind: str, message: str, code: str) -> None:
    scoring = silent(RunStatus.SYNTAX_ERROR, error=error(kind, message))
    assert scoring.mistakes == (code,)
    assert "17" in scoring.hint.zh
    assert "17" in scoring.hint.en


@pytest.mark.parametrize(
    ("line", "code"),
    [
        ("<?xml version='1.0'?>", "markup_file"),
        ("<html lang='en'>", "markup_file"),
        ("else if i > 3:", "else_if"),
        ("int main(int argc, char **argv)", "c_syntax"),
        ("In [3]: import rclpy", "pasted_mark"),
        ("%matplotlib inline", "pasted_mark"),
        ("x = a < b > > c", "syntax_error"),
        ("def move(self, speed seconds):", "missing_comma"),
        ("def move(speed=1.0, seconds turn=2):", "missing_comma"),
        ("def say(text='hello world', 3x):", "syntax_error"),
        ("def say(key=lambda x x):", "syntax_error"),
    ],
)
def test_lines_that_python_does_not_take(line: str, code: str) -> None:
    shown = f'  File "a.py", line 1\n    {line}\n    ^\nSyntaxError: invalid syntax\n'
    wrong = StudentError(type="SyntaxError", message="invalid syntax", line=1, traceback=shown)
    assert silent(RunStatus.SYNTAX_ERROR, error=wrong).mistakes == (code,)


@pytest.mark.parametrize(
    ("line", "code"),
    [
        ("x = 1，2", "foreign_character"),
        ("print（x）", "foreign_character"),
        ("前进的距离＝二", "foreign_character"),
    ],
)
def test_a_sentence_is_told_from_code_with_a_foreign_character(line: str, code: str) -> None:
    message = "invalid character '，' (U+FF0C)"
    shown = f'  File "a.py", line 1\n    {line}\n    ^\nSyntaxError: {message}\n'
    wrong = StudentError(type="SyntaxError", message=message, line=1, traceback=shown)
    assert silent(RunStatus.SYNTAX_ERROR, error=wrong).mistakes == (code,)


@pytest.mark.parametrize("line", ["```python", "$ python3 a.py", ">>> import rclpy"])
def test_what_was_copied_along_with_a_script(line: str) -> None:
    shown = f'  File "a.py", line 1\n    {line}\n    ^\nSyntaxError: invalid syntax\n'
    copied = StudentError(type="SyntaxError", message="invalid syntax", line=1, traceback=shown)
    assert silent(RunStatus.SYNTAX_ERROR, error=copied).mistakes == ("pasted_mark",)
    other = replace(copied, traceback=shown.replace(line, "x = = 1"))
    assert silent(RunStatus.SYNTAX_ERROR, error=other).mistakes == ("syntax_error",)


def test_the_most_specific_sign_of_an_exception_comes_first() -> None:
    """Of two that fit, the one that needs more text is meant; how much it needs at least, `re` itself says."""
    least = [parse(pattern).getwidth()[0] for _, pattern in signs()]
    assert least == sorted(least, reverse=True)


def test_no_sign_of_an_exception_stands_twice() -> None:
    patterns = [pattern for _, pattern in signs()]
    assert len(patterns) == len(set(patterns))
