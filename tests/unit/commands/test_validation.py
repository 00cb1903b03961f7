"""What `grader assignments validate` tells beside the scores; tests/e2e/test_assignments.py tries the rest."""

from pathlib import Path

import pytest

from grader.catalog import Catalog
from grader.commands.validation import unusual_totals, write_scripts
from grader.contracts.errors import RefusedError
from grader.contracts.text import EMPTY
from grader.grading.examination import Finding


def test_points_that_do_not_add_up_to_100_are_told() -> None:
    def found(name: str, total: float) -> Finding:
        return Finding(assignment=name, script="solution.py", score=total, max_score=total, problem=EMPTY)

    told = unusual_totals([found("square", 100.0), found("heptagon", 90.0), found("heptagon", 90.0)])
    assert [one.en for one in told] == ["heptagon: the items add up to 90 points, not to 100"]


def test_the_scripts_are_written_out_as_they_are_graded(tmp_path: Path) -> None:
    write_scripts(Catalog(), ["square", "make_package"], tmp_path)
    square = tmp_path / "square"
    written = {str(path.relative_to(square)): path.read_bytes() for path in square.rglob("*.py")}
    assert written == Catalog().scripts("square")
    assert b"range(3)" in written["wrong/three_sides.py"]
    assert (tmp_path / "make_package" / "wrong" / "no_init.zip").read_bytes().startswith(b"PK")
    with pytest.raises(RefusedError, match=r"solution\.py"):
        write_scripts(Catalog(), ["square"], square / "solution.py")
