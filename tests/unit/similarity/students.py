"""Students' scripts: the lesson's square with something of one's own, and copies that do not look like copies."""

import ast
import io
import keyword
import random
import tokenize
from collections.abc import Callable
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
SQUARE = (ROOT / "lesson" / "square_mover.py").read_text()


def commented(source: str) -> str:
    """The script with a comment and a blank line before every statement's line."""
    tree = ast.parse(source)
    starts = {node.lineno for node in ast.walk(tree) if isinstance(node, ast.stmt)}
    lines = source.splitlines()
    return "\n".join(
        f"\n# 第 {i} 行\n{line}  # here" if i in starts else line for i, line in enumerate(lines, 1)
    )


def renamed(source: str) -> str:
    """The script with other names, numbers and strings everywhere: equal in form, no longer in meaning."""
    tokens = []
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        text = token.string
        if token.type == tokenize.NAME and not keyword.iskeyword(text):
            text = f"变量_{text}"
        elif token.type == tokenize.NUMBER:
            text = "0.125"
        elif token.type == tokenize.STRING:
            text = "'another'"
        tokens.append((token.type, text))
    return tokenize.untokenize(tokens)


def reordered(source: str) -> str:
    """The script as `ast.unparse` writes it, with the methods of every class in reverse order."""
    tree = ast.parse(source)
    for node in ast.walk(tree):
        if isinstance(node, ast.ClassDef):
            node.body = [one for one in node.body if not isinstance(one, ast.FunctionDef)] + [
                one for one in reversed(node.body) if isinstance(one, ast.FunctionDef)
            ]
    return ast.unparse(tree)


def reformatted(source: str) -> str:
    """The script with two spaces and a tab for four spaces, other line ends, and brackets over several lines."""
    wide = source.replace("    ", "  \t")
    return wide.replace("(self)", "(\n  self,\n)").replace("\n", "\r\n")


DISGUISES: dict[str, Callable[[str], str]] = {
    "commented": commented,
    "renamed": renamed,
    "reordered": reordered,
    "reformatted": reformatted,
}


def expression(dice: random.Random, depth: int) -> str:
    """An expression whose form differs from one state of the dice to the next."""
    if depth == 0:
        return dice.choice(("self.a", "b", "3", "'c'", "self.d()", "None"))
    one, other, third = (expression(dice, dice.randrange(depth)) for _ in range(3))
    forms = (
        f"{one} {dice.choice(('+', '-', '*', '//', '%', '<<', 'and', 'or', 'is', '<', '!='))} {other}",
        f"f({one}, {other}, key={third})",
        f"[{one}, {other}][{third}]",
        f"({one} if {other} else {third})",
        f"{{{one}: {other}}}",
        f"(not {one})",
    )
    return dice.choice(forms)


def own_code(number: int) -> str:
    """A method that only this number has: what a student thought of."""
    dice = random.Random(number)
    lines = "".join(f"        self.v{i} = {expression(dice, 4)}\n" for i in range(12))
    return f"\n    def own(self):\n{lines}\n"


def changed_square(number: int) -> str:
    """The lesson's listing with a method of one's own."""
    return SQUARE.replace("\ndef main(", own_code(number) + "\n\ndef main(")
