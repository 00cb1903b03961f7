"""Facts from the jail: what the shim writes is read as it was, and all else is refused."""

import ast
import importlib.util
import json
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

import grader
from grader.contracts.errors import ProtocolError
from grader.edits.received import received_ledger, received_script

ROOT = Path(__file__).resolve().parents[3]
SCRIPTS = sorted((ROOT / "lesson").glob("*.py")) + sorted(
    (ROOT / "assignments" / "square" / "wrong").glob("*.py")
)
ODD = (
    "f = lambda x: x if x else -1\nd = {1: 2}\nasync def g(a, /, *b, c=1, **k): return [i for i in a if i]\n"
)


SHIM = Path(grader.__file__).parent / "shim" / "rclpy" / "_process" / "tree.py"
_spec = importlib.util.spec_from_file_location("tree_under_test", SHIM)
assert _spec is not None
assert _spec.loader is not None
tree = importlib.util.module_from_spec(_spec)
_spec.loader.exec_module(tree)


def rows_of(source: str) -> bytes:
    rows = tree.tree_rows(source.encode(), "script.py")
    return json.dumps(rows).encode() if rows else b""


@pytest.mark.parametrize(
    "source",
    [*(path.read_text(encoding="utf-8") for path in SCRIPTS), ODD, "", "match a:\n  case [1, *_]: pass\n"],
)
def test_a_tree_arrives_as_python_makes_it(source: str) -> None:
    script = received_script(source, rows_of(source))
    assert script is not None
    assert ast.unparse(script.tree) == ast.unparse(ast.parse(source))


def test_what_is_no_python_or_too_large_brings_no_tree() -> None:
    assert rows_of("for") == b""
    assert rows_of("x = [" + "1," * 30_000 + "]") == b""
    assert received_script("x", b"") is None


MODULE = ["Module", -1, "", None, {}]


@pytest.mark.parametrize(
    "rows",
    [
        [],
        [["Pass", -1, "", [1, 0, 1, 4], {}]],
        [MODULE, ["Pass", 5, "body", [1, 0, 1, 4], {}]],
        [MODULE, ["Pass", 0, "nothing", [1, 0, 1, 4], {}]],
        [MODULE, ["Pass", 0, "body", None, {}]],
        [MODULE, ["Pass", 0, "body", [99, 0, 99, 4], {}]],
        [MODULE, ["Pass", 0, "body", [1, 4, 1, 0], {}]],
        [MODULE, ["Expr", 0, "body", [1, 0, 1, 1], {}], ["Name", 1, "value", [1, 0, 1, 1], {"id": 7}]],
        [
            MODULE,
            ["Expr", 0, "body", [1, 0, 1, 1], {}],
            *[["Name", 1, "value", [1, 0, 1, 1], {"id": "a"}]] * 2,
        ],
        [MODULE, ["NodeVisitor", 0, "body", [1, 0, 1, 1], {}]],
        [MODULE, ["Pass", 0, "body", [1, 0, 1, 4], {"__class__": "x"}]],
        {"a": 1},
    ],
)
def test_what_is_no_tree_of_the_text_is_refused(rows: object) -> None:
    with pytest.raises(ProtocolError, match="FACTS"):
        received_script("pass\n", json.dumps(rows).encode())


@given(st.binary(max_size=200))
def test_bytes_are_a_ledger_or_refused(content: bytes) -> None:
    try:
        received_ledger(content)
    except ProtocolError:
        return
    assert content == b"" or json.loads(content) is not None


def test_a_ledger_with_too_much_in_it_is_refused() -> None:
    with pytest.raises(ProtocolError):
        received_ledger(b'{"ran": [1], "motions": [], "end": [], "points": 100}')
    with pytest.raises(ProtocolError):
        received_ledger(b"[" * 100_000)
