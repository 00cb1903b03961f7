"""Explanations of gradings: who waits for one, in which turn, and what was found.

A row is made with each grading that lacks marks, and belongs to that grading: a re-grade begins anew. A worker
claims it under a lease, as a submission in `grader.store.queue`; `tries` fences. They are looked for behind
all submissions, so they delay no marks. Students take turns: one goes behind what the student's own cost lately.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime, timedelta
from typing import Any, Final

from sqlalchemy import Connection, and_, bindparam, delete, func, insert, or_, select, update
from sqlmodel import col

from grader.contracts.assignment import Assignment, stored_assignment
from grader.contracts.explanation import Explanation
from grader.contracts.record import canonical, from_json
from grader.store.clock import TimedPart, ahead
from grader.store.intake import LATELY, handicap
from grader.store.tables import (
    ExplanationRow,
    GradedAssignmentRow,
    GradedMistakeRow,
    GradingRow,
    SourceRow,
    SubmissionRow,
    UtcDateTime,
    table_of,
)

LEASE_S: Final = 120.0
"""Longer than a change is tried; a claim is renewed before each."""
MOST_TRIES: Final = 2
"""A grading that was tried so often stays unexplained."""
MOST_BYTES: Final = 64 << 10
"""Of an explanation that is kept. A line of a script may be as long as the script."""
_row, _own = table_of(ExplanationRow).c, table_of(SubmissionRow).alias("own").c
_other = table_of(SubmissionRow).alias("other").c
_source, _assignment, _grading = (table_of(row).c for row in (SourceRow, GradedAssignmentRow, GradingRow))
_LOAD_OF = (
    select(func.count(_row.attempt).filter(_row.finished_at.is_(None)), func.sum(_row.took_s), _own.regrade)
    .select_from(
        _own.id.table.outerjoin(
            _other.id.table,
            and_(
                _other.course.is_not_distinct_from(_own.course),
                _other.student == _own.student,
                _other.finished_at >= bindparam("since", type_=UtcDateTime()),
            ),
        ).outerjoin(table_of(ExplanationRow), _row.submission_id == _other.id)
    )
    .where(_own.id == bindparam("id"))
    .group_by(_own.id)
)
"""How many of a student's gradings of the last minutes wait to be explained, and what the others took."""
_FILE_OF = (
    select(_own.course, _own.file_name, _source.content, _assignment.content)
    .join_from(_own.id.table, _source.sha256.table, _source.sha256 == _own.source_sha256)
    .join(_grading.attempt.table, _grading.submission_id == _own.id)
    .join(_assignment.sha256.table, _assignment.sha256 == _grading.assignment_sha256)
    .where(_own.id == bindparam("id"), _grading.attempt == bindparam("of"))
)
"""What was graded, and as what."""
_FORGET = delete(table_of(ExplanationRow)).where(_row.submission_id == bindparam("of"))
_mistake = table_of(GradedMistakeRow)
_QUEUE = insert(table_of(ExplanationRow)).values(tries=0, took_s=0.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class ExplanationClaim:
    """The right of one worker to explain a grading until its lease ends. `tries` fences."""

    submission_id: str
    attempt: int
    tries: int
    course: str | None
    file_name: str
    source: bytes
    assignment: Assignment


class Explanations(TimedPart):
    """Hands gradings to those who explain them, and keeps what they find; safe to share between threads."""

    def of(self, submission_id: str, attempt: int) -> Explanation | None:
        """Return what is known of a grading; None while it is looked for, or if nobody was asked to."""
        with self._database.reading() as session:
            row = session.get(ExplanationRow, (submission_id, attempt))
            return None if row is None or row.content is None else from_json(Explanation, row.content)

    def ask(self, submission_id: str, attempt: int) -> None:
        """Have a grading explained anew; one that waits already keeps its turn."""
        of = _row.submission_id == submission_id, _row.attempt == attempt
        with self._database.writing() as session:
            connection = session.connection()
            waits = select(_row.attempt).where(*of, _row.finished_at.is_(None))
            if connection.execute(waits.with_for_update()).first() is None:
                queue_explanation(connection, submission_id, attempt, self._clock())

    def claim(self) -> ExplanationClaim | None:
        """Take the grading whose turn it is; None when none waits."""
        row, now = ExplanationRow, self._clock()
        free = or_(col(row.lease_until).is_(None), ~ahead(col(row.lease_until), now))
        due = select(row).where(col(row.finished_at).is_(None), free)
        due = due.order_by(col(row.turn_at), col(row.submission_id)).limit(1)
        with self._database.reading() as session:  # an idle look takes no write lock
            if session.execute(due).first() is None:
                return None
        with self._database.writing() as session:
            taken = session.execute(due.with_for_update(skip_locked=True)).scalar_one_or_none()
            if taken is None:
                return None
            taken.lease_until = now + timedelta(seconds=LEASE_S)
            taken.tries += 1
            graded = session.execute(_FILE_OF, {"id": taken.submission_id, "of": taken.attempt}).one()
            course, file_name, source, assignment = graded
            return ExplanationClaim(
                submission_id=taken.submission_id,
                attempt=taken.attempt,
                tries=taken.tries,
                course=course,
                file_name=file_name,
                source=source,
                assignment=stored_assignment(assignment),
            )

    def renew(self, claim: ExplanationClaim) -> bool:
        """Begin the lease anew; False when the claim is not the latest, or its grading is gone."""
        return self._write(claim, {"lease_until": self._clock() + timedelta(seconds=LEASE_S)})

    def hand_back(self, claim: ExplanationClaim, *, counts: bool) -> bool:
        """Let somebody else look; `counts`: the try does."""
        return self._write(claim, {"lease_until": None, "tries": claim.tries - (not counts)})

    def finish(self, claim: ExplanationClaim, explanation: Explanation, took_s: float) -> bool:
        """Keep what was found, unless it is too long; False when the claim is void.

        `took_s`: how long was looked for it, without what others were waited for.
        """
        content = canonical(explanation)
        if len(content) > MOST_BYTES:
            content = canonical(Explanation(hidden=explanation.hidden, tried=explanation.tried))
        values = {"content": content, "took_s": took_s, "finished_at": self._clock(), "lease_until": None}
        return self._write(claim, values, explanation.codes)

    def _write(self, claim: ExplanationClaim, values: dict[str, Any], codes: Sequence[str] = ()) -> bool:
        """Write to a claim's row; `codes`: what the class's overview counts of a grading.

        Where the report names a mistake, that stays: else one mistake would stand in two rows.
        """
        of = _row.submission_id == claim.submission_id, _row.attempt == claim.attempt
        latest = update(table_of(ExplanationRow)).where(
            *of, _row.tries == claim.tries, _row.finished_at.is_(None)
        )
        with self._database.writing() as session:
            connection = session.connection()
            if connection.execute(latest.values(**values)).rowcount != 1:
                return False
            if codes:
                key = {"submission_id": claim.submission_id, "attempt": claim.attempt}
                own = _mistake.c.submission_id == claim.submission_id, _mistake.c.attempt == claim.attempt
                connection.execute(delete(_mistake).where(*own, _mistake.c.code.contains(".")))
                if connection.execute(select(_mistake.c.code).where(*own).limit(1)).first() is None:
                    ranked = enumerate(dict.fromkeys(codes))
                    rows = [{**key, "code": code, "rank": rank} for rank, code in ranked]
                    connection.execute(insert(_mistake), rows)
            return True


def queue_explanation(connection: Connection, submission_id: str, attempt: int, now: datetime) -> None:
    """Have a grading explained in its student's turn, unless it is a trial; of others nothing is kept."""
    waits, cost_s, regrade = connection.execute(_LOAD_OF, {"id": submission_id, "since": now - LATELY}).one()
    if regrade is not None:
        return
    connection.execute(_FORGET, {"of": submission_id})
    turn_at = now + handicap(waits, timedelta(seconds=cost_s or 0.0))
    connection.execute(_QUEUE, {"submission_id": submission_id, "attempt": attempt, "turn_at": turn_at})
