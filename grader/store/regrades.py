"""Re-grades. A trial is a row of its own in the queue, behind all fresh submissions, that belongs to no student.

So trials are claimed, leased, fenced and retried like every submission, and change nothing until they are
applied: then their gradings are copied to the submissions they were made of, in one transaction.
"""

import json
import secrets
from collections.abc import Callable
from dataclasses import asdict
from datetime import datetime

from sqlalchemy import Select, select
from sqlmodel import Session, col

from grader.contracts.codec import from_plain
from grader.contracts.errors import RegradeError
from grader.contracts.regrade import PastGrading, Regrade, RegradeState, ScoreChange, Wanted
from grader.contracts.submission import SubmissionState
from grader.store.announcing import waiting_as
from grader.store.audit import Signature, record
from grader.store.database import Database
from grader.store.intake import new_id
from grader.store.locks import one_at_a_time
from grader.store.regrade_rows import Mark, Trial, adopt, delete_trials, hold, mark_of, trials_of
from grader.store.tables import GradingRow, RegradeRow, SubmissionRow

_BEHIND_FRESH = 10
_ID_BYTES = 6
_REMEMBERED = 20  # re-grades whose changes are kept in memory


class Regrades:
    """Opens, shows, applies and discards re-grades; safe to share between threads."""

    def __init__(self, database: Database) -> None:
        self._database = database
        self._latest: dict[str, tuple[Mark, Regrade]] = {}

    def open(self, wanted: Wanted, signed: Signature) -> Regrade:
        """Queue a trial grading for every submission that `wanted` names.

        Raises:
            RegradeError: ``nothing``: there is none; ``open``: the assignment has a re-grade already.
        """
        row = RegradeRow(
            id=secrets.token_hex(_ID_BYTES),
            course=signed.course,
            assignment=wanted.assignment,
            state=RegradeState.OPEN.value,
            wanted=json.dumps(asdict(wanted)),
            created_at=signed.at,
            created_by=signed.actor,
        )
        with self._database.writing() as session:
            one_at_a_time(session, "regrade", signed.course, wanted.assignment)
            if session.execute(_open_ones(signed.course, wanted.assignment)).first() is not None:
                raise RegradeError("open", "the assignment has an open re-grade: apply or discard it first")
            originals = _chosen(session, wanted, signed.course)
            if not originals:
                raise RegradeError("nothing", "no submission fits")
            session.add(row)
            session.flush()
            trials = [_trial_row(original, row.id, signed.at) for original in originals]
            session.add_all(trials)
            session.flush()
            self._database.announcer.queued(session, [waiting_as(trial) for trial in trials], signed.at)
            return _regrade(session, row)

    def get(self, regrade_id: str, course: str | None) -> Regrade | None:
        """Return one re-grade of a course, or None."""
        with self._database.reading() as session:
            row = session.get(RegradeRow, regrade_id)
            return None if row is None or row.course != course else self._seen(session, row)

    def all(self, course: str | None) -> tuple[Regrade, ...]:
        """Return the re-grades of a course, newest first."""
        statement = (
            select(RegradeRow)
            .where(col(RegradeRow.course) == course)
            .order_by(col(RegradeRow.created_at).desc(), col(RegradeRow.id))
        )
        with self._database.reading() as session:
            return tuple(self._seen(session, row) for row in session.execute(statement).scalars().all())

    def _seen(self, session: Session, row: RegradeRow) -> Regrade:
        """Return a re-grade, counted anew only when something has happened to it."""
        mark: Mark = (row.state,)
        if row.state == RegradeState.OPEN.value:
            mark += mark_of(session, row.id)
        known = self._latest.get(row.id)
        if known is None or known[0] != mark:
            known = mark, _regrade(session, row)
            self._latest[row.id] = known
            for oldest in list(self._latest)[:-_REMEMBERED]:
                self._latest.pop(oldest, None)
        return known[1]

    def apply(self, regrade_id: str, signed: Signature, reason: str) -> Regrade:
        """Make the trial gradings the gradings of their submissions; older ones stay in the history.

        Raises:
            RegradeError: ``unknown``; ``decided``: applied or discarded before; ``waiting``: trials still run.
        """

        def adopt_all(session: Session, row: RegradeRow, trials: list[Trial]) -> None:
            if any(trial.waits for trial in trials):
                raise RegradeError("waiting", "not every trial grading is made yet")
            for trial in adopt(session, trials, row.id):
                _note_change(session, trial, signed, reason)

        return self._decide(regrade_id, signed, reason, RegradeState.APPLIED, adopt_all)

    def discard(self, regrade_id: str, signed: Signature, reason: str) -> Regrade:
        """Forget the trial gradings. Raises as `apply` does, but trials may still run."""
        return self._decide(regrade_id, signed, reason, RegradeState.DISCARDED, lambda *_: None)

    def history(self, submission_id: str) -> tuple[PastGrading, ...]:
        """Return every grading of a submission, oldest first."""
        statement = (
            select(GradingRow, RegradeRow)
            .outerjoin(RegradeRow, col(RegradeRow.id) == col(GradingRow.regrade))
            .where(col(GradingRow.submission_id) == submission_id)
            .order_by(col(GradingRow.attempt))
        )
        with self._database.reading() as session:
            return tuple(_past(grading, regrade) for grading, regrade in session.execute(statement))

    def _decide(
        self,
        regrade_id: str,
        signed: Signature,
        reason: str,
        state: RegradeState,
        act: Callable[[Session, RegradeRow, list[Trial]], None],
    ) -> Regrade:
        with self._database.writing() as session:
            row = session.get(RegradeRow, regrade_id, with_for_update=True)
            if row is None or row.course != signed.course:
                raise RegradeError("unknown", "there is no such re-grade")
            if row.state != RegradeState.OPEN.value:
                raise RegradeError("decided", f"the re-grade is {row.state} already")
            hold(session, row.id)
            trials = trials_of(session, row.id)
            outcome = _regrade(session, row, trials)
            act(session, row, trials)
            delete_trials(session, row.id)
            row.state, row.reason = state.value, reason
            row.decided_at, row.decided_by = signed.at, signed.actor
            row.outcome = json.dumps(
                {
                    "failed": outcome.failed,
                    "same": outcome.same,
                    "kept": outcome.kept,
                    "changes": [asdict(one) for one in outcome.changes],
                }
            )
            session.flush()
            subject = f"regrade {row.id} of {row.assignment}"
            record(session, signed, f"regrade.{state.value}", subject, after=row.id, reason=reason)
            return _regrade(session, row)


