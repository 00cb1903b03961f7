"""What `grader assignments validate` tells beside the scores; tests/e2e/test_assignments.py tries the rest."""

from grader.commands.validation import unusual_totals
from grader.contracts.text import EMPTY
from grader.grading.examination import Finding


def test_points_that_do_not_add_up_to_100_are_told() -> None:
    def found(name: str, total: float) -> Finding:
        return Finding(assignment=name, script="solution.py", score=total, max_score=total, problem=EMPTY)

    told = unusual_totals([found("square", 100.0), found("heptagon", 90.0), found("heptagon", 90.0)])
    assert [one.en for one in told] == ["heptagon: the items add up to 90 points, not to 100"]
