"""The corpus scored: on the ideal turtle, or as scripts with everything real."""

from collections import Counter
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from functools import cache

from grader.catalog import Catalog
from grader.checks import evaluate
from grader.contracts.assignment import Assignment
from grader.contracts.grading import Grader, GradingJob
from grader.contracts.outcome import RunStatus
from tests.corpus.attempts import Attempt
from tests.corpus.scripts import ideal_legs, script
from tests.unit.checks.trajectories import drive, run_of

RIGHT_SCORE = 90.0
READY_S = 0.3


@dataclass(frozen=True, slots=True)
class Scored:
    """An attempt, its score out of 100 and what lost credit."""

    attempt: Attempt
    score: float
    lost: str

    @property
    def scored_wrongly(self) -> bool:
        """A right script below 90 %, a harmless one below or a wrong one at full marks."""
        match self.attempt.truth:
            case "right":
                return self.score < RIGHT_SCORE
            case "harmless":
                return self.score < 100.0
            case _:
                return self.score >= 100.0

    def __str__(self) -> str:
        return f"{self.attempt}: {self.score:g} {self.lost}".rstrip()


@cache
def _assignment(name: str) -> Assignment:
    return Catalog().get(name)


def task_of(attempt: Attempt) -> Assignment:
    """Return the assignment with the car's start turned to the attempt's heading."""
    task = _assignment(attempt.assignment)
    start = replace(task.world.start, heading_deg=attempt.heading_deg)
    return replace(task, world=replace(task.world, start=start))


def on_the_ideal_turtle(attempt: Attempt, ready_s: float = READY_S) -> Scored:
    """Score the commanded motion, from `ready_s` on, on a turtle that obeys at once."""
    task = task_of(attempt)
    legs = [(ready_s, 0.0, 0.0), *ideal_legs(attempt)]
    horizon_s, status = None, RunStatus.FINISHED
    if attempt.for_ever:
        laps = int(task.horizon_s / attempt.duration_s) + 1
        legs, horizon_s, status = legs[:1] + legs[1:] * laps, task.horizon_s, RunStatus.INTERRUPTED
    trajectory = drive(legs, heading_deg=attempt.heading_deg, horizon_s=horizon_s)
    if not attempt.stops:  # the last command is not the stop that the ideal turtle appends
        trajectory = replace(trajectory, commands=trajectory.commands[:-1])
    column = evaluate(task, [run_of(trajectory, status)])
    lost = ", ".join(f"{each.id} {each.measured}" for each in column.items if each.earned < each.points)
    return Scored(attempt, round(sum(each.earned for each in column.items), 2), lost)


def for_real(grader: Grader) -> Callable[[Attempt], Scored]:
    """Return what scores an attempt's script through sandbox, shim, simulator and checks."""

    def score_for_real(attempt: Attempt) -> Scored:
        source = script(attempt).encode()
        job = GradingJob(file_name="script.py", source=source, assignment=task_of(attempt))
        report = grader.grade(job).report
        lost = ", ".join(f"{each.id} {each.measured}" for each in report.items if each.earned < each.points)
        return Scored(attempt, report.score or 0.0, f"{lost} ({report.status})" if lost else "")

    return score_for_real


def confusion(scored: Iterable[Scored]) -> str:
    """Return the confusion matrix as a table."""
    counts: Counter[tuple[str, str]] = Counter()
    for each in scored:
        column = "full" if each.score >= 100.0 else "90 or more" if each.score >= RIGHT_SCORE else "below 90"
        counts[each.attempt.truth, column] += 1
    columns = ("full", "90 or more", "below 90")
    lines = [f"{'':>10}" + "".join(f"{column:>12}" for column in columns)]
    for truth in ("right", "harmless", "wrong"):
        lines.append(f"{truth:>10}" + "".join(f"{counts[truth, column]:>12}" for column in columns))
    return "\n".join(lines)
