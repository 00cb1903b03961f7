"""What a solution drives, as the wanted path: recorded, found again, and refused when it is old."""

from pathlib import Path

import pytest

from grader.catalog import Catalog
from grader.catalog.reference import record
from grader.checks import evaluate, problems
from grader.contracts.errors import AssignmentError
from tests.unit.checks.trajectories import drive, run_of

SPEC = """\
id: demo
version: 1
order: 1
title: {zh: 演示, en: Demo}
brief: {zh: 做, en: Do}
check: path
path: {reference: solution}
items:
  - {id: shape, title: {zh: 形状, en: Shape}, points: 60, measure: off_pct, high: 6, ramp: 24}
  - {id: whole, title: {zh: 全部, en: Whole}, points: 40, measure: covered_pct, low: 95, ramp: 60}
"""
CORNER = ((0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (2.0, 1.0))


def authored(root: Path) -> Catalog:
    (root / "demo").mkdir()
    (root / "demo" / "assignment.yaml").write_text(SPEC, encoding="utf-8")
    (root / "demo" / "solution.py").write_text("drive()", encoding="utf-8")
    return Catalog(root)


def told(catalog: Catalog) -> list[str]:
    return [f"{field}: {problem.en}" for field, problem in problems(catalog.get("demo"))]


def test_what_is_recorded_holds_for_this_solution_only(tmp_path: Path) -> None:
    catalog = authored(tmp_path)
    (missing,) = told(catalog)
    assert missing.startswith("path.reference: what the solution drives is not recorded")
    record(tmp_path / "demo", CORNER)
    assert told(catalog) == []
    path = catalog.get("demo").path
    assert path is not None
    assert path.trace == CORNER
    for mine in ({"start_m": (3.0, 3.0)}, {"heading_deg": 200.0}):
        trajectory = drive([(2.0, 1.0, 0.0), (1.5708, 0.0, 1.0), (1.0, 1.0, 0.0)], **mine)  # type: ignore[arg-type]
        scoring = evaluate(catalog.get("demo"), [run_of(trajectory)])
        assert sum(item.earned for item in scoring.items) == 100
    straight = evaluate(catalog.get("demo"), [run_of(drive([(3.0, 1.0, 0.0)]))])
    assert sum(item.earned for item in straight.items) < 70
    (tmp_path / "demo" / "solution.py").write_text("drive(2)", encoding="utf-8")
    assert told(catalog) == [missing]


@pytest.mark.parametrize("text", ["", "[]", '{"solution_sha256": 1}', '{"points": [[0, 0], [NaN, 1]]}'])
def test_a_broken_record_is_none(tmp_path: Path, text: str) -> None:
    catalog = authored(tmp_path)
    (tmp_path / "demo" / "reference.json").write_text(text, encoding="utf-8")
    assert len(told(catalog)) == 1


@pytest.mark.parametrize("path", ["{}", "{reference: starter}", "{reference: solution, pieces: [{line: 1}]}"])
def test_a_path_is_given_once(tmp_path: Path, path: str) -> None:
    authored(tmp_path)
    spec = tmp_path / "demo" / "assignment.yaml"
    spec.write_text(SPEC.replace("{reference: solution}", path), encoding="utf-8")
    with pytest.raises(AssignmentError, match="path"):
        Catalog(tmp_path).get("demo")


def test_pieces_are_not_measured_of_a_recorded_path(tmp_path: Path) -> None:
    catalog = authored(tmp_path)
    record(tmp_path / "demo", CORNER)
    spec = tmp_path / "demo" / "assignment.yaml"
    spec.write_text(SPEC.replace("covered_pct, low: 95", "length_error_pct, high: 4"), encoding="utf-8")
    assert told(catalog) == ["items.1.measure: the path has no line or goto; remove this item"]
