"""What the checks saw in a motion, for the replay and for the table beside it."""

import gzip
from dataclasses import asdict
from typing import Any

from grader.checks import sketch
from grader.contracts.errors import AssignmentError, UnknownAssignmentError
from grader.contracts.figure import FigureSketch
from grader.contracts.identity import Caller
from grader.contracts.judgement import judged
from grader.contracts.report import CaseRun, GradeReport
from grader.contracts.scoring import Run
from grader.contracts.submission import StoredReport
from grader.contracts.text import Language
from grader.contracts.trajectory import decode_trajectory
from grader.use_cases.services import Services
from grader.use_cases.visibility import shown_assignment


def run_of(report: GradeReport, case: str | None) -> CaseRun | None:
    """Return the run of `case`, the first when None; None when there is no such run."""
    return next((run for run in report.runs if case is None or run.case == case), None)


def measured_figure(
    services: Services, caller: Caller, stored: StoredReport, run: CaseRun
) -> FigureSketch | None:
    """Return the detected figure of a run, judged by what the caller may see.

    None when nothing was recorded, or the assignment is no longer published in a form that can be measured.
    """
    content = services.submissions.trajectory(stored, run.case)
    if content is None:
        return None
    motion = decode_trajectory(gzip.decompress(content))
    try:
        published = services.assignments.get(judged(stored).assignment)
        assignment = shown_assignment(services, caller, published)
        return sketch(assignment, Run(trajectory=motion, outcome=run.outcome, case=run.case))
    except (AssignmentError, UnknownAssignmentError):
        return None


def figure_document(figure: FigureSketch, language: Language) -> dict[str, Any]:
    """Return a figure as plain data with its remarks in `language`."""
    labels = [{"at_m": one.at_m, "text": one.text.get(language), "ok": one.ok} for one in figure.labels]
    return {**asdict(figure), "labels": labels}
