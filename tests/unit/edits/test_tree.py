"""Edits of a script's own text: only what they name changes, whatever characters stand before it."""

import ast

import pytest

from grader.edits.tree import ChangedLine, Edit, ParsedScript, applied, changed_lines


def number(script: ParsedScript, value: float) -> ast.Constant:
    return next(
        node for node in ast.walk(script.tree) if isinstance(node, ast.Constant) and node.value == value
    )


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_a_replaced_number_leaves_the_rest_as_it_was(end: str) -> None:
    text = f"速度 = '快'; t = 1.0  # 一秒{end}go( t,2.0 )  # 二{end}"
    script = ParsedScript.parsed(text)
    changed = applied(text, [script.replaced(number(script, 2.0), "4.0")])
    assert changed == text.replace("2.0", "4.0")
    assert applied(text, [script.replaced(number(script, 1.0), "x")]) == text.replace("1.0", "x")


def test_lines_are_added_with_the_indentation_of_their_neighbour() -> None:
    script = ParsedScript.parsed("if a:\n\tgo()\nend()")
    (inner,) = script.statements_on(2)
    assert applied(script.text, [script.inserted_after(inner, "stop()")]) == "if a:\n\tgo()\n\tstop()\nend()"
    (last,) = script.statements_on(3)
    assert applied(script.text, [script.inserted_after(last, "stop()")]) == "if a:\n\tgo()\nend()\nstop()\n"
    assert applied(script.text, [script.inserted_before(last, "x = 1")]) == "if a:\n\tgo()\nx = 1\nend()"


def test_a_removed_statement_leaves_a_block_that_is_python() -> None:
    script = ParsedScript.parsed("for i in x:\n    go()\nend(); more()\nlast()\n")
    (only,) = script.statements_on(2)
    assert applied(script.text, [script.removed(only)]) == "for i in x:\n    pass\nend(); more()\nlast()\n"
    first, _ = script.statements_on(3)
    assert "pass; more()" in applied(script.text, [script.removed(first)])
    (last,) = script.statements_on(4)
    assert applied(script.text, [script.removed(last)]) == "for i in x:\n    go()\nend(); more()\n"


def test_edits_that_overlap_are_refused() -> None:
    with pytest.raises(ValueError, match="overlap"):
        applied("abc", [Edit(0, 2, ""), Edit(1, 3, "")])
    with pytest.raises(ValueError, match="outside"):
        applied("abc", [Edit(2, 4, "")])


def test_changed_lines_name_the_line_and_both_texts() -> None:
    before = "a\nb\nc"
    assert changed_lines(before, "a\nB\nc") == (ChangedLine(2, "b", "B"),)
    assert changed_lines(before, "a\nb\nnew\nc") == (ChangedLine(2, None, "new"),)
    assert changed_lines(before, "a\nc") == (ChangedLine(2, "b", None),)


def test_a_node_without_a_place_in_the_text_is_refused() -> None:
    script = ParsedScript("a = 1\n", ast.parse("\n\n\n\nb = 2\n"))
    with pytest.raises(ValueError, match="line 5"):
        script.source(script.tree.body[0])
