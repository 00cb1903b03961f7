"""Between a recording and its report nothing is computed whose last bit depends on the processor or a version."""

import ast
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PACKAGES = ("geometry", "checks")
ARITHMETIC = ROOT / "grader" / "geometry" / "exact.py"
TRANSCENDENTAL = frozenset({
    "sin", "cos", "tan", "asin", "acos", "atan", "atan2", "arcsin", "arccos", "arctan", "arctan2", "sinh", "cosh",
    "tanh", "sinc", "exp", "expm1", "exp2", "log", "log2", "log10", "log1p", "pow", "power", "float_power", "cbrt",
    "hypot", "dist", "angle",
})  # fmt: skip
BLAS = frozenset({
    "dot", "vdot", "inner", "outer", "matmul", "tensordot", "einsum", "convolve", "correlate", "linalg", "fft",
    "polyfit", "interp", "trapz", "trapezoid", "cov", "corrcoef", "var", "std",
})  # fmt: skip
OF_FLOATS = ("_m", "_rad", "_deg", "_s", "_mps", "_radps", "_share", "points", "earned")
"""How names of numbers with a unit end: built-in ``sum`` adds such numbers otherwise from Python 3.12 on."""


def forbidden(tree: ast.AST) -> Iterator[tuple[int, str]]:
    """Yield line and name of what must be computed by `grader.geometry.exact`."""
    for node in ast.walk(tree):
        match node:
            case ast.Attribute(value=ast.Name(id="np" | "numpy" | "math" | "cmath" as module), attr=name):
                if module == "cmath" or name in TRANSCENDENTAL or (module != "math" and name in BLAS):
                    yield node.lineno, f"{module}.{name}"
            case ast.ImportFrom(module="math" | "cmath" | "numpy" | "numpy.linalg" as module):
                yield from ((node.lineno, f"{module}.{one.name}") for one in node.names)
            case ast.BinOp(op=ast.MatMult()):
                yield node.lineno, "@"
            case ast.BinOp(left=left, op=ast.Pow(), right=right) if not _is_exact_power(left, right):
                yield node.lineno, "**"
            case ast.Call(func=ast.Name(id="sum"), args=[summed, *_]) if _are_floats(summed):
                yield node.lineno, "sum of floats"


def _is_exact_power(left: ast.expr, right: ast.expr) -> bool:
    """Whether it is a square, or a number that the compiler works out."""
    return ast.unparse(right) == "2" or ast.unparse(left) == "2.0"


def _are_floats(summed: ast.expr) -> bool:
    each = summed.elt if isinstance(summed, ast.GeneratorExp) else summed
    return not isinstance(each, ast.Compare) and any(map(_is_float, ast.walk(each)))


def _is_float(node: ast.AST) -> bool:
    name = node.id if isinstance(node, ast.Name) else node.attr if isinstance(node, ast.Attribute) else ""
    return name.endswith(OF_FLOATS)


def test_only_exact_arithmetic_lies_between_a_recording_and_its_report() -> None:
    found = [
        f"{path.relative_to(ROOT)}:{line}: {name}"
        for package in PACKAGES
        for path in sorted((ROOT / "grader" / package).rglob("*.py"))
        if path != ARITHMETIC
        for line, name in forbidden(ast.parse(path.read_text("utf-8")))
    ]
    assert not found, "use grader.geometry.exact:\n" + "\n".join(found)


def test_what_differs_between_processors_is_recognised() -> None:
    source = """
np.dot(a, b), np.linalg.lstsq(a, b), np.sin(a), math.atan2(y, x), math.hypot(x, y), np.interp(a, b, c)
a @ b, x ** 0.5, cmath.phase(z), sum(self.sides_m), np.angle(z)
math.sqrt(x), math.fsum(x), x ** 2, np.sqrt(a), sum(before < after for before, after in pairs), np.abs(a)
"""
    lines = [line for line, _ in forbidden(ast.parse(source))]
    assert (lines.count(2), lines.count(3), lines.count(4)) == (6, 5, 0)
