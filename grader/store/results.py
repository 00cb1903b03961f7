"""A finished grading as rows."""

import gzip
import hashlib
import json
from dataclasses import asdict
from datetime import datetime
from typing import Any

from sqlmodel import SQLModel

from grader.contracts.assignment import Assignment
from grader.contracts.codec import to_plain
from grader.contracts.grading import GradingResult
from grader.contracts.submission import Claim
from grader.store.tables import (
    GradedAssignmentRow,
    GradedItemRow,
    GradedMistakeRow,
    GradingRow,
    TrajectoryRow,
)

_GZIP_LEVEL = 5  # four times smaller than plain; higher levels cost time and gain a few per cent


def grading_row(
    claim: Claim, result: GradingResult, finished_at: datetime, assignment_sha256: str | None = None
) -> GradingRow:
    """Return the row of the grading itself."""
    report = result.report
    content = report.canonical_bytes()
    return GradingRow(
        submission_id=claim.submission_id,
        attempt=claim.attempt,
        worker=claim.worker,
        finished_at=finished_at,
        grader_version=report.grader_version,
        assignment_version=report.assignment_version,
        verdict=report.status.value,
        score=report.score,
        max_score=report.max_score,
        report_sha256=hashlib.sha256(content).hexdigest(),
        report=content,
        assignment_sha256=assignment_sha256,
        measurements=json.dumps(asdict(result.measurements), sort_keys=True, allow_nan=False),
    )


def assignment_row(assignment: Assignment) -> GradedAssignmentRow:
    """Return the row of an assignment as it is graded."""
    content = json.dumps(
        to_plain(assignment), ensure_ascii=False, sort_keys=True, separators=(",", ":"), allow_nan=False
    ).encode()
    return GradedAssignmentRow(sha256=hashlib.sha256(content).hexdigest(), content=content)


def detail_rows(claim: Claim, result: GradingResult) -> list[SQLModel]:
    """Return the rows that belong to a grading: rubric items, mistakes and trajectories."""
    key: dict[str, Any] = {"submission_id": claim.submission_id, "attempt": claim.attempt}
    report = result.report
    rows: list[SQLModel] = [
        GradedItemRow(**key, item=item.id, status=item.status.value, points=item.points, earned=item.earned)
        for item in report.items
    ]
    codes = list(dict.fromkeys(report.mistakes))
    rows += [GradedMistakeRow(**key, code=code, rank=rank) for rank, code in enumerate(codes)]
    for position, (case_id, content) in enumerate(result.trajectories.items()):
        rows.append(
            TrajectoryRow(
                **key,
                case_id=case_id,
                position=position,
                sha256=hashlib.sha256(content).hexdigest(),
                content=gzip.compress(content, _GZIP_LEVEL, mtime=0),
            )
        )
    return rows
