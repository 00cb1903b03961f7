"""Record what a solution drives, for an assignment whose wanted path it is."""

import cmath
from dataclasses import replace

import numpy as np

from grader.catalog import Catalog
from grader.catalog.reference import POINTS, Trace, record
from grader.checks.drive import drive_of
from grader.contracts.errors import AssignmentError
from grader.contracts.grading import Grader, GradingJob
from grader.contracts.scoring import Run
from grader.contracts.text import trouble
from grader.contracts.trajectory import decode_trajectory
from grader.geometry.matching import resampled

_LEAST_M = 0.5
_DECIMALS = 4  # of a metre


def record_reference(catalog: Catalog, assignment_id: str, grader: Grader) -> None:
    """Run the solution of an assignment that wants what it drives, unless that is recorded already.

    Raises:
        GraderError: the solution hardly drives, it cannot be recorded, or the grader failed.
    """
    assignment = catalog.get(assignment_id)
    if assignment.path is None or not assignment.path.by_solution or assignment.path.trace:
        return
    solution = catalog.own_file(assignment, "solution")
    bare = replace(assignment, check="node", path=None, items=(), cases=assignment.cases[:1])
    result = grader.grade(GradingJob(file_name=solution.name, source=solution.read_bytes(), assignment=bare))
    run = result.report.runs[0]
    trajectory = decode_trajectory(result.trajectories[run.case])
    trace = _traced(Run(trajectory=trajectory, outcome=run.outcome, case=run.case))
    if not trace:
        raise AssignmentError(
            f"{solution}: drives less than {_LEAST_M} m, so there is no path to compare with; correct it",
            f"{solution}：走的路不到 {_LEAST_M} m，没有路径可以比较：请改正",
        )
    try:
        record(solution.parent, trace)
    except OSError as error:
        told = trouble(error)
        raise AssignmentError(f"{solution.parent}: {told.en}", f"{solution.parent}：{told.zh}") from error


def _traced(run: Run) -> Trace:
    """Return points of the driven path, seen from its start; none where hardly anything was driven."""
    drive = drive_of(run)
    if drive is None:
        return ()
    along = np.maximum.accumulate(drive.path.along_m)
    if float(along[-1]) < _LEAST_M:
        return ()
    points = drive.path.x_m + 1j * drive.path.y_m
    ahead = cmath.rect(1.0, -float(drive.path.heading_rad[0]))
    seen = (resampled(points, along, np.linspace(0.0, float(along[-1]), POINTS)) - points[0]) * ahead
    return tuple((round(z.real, _DECIMALS) + 0.0, round(z.imag, _DECIMALS) + 0.0) for z in seen.tolist())
