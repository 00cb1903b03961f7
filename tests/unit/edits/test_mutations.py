"""Single edits of a script, and what a rubric sees of them."""

import ast

import pytest

from grader.edits.mutations import mutants
from grader.edits.tree import ParsedScript

SCRIPT = '''"""A text."""
import time

def run(node):
    """Drive."""
    speed = 0.5
    for _ in range(4):
        node.drive(speed)
        time.sleep(0.0)
    node.stop()
'''


def changes(text: str) -> list[str]:
    return [one.change for one in mutants(ParsedScript.parsed(text))]


def test_numbers_are_scaled_and_counts_are_one_off() -> None:
    assert [one for one in changes(SCRIPT) if "->" in one and "<" not in one] == [
        "0.5 -> 1.0", "0.5 -> 0.25", "0.5 -> 0.55", "4 -> 5", "4 -> 3", "0.0 -> 0.1",
    ]  # fmt: skip


def test_statements_are_removed_and_swapped_and_texts_are_not() -> None:
    removed = ["- speed = 0.5", "- node.drive(speed)", "- time.sleep(0.0)", "- node.stop()"]
    assert [one for one in changes(SCRIPT) if one.startswith("-")] == removed
    assert "node.drive(speed) <-> time.sleep(0.0)" in changes(SCRIPT)


@pytest.mark.parametrize("text", [SCRIPT, "x = True\n", "while 1:\n    go(-2.5)\n", ""])
def test_each_mutant_is_another_program_and_they_come_in_one_order(text: str) -> None:
    script = ParsedScript.parsed(text)
    found = list(mutants(script))
    assert found == list(mutants(script))
    for one in found:
        assert ast.dump(ast.parse(one.text)) != ast.dump(script.tree)
