"""No module needs another one that needs it, not even by an import inside a function or for a type."""

import ast
from collections.abc import Iterator
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

GRADER = Path(__file__).resolve().parents[2] / "grader"
SHIM = GRADER / "shim"


def modules() -> dict[str, Path]:
    """Return the modules of the grader and of the shim, whose packages are at the top for scripts."""
    paths = {path: GRADER.parent for path in GRADER.rglob("*.py") if SHIM not in path.parents}
    paths |= dict.fromkeys(SHIM.rglob("*.py"), SHIM)
    return {
        ".".join(path.relative_to(root).with_suffix("").parts).removesuffix(".__init__"): path
        for path, root in paths.items()
    }


def imports(path: Path, known: dict[str, Path]) -> Iterator[str]:
    """Yield the modules that one imports, wherever it does."""
    for node in ast.walk(ast.parse(path.read_bytes())):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names if alias.name in known)
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            for alias in node.names:
                of_package = f"{node.module}.{alias.name}"
                yield from (
                    name for name in (of_package, node.module)[of_package not in known :][:1] if name in known
                )


def circle(graph: dict[str, set[str]]) -> list[str]:
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        found: list[str] = error.args[1]
        return found
    return []


def test_no_imports_run_in_a_circle() -> None:
    known = modules()
    graph = {name: set(imports(path, known)) - {name} for name, path in known.items()}
    assert len(graph) > 600
    assert sum(map(len, graph.values())) > 3_000
    assert circle(graph) == []


@pytest.mark.parametrize("importing", ["import grader.b", "def f():\n    from grader import b\n"])
def test_a_circle_is_seen(tmp_path: Path, importing: str) -> None:
    files = {"grader.a": importing, "grader.b": "from grader.a import x\n"}
    known = {name: tmp_path / f"{name}.py" for name in files}
    for name, text in files.items():
        known[name].write_text(text, encoding="utf-8")
    assert set(circle({name: set(imports(path, known)) for name, path in known.items()})) == set(files)
