"""The assignments that come with the grader, and short ways to grade ideal motions with them."""

from functools import cache

from grader.catalog import Catalog
from grader.checks import evaluate
from grader.contracts.assignment import Assignment
from grader.contracts.outcome import RunOutcome, RunStatus
from grader.contracts.rubric import RubricItem
from grader.contracts.scoring import Run, Scoring
from grader.contracts.trajectory import Trajectory
from tests.unit.checks.trajectories import drive, run_of

POLYGONS = {3: "triangle", 4: "square", 5: "pentagon"}


@cache
def assignment(name: str) -> Assignment:
    return Catalog().get(name)


def graded(
    name: str, trajectory: Trajectory, status: RunStatus = RunStatus.FINISHED, **outcome: object
) -> Scoring:
    return evaluate(assignment(name), [run_of(trajectory, status, **outcome)])


def score(scoring: Scoring) -> float:
    return round(sum(item.earned for item in scoring.items), 2)


def item(scoring: Scoring, name: str) -> RubricItem:
    return next(each for each in scoring.items if each.id == name)


def silent(status: RunStatus = RunStatus.FINISHED, **changes: object) -> Scoring:
    """Return the scoring on a run to `square` without any motion."""
    values: dict[str, object] = {"status": status, "duration_ns": 1_000, "nodes": ("/mover",), **changes}
    trajectory = drive([], horizon_s=2.0)
    outcome = RunOutcome(**values)  # type: ignore[arg-type]
    return evaluate(assignment("square"), [Run(trajectory=trajectory, outcome=outcome)])
