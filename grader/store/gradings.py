"""Finished gradings, as rows to be stored.

Rows are plain values by column, inserted by statements of tables: making an object of each and keeping account of
it would cost more than the database takes to store it.
"""

import gzip
import hashlib
import json
from collections.abc import Sequence
from datetime import datetime
from typing import Any

from sqlalchemy import Connection, Insert, insert

from grader.contracts.assignment import Assignment, Distro
from grader.contracts.grading import GradingResult
from grader.contracts.record import canonical, to_plain
from grader.contracts.submission import Claim
from grader.store.tables import (
    GZIP_LEVEL,
    GradedItemRow,
    GradedMistakeRow,
    GradingRow,
    TrajectoryRow,
    table_of,
)

Values = dict[str, Any]
"""One row, by column."""

_GRADINGS, _ITEMS, _MISTAKES, _TRAJECTORIES = (
    insert(table_of(row)) for row in (GradingRow, GradedItemRow, GradedMistakeRow, TrajectoryRow)
)
Details = Sequence[tuple[Insert, list[Values]]]
"""Rows that belong to a grading, with the statement that inserts them."""


def grading_values(
    claim: Claim, result: GradingResult, finished_at: datetime, assignment_sha256: str
) -> Values:
    """Return the row of the grading itself."""
    report = result.report
    content = result.report_bytes()
    return {
        "submission_id": claim.submission_id,
        "attempt": claim.attempt,
        "worker": claim.worker,
        "finished_at": finished_at,
        "grader_version": report.grader_version,
        "assignment_version": report.assignment_version,
        "verdict": report.status.value,
        "score": report.score,
        "max_score": report.max_score,
        "report_sha256": hashlib.sha256(content).hexdigest(),
        "report": content,
        "assignment_sha256": assignment_sha256,
        "measurements": json.dumps(result.measurements, default=to_plain, sort_keys=True, allow_nan=False),
    }


def assignment_values(assignment: Assignment) -> Values:
    """Return the row of an assignment as it is graded."""
    content = canonical(assignment)
    return {"sha256": hashlib.sha256(content).hexdigest(), "content": content}


class AssignmentRows:
    """Makes rows of assignments. Remembers the latest of each: encoding one takes long."""

    def __init__(self) -> None:
        self._latest: dict[tuple[str, Distro], tuple[Assignment, Values]] = {}

    def of(self, assignment: Assignment) -> Values:
        """Return the row of an assignment as it is graded."""
        key = assignment.id, assignment.release
        kept = self._latest.get(key)
        if kept is None or kept[0] != assignment:
            kept = self._latest[key] = (assignment, assignment_values(assignment))
        return kept[1]


def detail_values(grading: Values, result: GradingResult) -> Details:
    """Return what belongs to the row `grading`: rubric items, mistakes and trajectories."""
    key = {"submission_id": grading["submission_id"], "attempt": grading["attempt"]}
    return [
        (statement, [key | row for row in rows])
        for statement, rows in (
            (_ITEMS, _items(result)),
            (_MISTAKES, _mistakes(result)),
            (_TRAJECTORIES, _trajectories(result)),
        )
        if rows
    ]


def insert_grading(connection: Connection, grading: Values, details: Details) -> None:
    """Insert the row of a grading and what belongs to it."""
    connection.execute(_GRADINGS, grading)
    for statement, rows in details:
        connection.execute(statement, rows)


def _items(result: GradingResult) -> list[Values]:
    return [
        {"item": item.id, "status": item.status.value, "points": item.points, "earned": item.earned}
        for item in result.report.items
    ]


def _mistakes(result: GradingResult) -> list[Values]:
    codes = dict.fromkeys(result.report.mistakes)
    return [{"code": code, "rank": rank} for rank, code in enumerate(codes)]


def _trajectories(result: GradingResult) -> list[Values]:
    return [
        {
            "case_id": case_id,
            "position": position,
            "sha256": hashlib.sha256(content).hexdigest(),
            "content": gzip.compress(content, GZIP_LEVEL, mtime=0),
        }
        for position, (case_id, content) in enumerate(result.trajectories.items())
    ]
