"""Values of simple expressions in a script: numbers, names that are assigned once, the four operations.

Nothing is run, and a student's text is not given to Python's parser. This reads the little that a hint needs; the
value of anything else is None. A parameter has a value if every call gives it the same.
"""

import math
import re
from collections.abc import Callable
from typing import Final

from grader.messages.script import ScriptText

_TOKENS: Final = re.compile(r" ?(//|[-+*/()]|\d[\d_]*\.?\d*(?:[eE][-+]?\d+)?|\.\d+|[A-Za-z_][\w.]*)")
_LONGEST: Final = 120
_DEEPEST: Final = 6
_CONSTANTS: Final = {"math.pi": math.pi, "pi": math.pi, "np.pi": math.pi, "math.tau": math.tau}
_FUNCTIONS: Final[dict[str, Callable[[float], float]]] = {
    "abs": abs,
    "float": float,
    "int": math.trunc,
    "round": round,
    "math.degrees": math.degrees,
    "math.radians": math.radians,
}


def value_of(written: str, script: ScriptText, depth: int = 0) -> float | None:
    """Return the value of an expression, or None if it cannot be told from the text."""
    tokens = _TOKENS.findall(written)
    if len(written) > _LONGEST or depth > _DEEPEST or "".join(tokens) != written.replace(" ", ""):
        return None
    try:
        return _Reader(tokens, script, depth).whole()
    except (ArithmeticError, LookupError, ValueError):
        return None


class _Reader:
    """Reads one expression, token by token; `LookupError` where it cannot."""

    def __init__(self, tokens: list[str], script: ScriptText, depth: int) -> None:
        self._tokens, self._script, self._depth = [*tokens, ""], script, depth

    def whole(self) -> float:
        value = self._sum()
        if self._tokens != [""]:
            raise LookupError
        return value

    def _sum(self) -> float:
        value = self._product()
        while self._tokens[0] in ("+", "-"):
            sign = -1.0 if self._tokens.pop(0) == "-" else 1.0
            value += sign * self._product()
        return value

    def _product(self) -> float:
        value = self._factor()
        while self._tokens[0] in ("*", "/", "//"):
            match self._tokens.pop(0):
                case "*":
                    value *= self._factor()
                case "/":
                    value /= self._factor()
                case _:
                    value //= self._factor()
        return value

    def _factor(self) -> float:
        part = self._tokens.pop(0)
        if part == "-":
            return -self._factor()
        if part == "(" or (part in _FUNCTIONS and self._tokens[0] == "("):
            if part != "(":
                self._tokens.pop(0)
            value = self._sum()
            if self._tokens.pop(0) != ")":
                raise LookupError
            return value if part == "(" else float(_FUNCTIONS[part](value))
        if part[:1].isdigit() or part[:1] == ".":
            return float(part)
        if part in _CONSTANTS:
            return _CONSTANTS[part]
        return self._named(part)

    def _named(self, name: str) -> float:
        owner, _, own = name.rpartition(".")
        assigned = self._script.assigned(own) if owner in ("", "self", self._script.node_class) else None
        written = assigned.value if assigned else self._script.argument_for(own) if not owner else None
        known = self._script.known_values
        if own not in known:
            known[own] = None  # a name that leads back to itself has no value
            known[own] = None if written is None else value_of(written, self._script, self._depth + 1)
        value = known[own] if written else None
        if value is None:
            raise LookupError
        return value
