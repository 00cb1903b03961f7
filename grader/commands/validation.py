"""Does every assignment keep its word: solutions get full marks, wrong scripts the verdict they must get."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from rich.table import Table
from rich.text import Text

from grader.catalog import Catalog
from grader.contracts.assignment import Assignment, WrongAttempt
from grader.contracts.grading import Grader, GradingJob
from grader.contracts.report import GradeReport, GradeStatus
from grader.contracts.rubric import ItemStatus
from grader.contracts.text import Language
from grader.render.terminal import console
from grader.slot import Slot, SlotConfig


@dataclass(frozen=True, slots=True, kw_only=True)
class Finding:
    """What one of an assignment's own scripts got. `problem` is empty when that is what it must get."""

    assignment: str
    script: str
    score: float
    max_score: float
    problem: str


def validate(catalog: Catalog, assignment_ids: Iterable[str], language: Language) -> int:
    """Run the scripts of the assignments and print what each got; 0 when all is as it must be."""
    table = Table(box=None)
    for heading in ("", "assignment", "script", "score", "problem"):
        table.add_column(heading, overflow="fold")
    bad = 0
    with Slot(SlotConfig()) as slot:
        for assignment_id in assignment_ids:
            for finding in examine(catalog, assignment_id, slot):
                bad += bool(finding.problem)
                table.add_row(
                    "✗" if finding.problem else "✓",
                    finding.assignment,
                    finding.script,
                    f"{finding.score:g}/{finding.max_score:g}",
                    Text(finding.problem, style="red"),
                )
    console().print(table)
    return 1 if bad else 0


def examine(catalog: Catalog, assignment_id: str, grader: Grader) -> Iterator[Finding]:
    """Grade the solution, the starter and every wrong script of one assignment.

    Raises:
        GraderError: the assignment cannot be read, or the grader failed.
    """
    assignment = catalog.get(assignment_id)
    folder = catalog.folder(assignment_id)
    path = catalog.own_file(assignment, "solution")
    solution = _grade(grader, assignment, path)
    yield _finding(assignment, path.name, solution, "" if _all_passed(solution) else _lost(solution))
    path = catalog.own_file(assignment, "starter")
    starter = _grade(grader, assignment, path)
    gift = "the starter already has full marks" if _all_passed(starter) else ""
    yield _finding(assignment, path.name, starter, gift)
    for attempt in catalog.wrong_attempts(assignment_id):
        report = _grade(grader, assignment, folder / "wrong" / attempt.file)
        yield _finding(assignment, f"wrong/{attempt.file}", report, _misjudged(attempt, report))


def _all_passed(report: GradeReport) -> bool:
    """Whether nothing was lost; what waits for a person has not been lost."""
    if report.status is GradeStatus.NEEDS_MANUAL:
        return all(item.status is not ItemStatus.FAILED for item in report.items)
    return report.score == report.max_score


def _grade(grader: Grader, assignment: Assignment, path: Path) -> GradeReport:
    job = GradingJob(file_name=path.name, source=path.read_bytes(), assignment=assignment)
    return grader.grade(job).report


def _finding(assignment: Assignment, script: str, report: GradeReport, problem: str) -> Finding:
    return Finding(
        assignment=assignment.id,
        script=script,
        score=report.score or 0.0,
        max_score=report.max_score,
        problem=problem,
    )


def _lost(report: GradeReport) -> str:
    items = [item.id for item in report.items if item.status is not ItemStatus.PASSED]
    return f"false fail: loses credit for {', '.join(items)}"


def _misjudged(attempt: WrongAttempt, report: GradeReport) -> str:
    score = report.score or 0.0
    problems = []
    if not attempt.low <= score <= attempt.high:
        problems.append(f"score {score:g} is outside [{attempt.low:g}, {attempt.high:g}]")
    lost = (item for item in report.items if item.status in (ItemStatus.FAILED, ItemStatus.PARTIAL))
    if attempt.fails not in [item.id.rpartition("/")[2] for item in lost]:
        problems.append(f"item {attempt.fails} loses nothing")
    if attempt.mistake and attempt.mistake not in report.mistakes[:1]:
        problems.append(f"recognised {', '.join(report.mistakes) or 'nothing'} instead of {attempt.mistake}")
    return "; ".join(problems)