def _open_ones(course: str | None, assignment: str) -> Select[str]:
    return select(col(RegradeRow.id)).where(
        col(RegradeRow.course) == course,
        col(RegradeRow.assignment) == assignment,
        col(RegradeRow.state) == RegradeState.OPEN.value,
    )


def _chosen(session: Session, wanted: Wanted, course: str | None) -> list[SubmissionRow]:
    fault = wanted.which == "faults"
    state = SubmissionState.INFRASTRUCTURE_ERROR if fault else SubmissionState.GRADED
    statement = select(SubmissionRow).where(
        col(SubmissionRow.course) == course,
        col(SubmissionRow.assignment) == wanted.assignment,
        col(SubmissionRow.state) == state.value,
        col(SubmissionRow.regrade).is_(None),
    )
    if wanted.students:
        statement = statement.where(col(SubmissionRow.student).in_(wanted.students))
    in_order = statement.order_by(col(SubmissionRow.received_at), col(SubmissionRow.id))
    rows = list(session.execute(in_order).scalars())
    if wanted.which == "latest":
        return list({row.student: row for row in rows}.values())
    if wanted.which == "best":
        best: dict[str, SubmissionRow] = {}
        for row in rows:
            known = best.get(row.student)
            if known is None or (row.score or 0.0) > (known.score or 0.0):
                best[row.student] = row
        return list(best.values())
    return rows


def _trial_row(original: SubmissionRow, regrade_id: str, now: datetime) -> SubmissionRow:
    return SubmissionRow(
        id=new_id(now),
        course=original.course,
        student="",  # nobody's: no list, limit or count of a student's work sees it
        assignment=original.assignment,
        file_name=original.file_name,
        source_sha256=original.source_sha256,
        size_bytes=original.size_bytes,
        state=SubmissionState.QUEUED.value,
        priority=_BEHIND_FRESH,
        received_at=original.received_at,
        queued_at=now,
        turn_at=now,
        not_before=now,
        regrade=regrade_id,
        original=original.id,
    )


def _regrade(session: Session, row: RegradeRow, trials: list[Trial] | None = None) -> Regrade:
    """Return a re-grade; an open one by its `trials`, which are read when not given."""
    if row.state == RegradeState.OPEN.value:
        trials = trials_of(session, row.id) if trials is None else trials
        made = [trial.change for trial in trials if not trial.waits and not trial.failed]
        changes = tuple(change for change in made if change.items or change.before != change.after)
        kept = sum(len(change.kept) for change in made)
        waiting, failed = sum(trial.waits for trial in trials), sum(trial.failed for trial in trials)
        same = len(made) - len(changes)
    else:
        told = json.loads(row.outcome)
        changes = tuple(from_plain(ScoreChange, one) for one in told["changes"])
        waiting, failed, same = 0, told["failed"], told["same"]
        kept = told.get("kept", 0)  # re-grades decided before there were judgements do not say
    return Regrade(
        id=row.id,
        course=row.course,
        wanted=from_plain(Wanted, json.loads(row.wanted)),
        state=RegradeState(row.state),
        created_at=row.created_at,
        created_by=row.created_by,
        decided_at=row.decided_at,
        decided_by=row.decided_by,
        reason=row.reason,
        waiting=waiting,
        failed=failed,
        same=same,
        changes=changes,
        kept=kept,
    )


def _note_change(session: Session, trial: Trial, signed: Signature, reason: str) -> None:
    change = trial.change
    if change.before != change.after or change.items:
        subject = f"submission {change.submission}"
        before, after = {"score": change.before}, {"score": change.after, **_judgements(change)}
        record(session, signed, "grade.change", subject, before=before, after=after, reason=reason)


def _judgements(change: ScoreChange) -> dict[str, list[str]]:
    """Return what became of people's judgements, for the audit log."""
    told = {"judgements kept": list(change.kept), "judgements void": list(change.void)}
    return {name: items for name, items in told.items() if items}


def _past(grading: GradingRow, regrade: RegradeRow | None) -> PastGrading:
    return PastGrading(
        attempt=grading.attempt,
        finished_at=grading.finished_at,
        grader_version=grading.grader_version,
        assignment_version=grading.assignment_version,
        status=grading.verdict,
        score=grading.score,
        max_score=grading.max_score,
        report_sha256=grading.report_sha256,
        by="" if regrade is None else regrade.decided_by,
        reason="" if regrade is None else regrade.reason,
    )
