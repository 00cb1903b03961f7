"""What hints look for in a script's text, and how much of a hostile text they look at."""

import pytest

from grader.contracts.outcome import StudentError
from grader.messages.exceptions import meaning
from grader.messages.script import ScriptText


def test_a_class_without_a_base_is_found_however_it_is_spaced() -> None:
    for text in ("class Mover:", "class  Mover ( object ) :", "    class Mover\t(  )  :"):
        assert ScriptText(text).class_without_base("Mover"), text
    for text in ("class Mover(Node):", "class Movers:", "# class Mover:"):
        assert not ScriptText(text).class_without_base("Mover"), text


def test_a_hostile_line_leaves_patterns_little_to_try() -> None:
    script = ScriptText("class Mover" + " " * 20_000 + "\n" + "x" * 20_000)
    assert [len(line) for line in script.lines] == [len("class Mover "), 500]
    assert not script.class_without_base("Mover")


@pytest.mark.parametrize("source", ["x\n" * 130_000, "x" * 260_000, "def f():\n" + " exit()\n" * 30_000])
def test_a_script_longer_than_a_beginner_writes_is_not_searched(source: str) -> None:
    script = ScriptText(source)
    assert script.has_code
    assert script.lines == []
    assert script.named_only is None
    assert script.defined_twice is None


@pytest.mark.parametrize("number", [-1, 0, 4, 90_000, 10**30])
def test_lines_that_the_script_does_not_have_may_be_asked_for(number: int) -> None:
    """They come from the script's own account of itself: code that `exec` runs has others."""
    script = ScriptText("def f():\n    g()\n    h()")
    assert script.owner_of(number) is None
    assert script.function_around(number) == ""
    assert script.block(number) == []
    assert script.body(number) == []
    assert script.written(number) == ""
    assert script.conditions_around(number) == []
    assert not list(script.heads_around(number))
    assert list(script.outwards(number)) == []
    assert script.twist_name_at(number) is None
    assert not script.in_method(number)
    assert not script.is_decorated(number)
    assert not script.works_after(number)
    assert not script.calls_its_callback(number, "g")


def test_only_a_function_called_in_the_arguments_is_handed_over_wrongly() -> None:
    called = ScriptText("self.create_timer(\n    0.1,\n    self.tick())\nself.go()")
    assert called.calls_its_callback(3, "tick")
    assert not called.calls_its_callback(4, "go")
    assert not ScriptText("self.create_timer(0.1, self.tick)\nself.go()").calls_its_callback(2, "go")


def test_a_parameter_whose_default_is_meant_as_text_is_none_of_the_numbers() -> None:
    script = ScriptText("n.declare_parameter('name', 'red')\nn.declare_parameter('side', \"2.0\")")
    assert script.quoted_numbers == [2]


def test_a_definition_is_no_call() -> None:
    script = ScriptText("def usage():\n    exit()\ndef end():\n    exit()\nstart(on_error=end)")
    assert not script.calls("usage")
    assert script.calls("end")


def test_what_runs_from_a_block_are_the_functions_that_it_calls_and_those_that_they_call() -> None:
    script = ScriptText("def a():\n    n.b()\ndef b():\n    a()\ndef c():\n    spin()\nwhile x():\n    c()")
    assert script.reached_from([1]) == {1, 3}
    assert script.reached_from([7]) == {5, 7}
    assert [script.spins(number) for number in (1, 3, 7, 99)] == [False, False, True, False]


@pytest.mark.parametrize(
    ("kind", "problem", "source", "code"),
    [
        (
            "TypeError",
            "unsupported operand type(s) for *: 'tuple' and 'float'",
            "side = 2.0,",
            "comma_at_end",
        ),
        (
            "TypeError",
            "unsupported operand type(s) for -: 'tuple' and 'tuple'",
            "f(\n  a=1.0,\n  b=2.0,\n)",
            "crashed",
        ),
        ("EOFError", "EOF", "try:\n  n = int(input())\nexcept ValueError:\n  n = input()", "int_asks_again"),
        ("EOFError", "EOF", "n = int(input())\ntry: f()\nexcept KeyboardInterrupt: pass", "no_input"),
    ],
)
def test_a_cause_is_told_only_where_the_script_shows_it(
    kind: str, problem: str, source: str, code: str
) -> None:
    error = StudentError(type=kind, message=problem, line=1, traceback="")
    assert meaning(error, "crashed", ScriptText(source))[0] == code


@pytest.mark.parametrize(
    ("number", "behind"),
    [
        (3, True),
        (5, False),
        (7, False),
        (8, True),
        (10, True),  # under a condition of its own, though it reads like that of the first line
        (12, True),
    ],
)
def test_a_line_in_another_branch_does_not_run_behind_it(number: int, behind: bool) -> None:
    source = (
        "if a:\n    first()\n    x()\nelif b:\n    x()\nelse:\n    x()\nx()\nif a:\n    x()\nelse:\n    x()\n"
    )
    assert ScriptText(source).is_behind(number, 2) is behind
