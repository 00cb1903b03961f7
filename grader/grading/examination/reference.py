"""What a solution drives, for an assignment whose wanted path it is."""

import cmath
from dataclasses import replace
from pathlib import PurePath

import numpy as np

from grader.catalog.misfits import refusals
from grader.catalog.reference import POINTS, Trace
from grader.checks.drive import drive_of
from grader.contracts.assignment import Assignment
from grader.contracts.grading import Grader, GradingJob
from grader.contracts.scoring import Run
from grader.contracts.text import Text
from grader.contracts.trajectory import decode_trajectory
from grader.geometry.matching import resampled

_LEAST_M = 0.5
_DECIMALS = 4  # of a metre
_HARDLY = Text(
    zh=f"走的路不到 {_LEAST_M} m，没有路径可以比较：请改正",
    en=f"drives less than {_LEAST_M} m, so there is no path to compare with; correct it",
)


def wants_reference(assignment: Assignment) -> bool:
    """Return whether an assignment wants what its solution drives, and nobody recorded that yet."""
    return assignment.path is not None and assignment.path.by_solution and not assignment.path.trace


def traced(assignment: Assignment, name: str, source: bytes, grader: Grader) -> Trace:
    """Run the solution of an assignment that wants what it drives; return that.

    Raises GraderError: the solution, which the message calls `name`, hardly drives, or the grader failed.
    """
    bare = replace(assignment, check="node", path=None, items=(), cases=assignment.cases[:1])
    result = grader.grade(GradingJob(file_name=PurePath(name).name, source=source, assignment=bare))
    run = result.report.runs[0]
    trajectory = decode_trajectory(result.trajectories[run.case])
    trace = _trace_of(Run(trajectory=trajectory, outcome=run.outcome, case=run.case))
    if not trace:
        raise refusals([(name, _HARDLY)])
    return trace


def _trace_of(run: Run) -> Trace:
    """Return points of the driven path, seen from its start; none where hardly anything was driven."""
    drive = drive_of(run)
    if drive is None:
        return ()
    along = np.maximum.accumulate(drive.path.along_m)
    if float(along[-1]) < _LEAST_M:
        return ()
    points = drive.path.x_m + 1j * drive.path.y_m
    ahead = cmath.rect(1.0, -float(drive.path.heading_rad[0]))
    trace = (resampled(points, along, np.linspace(0.0, float(along[-1]), POINTS)) - points[0]) * ahead
    return tuple((round(z.real, _DECIMALS) + 0.0, round(z.imag, _DECIMALS) + 0.0) for z in trace.tolist())
