"""House rules that no linter knows: the size of functions, the names of modules."""

import ast
import pkgutil
import tomllib
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import pytest

from grader.checks import kinds
from grader.checks.kinds import KINDS
from grader.jail.bounds import ALLOWED_PACKAGES

ROOT = Path(__file__).resolve().parents[2]
MODULES = sorted((ROOT / "grader").rglob("*.py"))
BANNED_WORDS = {"utils", "util", "helper", "helpers", "manager", "misc", "common"}

MAX_FUNCTION_LINES = 40


def _name(path: Path) -> str:
    return str(path.relative_to(ROOT))


@pytest.fixture(scope="module")
def trees() -> dict[Path, ast.Module]:
    """What each module says; parsing all of them takes a second."""
    return {path: ast.parse(path.read_text()) for path in MODULES}


def test_functions_can_be_seen_whole(trees: dict[Path, ast.Module]) -> None:
    long = [
        f"{_name(path)}:{node.lineno} {node.name}"
        for path, tree in trees.items()
        for node in _functions(tree)
        if (node.end_lineno or node.lineno) - node.lineno + 1 > MAX_FUNCTION_LINES
    ]
    assert not long, "\n".join(long)


def _functions(whole: ast.AST) -> Iterator[ast.FunctionDef | ast.AsyncFunctionDef]:
    """Yield the functions in a tree. None stands in an expression, which most of a tree is."""
    for node in ast.iter_child_nodes(whole):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            yield node
        if isinstance(node, ast.stmt | ast.excepthandler | ast.match_case):
            yield from _functions(node)


def test_no_module_is_a_drawer() -> None:
    assert not [_name(path) for path in MODULES if BANNED_WORDS & set(path.stem.split("_"))]


def test_a_class_has_its_name_alone(trees: dict[Path, ast.Module]) -> None:
    """The shim follows upstream's names, and mirrors the wire; a module's private classes are its own affair."""
    own = [path for path in MODULES if "shim" not in path.relative_to(ROOT).parts]
    names = Counter(
        node.name
        for path in own
        for node in trees[path].body
        if isinstance(node, ast.ClassDef) and not node.name.startswith("_")
    )
    assert {"Submission", "RunEnd"} <= set(names)
    assert [name for name, times in names.items() if times > 1] == []


def test_every_check_is_registered_and_under_the_contract_that_keeps_checks_apart() -> None:
    contracts = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["importlinter"]["contracts"]
    (apart,) = (one["modules"] for one in contracts if one["name"] == "checks do not know each other")
    assert apart == [f"{kinds.__name__}.*"]
    assert set(KINDS) == {one.name for one in pkgutil.iter_modules(kinds.__path__)}
    assert all(check.kind == kind for kind, check in KINDS.items())


def test_the_shim_knows_which_packages_the_jail_lets_scripts_import() -> None:
    """They must not know each other; where a package is installed is not the script's to write to."""
    tree = ast.parse((ROOT / "grader" / "shim" / "rclpy" / "_storage" / "tree.py").read_text())
    (packages,) = (
        ast.literal_eval(node.value)
        for node in tree.body
        if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "_PACKAGES"
    )
    assert set(packages) == set(ALLOWED_PACKAGES)


def test_no_modules_of_the_shim_import_each_other(trees: dict[Path, ast.Module]) -> None:
    """Imports for type checkers count, those inside functions do not: `node` and what serves it are upstream's."""
    shim = ROOT / "grader" / "shim"
    files = {_dotted(path.relative_to(shim)): path for path in shim.rglob("*.py")}
    imported = {name: _imports(trees[path], files) - {name} for name, path in files.items()}
    while done := [name for name, others in imported.items() if not others & imported.keys()]:
        for name in done:
            del imported[name]
    assert not imported, sorted(imported)


def _dotted(path: Path) -> str:
    return ".".join(path.with_suffix("").parts).removesuffix(".__init__")


def _imports(tree: ast.Module, files: dict[str, Path]) -> set[str]:
    """Return which of `files` a module imports outside functions."""
    found: set[str] = set()
    waiting: list[ast.AST] = [tree]
    while waiting:
        node = waiting.pop()
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module is not None:
            submodules = {f"{node.module}.{alias.name}" for alias in node.names}
            found |= submodules & files.keys() or {node.module}
        elif not isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda):
            waiting.extend(ast.iter_child_nodes(node))
    return found & files.keys()
