"""A graded run as a ROS bag, for the tools that a ROS course uses anyway."""

import json

from grader.checks import sketch
from grader.contracts.assignment import Assignment
from grader.contracts.report import GradeReport
from grader.contracts.scoring import Run
from grader.contracts.trajectory import decode_trajectory
from grader.sim.bag import BagContents, bag


def bagged(
    assignment: Assignment, report: GradeReport, content: bytes, trajectory: bytes, case: str | None = None
) -> bytes:
    """Return one of the report's runs, without a `case` the first, as an MCAP file.

    `assignment`: the version that was graded, as the reader may see it. `content`: the report's JSON, which goes
    into the file as it is. `trajectory`: of that run, as `grader.contracts.encode_trajectory` wrote it.

    Raises RefusedError: what writes such files is not installed.
    """
    motion = decode_trajectory(trajectory)
    run = report.run_of(case)
    assert run is not None  # the trajectory is of this run
    about = {
        "assignment": report.assignment,
        "assignment_version": str(report.assignment_version),
        "case": run.case,
        "submission_sha256": report.submission_sha256,
        "simulator": report.simulator,
        "status": report.status.value,
        "score": "" if report.score is None else str(report.score),
        "max_score": str(report.max_score),
    }
    return bag(
        BagContents(
            trajectory=motion,
            logs=run.outcome.logs,
            world=assignment.in_case(run.case).world,
            figure=sketch(assignment, Run(trajectory=motion, outcome=run.outcome, case=run.case)),
            report=content,
            items=json.loads(content)["items"],
            library=f"grader {report.grader_version}",
            about=about,
        )
    )
