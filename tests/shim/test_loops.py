"""Checkpoints change nothing of a program but the first step of its loops that may never end."""

import builtins
import dis
import importlib.util
import sys
import traceback
from pathlib import Path
from typing import Any

import pytest

SOURCE = Path(__file__).resolve().parents[2] / "grader" / "shim" / "rclpy" / "_process" / "loops.py"
_spec = importlib.util.spec_from_file_location("loops_under_test", SOURCE)
assert _spec is not None
assert _spec.loader is not None
loops: Any = importlib.util.module_from_spec(_spec)
_spec.loader.exec_module(loops)


@pytest.fixture
def turns(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    count: list[int] = []
    monkeypatch.setattr(builtins, loops.CHECKPOINT, lambda: count.append(1), raising=False)
    return count


def run(source: str) -> dict[str, Any]:
    names: dict[str, Any] = {}
    exec(loops.compile_script(source.encode(), "student.py"), names)
    return names


@pytest.mark.parametrize(
    ("source", "expected"),
    [
        ("i = 0\nwhile i < 3: i += 1", 3),
        ("i = 0\nwhile i < 3:\n    i += 1\n    continue\nelse:\n    i = 9", 3),
        ("while True:\n    break", 1),
        ("def f():\n    while True:\n        return\nf(); f()", 2),
        ("class A:\n    def f(self):\n        while True:\n            break\nA().f()", 1),
        ("try:\n    1/0\nexcept ZeroDivisionError:\n    while True:\n        break", 1),
        ("try:\n    pass\nfinally:\n    while True:\n        break", 1),
        ("match 1:\n    case 1:\n        while True:\n            break", 1),
        ("if 0:\n    pass\nelse:\n    while True:\n        while True:\n            break\n        break", 2),
        ("for i in range(5): pass", 0),
        ("import itertools\nfor i in itertools.count():\n    if i == 2: break", 3),
        ("from itertools import cycle\nfor i in cycle('ab'):\n    if i == 'b': break", 2),
        ("from itertools import repeat\nfor i in repeat(0, 4): pass", 4),
        ("for i in iter([1, 0].pop, 1): pass", 1),
        ("x = 'abc'\nfor i in range(x.count('a')): pass", 0),
    ],
)
def test_each_turn_of_a_loop_that_may_never_end_is_counted(
    turns: list[int], source: str, expected: int
) -> None:
    run(source)
    assert len(turns) == expected


@pytest.mark.parametrize(
    ("catch", "told"),
    [
        ("except:", [ZeroDivisionError]),
        ("except Exception as e:", [ZeroDivisionError]),
        ("except BaseException:", [ZeroDivisionError]),
        ("except ZeroDivisionError:", []),
        ("except (Exception, ValueError):", []),
    ],
)
def test_an_except_for_any_error_tells_it(
    monkeypatch: pytest.MonkeyPatch, catch: str, told: list[type[BaseException]]
) -> None:
    seen: list[type[BaseException] | None] = []
    monkeypatch.setattr(builtins, loops.CAUGHT, lambda: seen.append(sys.exc_info()[0]), raising=False)
    names = run(f"try:\n    1 / 0\n{catch}\n    done = 1\n")
    assert (seen, names["done"]) == (told, 1)


def test_line_numbers_stay(turns: list[int]) -> None:
    source = "i = 0\nwhile i < 2:\n    i += 1\n\n    if i == 2:\n        1 / 0\n"
    with pytest.raises(ZeroDivisionError) as caught:
        run(source)
    frame = traceback.extract_tb(caught.value.__traceback__)[-1]
    assert (frame.lineno, frame.colno, frame.end_colno) == (6, 8, 13)


def test_no_line_is_added(turns: list[int]) -> None:
    source = b"i = 0\nwhile i < 2:\n    i += 1\nj = 1\n"
    plain = compile(source, "s", "exec", dont_inherit=True)
    lines = {line for _, line in dis.findlinestarts(plain) if line}
    marked = loops.compile_script(source, "s")
    assert {line for _, line in dis.findlinestarts(marked) if line} == lines


def test_a_docstring_stays_one(turns: list[int]) -> None:
    assert run('"""Doc."""\nwhile False: pass\n')["__doc__"] == "Doc."


def test_a_future_import_works(turns: list[int]) -> None:
    names = run("from __future__ import annotations\nwhile False: pass\ndef f(x: Missing): pass\n")
    assert names["f"].__annotations__ == {"x": "Missing"}


def test_nesting_too_deep_for_the_tree_is_compiled_without_checkpoints(turns: list[int]) -> None:
    names = run("x = " + "-" * 60 + "1\ny = " + " + ".join(["1"] * 900) + "\nwhile False: pass\n")
    assert names["y"] == 900


@pytest.mark.parametrize(
    "source",
    [
        "x = 'größe'".encode("latin-1").join([b"# coding: latin-1\nwhile False: pass\n", b"\n"]),
        b"\xef\xbb\xbfx = 1\r\nwhile False:\r\n    pass\r\n",
        "# -*- coding: gbk -*-\nwhile False: pass\nx = '正方形'\n".encode("gbk"),
    ],
)
def test_codings_byte_order_mark_and_line_ends_are_pythons(turns: list[int], source: bytes) -> None:
    names: dict[str, Any] = {}
    exec(loops.compile_script(source, "student.py"), names)
    assert names["x"] in ("größe", 1, "正方形")


@pytest.mark.parametrize(
    "source",
    [
        b"while True print(1)",
        b"while True: pass\nreturn 1\n",
        b"while True:\npass\n",
        b"while x = 1: pass\n",
        b"x = 1\x00while True: pass",
        b"# coding: no-such-coding\nwhile 1: pass",
        b"while 1: '\xff'",
    ],
)
def test_what_python_refuses_is_refused(source: bytes) -> None:
    with pytest.raises((SyntaxError, ValueError)):
        compile(source, "student.py", "exec", dont_inherit=True)
    with pytest.raises((SyntaxError, ValueError)):
        loops.compile_script(source, "student.py")
