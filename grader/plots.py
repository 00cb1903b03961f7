"""From a stored grading to its picture: measure the figure again and hand everything to the renderer."""

from grader.checks import sketch
from grader.contracts import trajectory_json
from grader.contracts.assignment import Assignment
from grader.contracts.figure import PictureForm
from grader.contracts.report import CaseRun, GradeReport
from grader.contracts.text import Language
from grader.contracts.verdict import Run
from grader.render.plot import plot


def draw(  # noqa: PLR0913
    assignment: Assignment,
    report: GradeReport,
    trajectory: bytes,
    language: Language,
    form: PictureForm = "png",
    *,
    case: str | None = None,
) -> bytes:
    """Return the plot of one of the report's runs.

    Args:
        assignment: the version that was graded.
        report: the graded report.
        trajectory: of that run, as `grader.contracts.trajectory_json.encode` wrote it.
        language: of all words in the plot.
        form: file format.
        case: which run; None: the first.
    """
    motion = trajectory_json.decode(trajectory)
    run = _run(report, case)
    figure = sketch(assignment, Run(trajectory=motion, outcome=run.outcome, case=run.case))
    return plot(assignment, report, motion, figure, language, form=form, case=run.case)


def _run(report: GradeReport, case: str | None) -> CaseRun:
    return next(run for run in report.runs if case is None or run.case == case)
