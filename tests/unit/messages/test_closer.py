"""What the text of a script shows about an exception, and where it must show nothing."""

import pytest

from grader.contracts.outcome import StudentError
from grader.messages.exceptions import meaning
from grader.messages.script import ScriptText


def told(kind: str, message: str, source: str, line: int, more: str = "") -> tuple[str, str]:
    """Return code and English text for an exception that the given line of `source` raised."""
    written = source.split("\n")[line - 1].strip()
    shown = f'Traceback (most recent call last):\n  File "script.py", line {line}, in f\n    {written}\n'
    error = StudentError(type=kind, message=message, line=line, traceback=f"{shown}{kind}: {message}{more}")
    code, text = meaning(error, "crashed", ScriptText(source))
    assert text.zh
    return code, text.en


@pytest.mark.parametrize(
    ("name", "wanted"),
    [
        ("tiem", "time"),
        ("maht", "math"),
        ("jsno", "json"),
        ("datetme", "datetime"),
        ("turtlsim", "turtlesim"),
    ],
)
def test_a_misspelt_module_is_no_other_file_of_the_author(name: str, wanted: str) -> None:
    code, text = told("ModuleNotFoundError", f"No module named '{name}'", f"import {name}", 1)
    assert code == "misspelt"
    assert f"'{wanted}'" in text


def test_an_unknown_module_may_be_another_file_of_the_author() -> None:
    assert told("ModuleNotFoundError", "No module named 'helper'", "import helper", 1)[0] == "own_module"


def test_a_misspelt_field_of_a_response_names_its_type() -> None:
    message = "'Move_Response' object has no attribute 'sucess'"
    code, text = told("AttributeError", message, "r.sucess = True", 1, ". Did you mean: 'success'?")
    assert code == "misspelt_field"
    assert "Move_Response has no field sucess; it is called success" in text


LIST = "def f():\n    xs = {made}\n    for i in range(4):\n        print(xs[i])\n"
RANGE = "list index out of range"


def test_a_list_is_too_short_for_the_loop_around() -> None:
    assert told("IndexError", RANGE, LIST.format(made="[1, 2, 3]"), 4)[0] == "list_too_short"


@pytest.mark.parametrize(
    "source",
    [
        LIST.format(made="[P(0, 0)]"),
        LIST.format(made="[]") + "    xs.append(1)\n",
        LIST.format(made="[1, 2]") + "    xs += [3]\n",
        "xs = [1]\n\n\nprint(xs[i])\nfor i in range(9):\n    pass\n",
    ],
)
def test_no_length_of_a_list_is_told_that_its_line_does_not_show(source: str) -> None:
    assert told("IndexError", RANGE, source, 4)[0] == "index_range"


@pytest.mark.parametrize(
    ("above", "parameters", "message"),
    [
        ("@staticmethod", "a, b", "missing 1 required positional argument: 'b'"),
        ("@staticmethod", "a", "takes 1 positional argument but 2 were given"),
        ("@classmethod", "cls", "takes 1 positional argument but 2 were given"),
        ("pass", "this, t", "takes 2 positional arguments but 3 were given"),
    ],
)
def test_a_method_without_self_that_needs_none_is_not_told_to_lack_it(
    above: str, parameters: str, message: str
) -> None:
    source = f"class A:\n    {above}\n    def go({parameters}):\n        pass\nA().go(1, 2)\n"
    assert told("TypeError", f"A.go() {message}", source, 5)[0] == "wrong_parameters"


def test_a_method_without_self_is_told_to_lack_it() -> None:
    source = "class A:\n    def go(t):\n        pass\nA().go(1)\n"
    assert (
        told("TypeError", "A.go() takes 1 positional argument but 2 were given", source, 4)[0] == "lacks_self"
    )


def test_a_callback_that_reads_as_it_should_is_not_told_to_be_changed() -> None:
    source = (
        "class A(Node):\n    def __init__(self):\n        self.create_timer(0.1, self.go)\n"
        "        self.create_subscription(Pose, '/p', self.go, 10)\n    def go(self):\n        pass\nspin(n)\n"
    )
    code, _ = told("TypeError", "A.go() takes 1 positional argument but 2 were given", source, 7)
    assert code != "timer_callback"


NONE = "'NoneType' object has no attribute 'x'"
INIT = "class A(Node):\n    def __init__(self):\n        self.{name} = {value}\n        {line}\n"


@pytest.mark.parametrize(("value", "code"), [("self.get_logger()", "still_none"), ("'a'", "private_taken")])
def test_a_value_of_node_that_is_kept_under_its_own_name_is_not_taken(value: str, code: str) -> None:
    source = INIT.format(name="_logger", value=value, line="self.get_logger().info(self.a.x)")
    assert told("AttributeError", NONE, source, 4)[0] == code


@pytest.mark.parametrize(("given", "code"), [("pose", "none_in_init"), ("other", "still_none")])
def test_a_value_that_no_message_brings_is_not_told_to_wait_for_one(given: str, code: str) -> None:
    source = INIT.format(name="pose", value="None", line="self.y = self.pose.x") + (
        f"        self.create_subscription(Pose, '/p', self.cb, 10)\n"
        f"    def cb(self, msg):\n        self.{given} = msg\n"
    )
    assert told("AttributeError", NONE, source, 4)[0] == code


@pytest.mark.parametrize(
    ("line", "code"),
    [("x = 3 – 2", "dash_for_minus"), ("x = –2", "dash_for_minus"), ("第一步 — 初始化", "foreign_character")],
)
def test_a_dash_in_words_is_no_minus_sign(line: str, code: str) -> None:
    number = "U+2014" if "—" in line else "U+2013"
    assert told("SyntaxError", f"invalid character '—' ({number}) (script.py, line 1)", line, 1)[0] == code


@pytest.mark.parametrize(
    ("parameters", "code"),
    [
        ("self, response, request", "handler_order"),
        ("res, req", "handler_order"),
        ("self, request, response", "unknown_part"),
    ],
)
def test_a_handler_with_its_parameters_exchanged_is_told(parameters: str, code: str) -> None:
    source = f"def handle({parameters}):\n    response.names = []\n    return response\n"
    message = "'GetNames_Request' object has no attribute 'names'"
    assert told("AttributeError", message, source, 2)[0] == code
