"""What an exception means to a beginner, whether it ended the script or kept it from being compiled.

Type and text of an exception tell which code it gets; the sentence ``mistake.<code>`` says what it means.
"""

import re
from typing import Final

from grader.contracts.outcome import StudentError
from grader.contracts.text import Text
from grader.messages import say

_AT: Final = r"\n(?:.*\n)*  File .*\n(?!(?:.*\n)*  File )"
"""Stands before a pattern of the line that raised the exception: the last ``File`` entry of the traceback."""

_SIGNS: Final = tuple(
    (re.compile(pattern), code)
    for pattern, code in (
        (r"SyntaxError: invalid (non-printable )?character", "foreign_character"),
        (r"SyntaxError: invalid syntax\n.*\n +(```|\$ |>>> )", "pasted_mark"),
        (r"(IndentationError|TabError): ", "indentation"),
        (r"AssertionError: The '(?P<field>\w+)' field must be of type 'float'", "int_in_float"),
        (
            r"AssertionError: The '(?P<field>\w+)' field must be a sub message of type '(?P<owner>\w+)'",
            "message_in_field",
        ),
        (
            r"AttributeError: '(?P<owner>Twist|Vector3)' object has no attribute '(?P<field>\w+)'",
            "unknown_field",
        ),
        (
            r"TypeError: (?P<owner>Twist|Vector3|Point|Pose|Quaternion|String|Bool|U?Int\d+|Float\d+|Time|"
            r"Duration|\w+_Request|\w+_Goal)\.__init__\(\) takes 1 positional",
            "fields_by_position",
        ),
        (r"TypeError: .*(qos_profile|queue_size)", "missing_qos"),
        (r"TypeError: Expected QoSProfile or int, but received <class '(function|method)'>", "wrong_order"),
        (r"TypeError: Publisher\.publish\(\) (takes|missing) ", "one_message"),
        (r"TypeError: spin(_once|_until_future_complete)?\(\) missing .*'node'", "spin_what"),
        (
            r"TypeError: 'str' object cannot be interpreted as an integer" + _AT + r".*\bsleep\(",
            "text_for_number",
        ),
        (r"TypeError: '(float|str)' object cannot be interpreted as an integer", "whole_number"),
        (r"RecursionError: ", "recursion"),
        (r"TypeError: rclpy_resolve_name\(\)", "wrong_order"),
        (r"TypeError: isinstance\(\) arg 2 must be a type.*" + _AT + r".*\.publish\(", "wrong_order"),
        (r"AttributeError: type object '\w+' has no attribute '_TYPE_SUPPORT'", "wrong_order"),
        (r"TypeError: (rclpy_logging_rcutils_log|RcutilsLogger\.\w+)\(\)", "log_not_text"),
        (r"TypeError: Node\.__init__\(\) missing", "no_super_init"),
        (
            r"AttributeError: '\w+' object has no attribute '(_(clock|default_callback_group|logger|parameters|"
            r"parameter_overrides|publishers|rate_group|Node__\w+))'(?!.*" + _AT + r".*\.\1\b)",
            "no_super_init",
        ),
        (r"Invalid(Node|Topic|Service)NameException: |InvalidNamespaceException: ", "bad_name"),
        (r"TypeError: 'NoneType' object is not callable", "callback_called"),
        (r"(Attribute|Type)Error: 'property' object ", "class_for_object"),
        (r"TypeError: Expected .*, got <class '[\w.]*\.Metaclass_\w+'>", "class_for_object"),
        (
            r"TypeError: (?!(Node|Client|Publisher|ActionClient|Rate|Clock)\.)\w+\.\w+\(\) "
            r"(takes \d+ positional arguments? but|missing \d+ required positional)",
            "wrong_parameters",
        ),
        (r"TypeError: 'NoneType' object does not support the context manager protocol", "with_init"),
        (
            r"(AttributeError: (?=')|TypeError: (?!.*(keyword|positional) argument))"
            r"(?:(?! attribute ).)*['\"](builtin_function_or_method|function|method)['\"]",
            "function_not_called",
        ),
        (
            r"TypeError: (unsupported operand .*'str'|can only concatenate str|can't multiply sequence by|"
            r"'[<>]=?' not supported .*'str'|must be real number, not str)",
            "text_for_number",
        ),
        (r"TypeError: \n", "no_response"),  # what a service's server raises at home, without a word
        (r"AttributeError: 'NoneType' object has no attribute ", "still_none"),
        (
            r"AttributeError: property '(?P<name>clients|context|default_callback_group|guards|handle|publishers|"
            r"services|subscriptions|timers|waitables)' of '\w+' object has no setter",
            "name_taken",
        ),
        (r"AttributeError: ", "unknown_attribute"),
        (r"NameError: name '(?=(\w*_){2})_{0,3}(name|main|init)_{0,3}' is not defined", "underscores"),
        (r"NameError: ", "unknown_name"),
        (r"ModuleNotFoundError: No module named '(rospy|roslib|rosbag|roslaunch)\b", "ros_1"),
        (
            r"ModuleNotFoundError: No module named '(getch|keyboard|msvcrt|pygame|pynput|readchar)\b",
            "no_terminal",
        ),
        (r"(ModuleNotFound|Import)Error: ", "missing_module"),
        (r"NotInitializedException: ", "not_initialized"),
        (r"EOFError: ", "no_input"),
        (r"IndexError: list index out of range" + _AT + r".*\bsys\.argv\[", "no_arguments"),
        (r"error: (\(25, |setupterm:)", "no_terminal"),  # of termios and curses
        (r"TclError: ", "no_display"),
        (r"FileNotFoundError: ", "missing_file"),
        (r"OSError: \[Errno 28\]", "disk_full"),
        (r"OperationalError: unable to open database file", "no_real_file"),
        (r"OSError: \[Errno 9\] .*\n(.*\n)*.*(mmap|tofile|fromfile)", "no_real_file"),
    )
)
"""Patterns of the beginning of ``Type: message``, behind which the traceback follows, and their codes.

The first pattern that fits counts, so a special one stands before a general one of the same type.
"""


_LONGEST: Final = 200
_MODULE_PATH: Final = re.compile(r" \(/\S+\)$")
_WITHOUT_WORDS: Final = Text(zh="没有更多说明", en="without a word")


def meaning(error: StudentError, otherwise: str) -> tuple[str, Text]:
    """Return the code that fits an exception, else `otherwise`, and its sentence."""
    told = f"{error.type}: {error.message}\n{error.traceback}"
    known = ((code, sign.match(told)) for sign, code in _SIGNS)
    code, values = next(((code, found.groupdict()) for code, found in known if found), (otherwise, {}))
    problem = _first_line(error.message) or _WITHOUT_WORDS
    return code, say(f"mistake.{code}", line=error.line or "?", type=error.type, problem=problem, **values)


def _first_line(message: str) -> str:
    """Return it without the colon before further lines and the path of a module behind it."""
    line = message.strip().partition("\n")[0].rstrip(":")
    return _MODULE_PATH.sub("", line)[:_LONGEST]
