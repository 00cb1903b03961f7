"""Procrastinate stays behind its seam: the embedded default runs without it."""

import ast
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
JOBS = ROOT / "grader" / "store" / "jobs"
OUTSIDE = [
    path
    for path in sorted((ROOT / "grader").rglob("*.py"))
    if JOBS not in path.parents and "shim" not in path.relative_to(ROOT).parts
]


def imported(statements: list[ast.stmt]) -> set[str]:
    names: set[str] = set()
    for node in statements:
        if isinstance(node, ast.Import):
            names.update(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            names.add(node.module or "")
    return names


def test_nothing_else_imports_procrastinate_nor_the_jobs_at_its_start() -> None:
    guilty = []
    for one in OUTSIDE:
        text = one.read_text(encoding="utf-8")
        if "procrastinate" not in text and "store.jobs" not in text:
            continue
        tree = ast.parse(text)
        everywhere = [node for node in ast.walk(tree) if isinstance(node, ast.stmt)]
        if any(name.split(".")[0] == "procrastinate" for name in imported(everywhere)):
            guilty.append(one)
        if any(name.startswith("grader.store.jobs") for name in imported(tree.body)):
            guilty.append(one)
    assert guilty == []
    assert len(OUTSIDE) > 100  # it did look
