"""What a class handed in for one assignment, to be compared: whole files, and what they drove."""

from collections.abc import Collection, Iterator
from dataclasses import dataclass
from itertools import groupby

from sqlalchemy import ColumnElement, and_, or_, select
from sqlmodel import col

from grader.contracts.identity import Role
from grader.store.database import StorePart, in_lots
from grader.store.tables import MemberRow, SourceRow, SubmissionRow, TrajectoryRow

_AT_ONCE = 50  # files, or recordings: some megabytes
_MOST_OF_STAFF = 100


@dataclass(frozen=True, slots=True)
class HandedIn:
    """One file. `graded_attempt`: of the grading that stands; None before the first.

    `team_upload`: the same of the files of one upload of a team; else None.
    """

    submission: str
    student: str
    sha256: str
    graded_attempt: int | None
    team_upload: str | None = None


class Scripts(StorePart):
    """Reads files and recordings in parts that are soon done with; safe to share between threads."""

    def of(self, submissions: Collection[str]) -> tuple[HandedIn, ...]:
        """Return those of `submissions` that exist, in order of student."""
        chosen = col(SubmissionRow.id).in_(submissions)
        return tuple(sorted(self._handed_in(chosen), key=lambda one: (one.student, one.submission)))

    def of_staff(self, course: str | None, assignment: str) -> tuple[HandedIn, ...]:
        """Return what the course's staff handed in under their own names, the newest 100."""
        staff = select(col(MemberRow.person)).where(
            col(MemberRow.course) == course, col(MemberRow.role) != Role.STUDENT.value
        )
        theirs = and_(
            col(SubmissionRow.course) == course,
            col(SubmissionRow.assignment) == assignment,
            col(SubmissionRow.regrade).is_(None),
            col(SubmissionRow.student).in_(staff),
        )
        return self._handed_in(theirs)[:_MOST_OF_STAFF] if course is not None else ()

    def sources(self, digests: Collection[str]) -> Iterator[tuple[str, bytes]]:
        """Yield digest and bytes of the stored files of these digests, some at once."""
        for some in in_lots(sorted(digests), _AT_ONCE):
            statement = select(col(SourceRow.sha256), col(SourceRow.content)).where(
                col(SourceRow.sha256).in_(some)
            )
            yield from ((row[0], row[1]) for row in self._rows(statement))

    def recordings(self, handed_in: Collection[HandedIn]) -> Iterator[tuple[HandedIn, tuple[bytes, ...]]]:
        """Yield what the runs of the gradings that stand recorded, in order of the cases: gzip of JSON."""
        row = TrajectoryRow
        graded = sorted((script for script in handed_in if script.graded_attempt is not None), key=_grading)
        for some in in_lots(graded, _AT_ONCE):
            by_grading = {_grading(script): script for script in some}
            theirs = (
                and_(col(row.submission_id) == script.submission, col(row.attempt) == script.graded_attempt)
                for script in some
            )
            statement = (
                select(col(row.submission_id), col(row.attempt), col(row.content))
                .where(or_(*theirs))
                .order_by(col(row.submission_id), col(row.attempt), col(row.position))
            )
            for grading, runs in groupby(
                self._rows(statement), lambda found_row: (found_row[0], found_row[1])
            ):
                yield by_grading[grading], tuple(run[2] for run in runs)

    def _handed_in(self, which: ColumnElement[bool]) -> tuple[HandedIn, ...]:
        row = SubmissionRow
        statement = (
            select(
                col(row.id),
                col(row.student),
                col(row.source_sha256),
                col(row.graded_attempt),
                col(row.team_upload),
            )
            .where(which)
            .order_by(col(row.received_at).desc(), col(row.id))
        )
        return tuple(HandedIn(*values) for values in self._rows(statement))


def _grading(one: HandedIn) -> tuple[str, int]:
    return one.submission, one.graded_attempt or 0
