"""What a rubric sees: the solution with single edits, graded. Which keep all points, and which lose all of them?

The counts say little by themselves. A person reads the two lists: an edit that moves the car otherwise and keeps
all points shows what no item asks for, one that loses nearly all for a detail shows a cliff.
"""

from dataclasses import dataclass
from typing import Final

from grader.contracts.assignment import Assignment
from grader.contracts.grading import Grader, GradingJob, GradingResult
from grader.contracts.report import GradeStatus
from grader.edits.mutations import Mutant, mutants
from grader.edits.tree import ParsedScript
from grader.grading.examination import OwnScript

BANDS: Final = (100.0, 80.0, 50.0, 20.0, 0.0)
"""Lowest scores, in per cent, of the bands in which mutants are counted."""

NOTHING_PCT: Final = 5.0


@dataclass(frozen=True, slots=True, kw_only=True)
class GradedMutant:
    """A mutant with its score in per cent.

    Attributes:
        moves_alike: the car went exactly as the solution has it go. ran: the script had no error of its own.
    """

    mutant: Mutant
    pct: float
    moves_alike: bool
    ran: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class Audit:
    """The mutants of one solution, by place."""

    graded: tuple[GradedMutant, ...]

    @property
    def counts(self) -> tuple[int, ...]:
        """Return how many lie in each of `BANDS`."""
        lows, highs = BANDS, (float("inf"), *BANDS[:-1])
        return tuple(
            sum(low <= mutant.pct < high for mutant in self.graded)
            for low, high in zip(lows, highs, strict=True)
        )

    @property
    def unseen(self) -> tuple[GradedMutant, ...]:
        """Return those that keep all points and do not move alike."""
        return tuple(mutant for mutant in self.graded if mutant.pct >= 100.0 and not mutant.moves_alike)

    @property
    def lost(self) -> tuple[GradedMutant, ...]:
        """Return those that ran and lose nearly all points."""
        return tuple(mutant for mutant in self.graded if mutant.ran and mutant.pct <= NOTHING_PCT)


def audited(assignment: Assignment, solution: OwnScript, grader: Grader, most: int) -> Audit:
    """Grade mutants of a solution in Python: all, or `most` of them, spread over the script.

    Raises GraderError: the grader failed.
    """

    def graded(source: bytes) -> GradingResult:
        return grader.grade(GradingJob(file_name=solution.name, source=source, assignment=assignment))

    right = graded(solution.source)
    mutated = list(mutants(ParsedScript.parsed(solution.source.decode())))
    if len(mutated) > most:
        mutated = [mutated[number * len(mutated) // most] for number in range(most)]
    results = []
    for mutant in mutated:
        result = graded(mutant.text.encode())
        pct = 100.0 * (result.report.score or 0.0) / result.report.max_score
        alike = result.trajectories == right.trajectories
        ran = result.report.status is GradeStatus.GRADED
        results.append(GradedMutant(mutant=mutant, pct=pct, moves_alike=alike, ran=ran))
    return Audit(graded=tuple(results))
