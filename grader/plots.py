"""From a stored grading to its picture: measure the figure again and hand everything to the renderer."""

from typing import Literal

from grader.checks import sketch
from grader.contracts import trajectory_json
from grader.contracts.assignment import Assignment
from grader.contracts.report import GradeReport
from grader.contracts.text import Language
from grader.contracts.verdict import Run
from grader.render.plot import plot_png, plot_svg

Form = Literal["png", "svg"]


def draw(
    assignment: Assignment, report: GradeReport, trajectory: bytes, language: Language, form: Form = "png"
) -> bytes:
    """Return the plot of the report's first run.

    Args:
        assignment: the version that was graded.
        report: the graded report.
        trajectory: of the report's first run, as `grader.contracts.trajectory_json.encode` wrote it.
        language: of all words in the plot.
        form: file format.
    """
    motion = trajectory_json.decode(trajectory)
    first = report.runs[0]
    figure = sketch(assignment, Run(trajectory=motion, outcome=first.outcome, case=first.case))
    plot = plot_png if form == "png" else plot_svg
    return plot(assignment, report, motion, figure, language)
