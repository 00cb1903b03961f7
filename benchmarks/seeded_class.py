"""A class of any size in a database, without grading each submission: to measure what reads whole classes.

Every script is graded once; its report, items, mistakes and trajectory then stand for each submission of it.

Usage: ``python -m benchmarks.seeded_class FOLDER [STUDENTS]`` writes ``FOLDER/grader.db``.
"""

from __future__ import annotations

import hashlib
import sys
from collections.abc import Mapping, Sequence
from dataclasses import replace
from datetime import timedelta
from pathlib import Path

from sqlmodel import Session

from benchmarks.classroom import Upload, plan, results, roster
from grader.catalog import Catalog
from grader.contracts.grading import GradingResult
from grader.contracts.identity import Role, RosterEntry
from grader.contracts.submission import Claim, SubmissionState
from grader.store.clock import utc_now
from grader.store.courses import Courses
from grader.store.database import Database
from grader.store.gradings import assignment_values, detail_values, grading_values, insert_grading
from grader.store.intake import new_id
from grader.store.schema import migrate
from grader.store.tables import GradedAssignmentRow, SourceRow, SubmissionRow

COURSE = "ros2-load"
_ATTEMPTS = 3
_AT_ONCE = 500
_ATTEMPT = 1


def seed(
    database: Database,
    students: Sequence[str],
    uploads: Sequence[Upload],
    graded: Mapping[tuple[str, str], GradingResult],
) -> None:
    """Write a course with `students`, and every fresh one of `uploads` as graded.

    Args:
        database: up to date and empty.
        students: ids.
        uploads: in order.
        graded: results by assignment and name of the script.
    """
    courses = Courses(database, utc_now)
    courses.create(COURSE, COURSE, "Asia/Shanghai", "benchmark")
    teacher = RosterEntry(id="wang", name="Wang", role=Role.INSTRUCTOR)
    people = [RosterEntry(id=one, name=one, role=Role.STUDENT) for one in students]
    courses.import_roster(COURSE, [teacher, *people], "benchmark")
    digests = _write_assignments(database)
    fresh = [one for one in uploads if one.kind == "fresh"]
    for start in range(0, len(fresh), _AT_ONCE):
        with database.writing() as session:
            for upload in fresh[start : start + _AT_ONCE]:
                _write(session, upload, graded[upload.script.assignment, upload.script.name], digests)


def _write_assignments(database: Database) -> dict[str, str]:
    rows = {one.id: assignment_values(one) for one in Catalog().all()}
    with database.writing() as session:
        session.add_all(GradedAssignmentRow(**row) for row in rows.values())
        return {name: row["sha256"] for name, row in rows.items()}


def _write(session: Session, upload: Upload, result: GradingResult, digests: Mapping[str, str]) -> None:
    now, content = utc_now(), upload.content
    digest = hashlib.sha256(content).hexdigest()
    result = replace(result, report=replace(result.report, submission_sha256=digest))
    row = SubmissionRow(
        id=new_id(now),
        course=COURSE,
        student=upload.student,
        assignment=upload.script.assignment,
        file_name=upload.script.name,
        source_sha256=digest,
        size_bytes=len(content),
        state=SubmissionState.GRADED.value,
        received_at=now,
        queued_at=now,
        turn_at=now,
        not_before=now,
        started_at=now,
        finished_at=now + timedelta(milliseconds=50),
        attempt=_ATTEMPT,
        tries=1,
        graded_attempt=_ATTEMPT,
        verdict=result.report.status.value,
        score=result.report.score,
        max_score=result.report.max_score,
    )
    claim = Claim(
        submission_id=row.id,
        attempt=_ATTEMPT,
        tries=1,
        worker="seed",
        assignment=row.assignment,
        file_name=row.file_name,
        source=content,
        queued_at=now,
        course=row.course,
        distro=None,
        runs_as=None,
    )
    grading = grading_values(claim, result, now, digests[row.assignment])
    row.report_sha256 = grading["report_sha256"]
    for one in (SourceRow(sha256=digest, content=content), row):
        session.add(one)
        session.flush()
    insert_grading(session.connection(), grading, detail_values(grading, result))


def main() -> None:
    """Write a database."""
    folder, *rest = sys.argv[1:]
    students = roster(int(rest[0]) if rest else 300)
    database = Database(f"sqlite:///{Path(folder) / 'grader.db'}")
    migrate(database)
    graded = results()
    uploads = plan([script for script, _ in graded], students, _ATTEMPTS, seed=7)
    seed(database, students, uploads, {(one.assignment, one.name): result for one, result in graded})
    database.close()


if __name__ == "__main__":
    main()
