"""Re-grades. A trial is a row of its own in the queue, behind all fresh submissions, that belongs to no student.

So trials are claimed, leased, fenced and retried like every submission, and change nothing until they are applied:
then their gradings are copied to the submissions they were made of, in one transaction. No grading is deleted: an
applied re-grade is undone by letting those stand again that it replaced.
"""

import json
import secrets
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from datetime import datetime
from typing import Any

from sqlalchemy import Insert, Select, and_, case, delete, func, insert, literal, or_, select, update
from sqlalchemy.orm import aliased
from sqlmodel import Session, SQLModel, col

from grader.contracts.errors import RefusedError
from grader.contracts.record import from_json, from_plain
from grader.contracts.regrade import PastGrading, Regrade, RegradeState, ScoreChange, ToldChange, Wanted
from grader.contracts.submission import SubmissionState
from grader.store.audit import Signature, record, require_open
from grader.store.database import Database, StorePart, one_at_a_time
from grader.store.intake import new_id
from grader.store.judgements import settle
from grader.store.score_changes import StandingScores, item_scores, judgements_by, score_change
from grader.store.tables import (
    GradedItemRow,
    GradedMistakeRow,
    GradingRow,
    JudgementRow,
    RegradeRow,
    SubmissionRow,
    ToldChangeRow,
    TrajectoryRow,
    as_contract,
)
from grader.store.undoing import undo

_BEHIND_FRESH = 10
_ID_BYTES = 6
_REMEMBERED = 20  # re-grades whose changes are kept in memory
_OF_GRADING: tuple[type[SQLModel], ...] = (TrajectoryRow, GradedMistakeRow, GradedItemRow, GradingRow)
_Mark = tuple[Any, ...]
_ENDS = (SubmissionState.GRADED.value, SubmissionState.INFRASTRUCTURE_ERROR.value)


@dataclass(frozen=True, slots=True)
class _Trial:
    """One trial grading, the submission it is made of, and what would change."""

    row: SubmissionRow
    original: SubmissionRow
    change: ScoreChange

    @property
    def waits(self) -> bool:
        """Whether it is still to be made."""
        return self.row.state not in _ENDS

    @property
    def failed(self) -> bool:
        """Whether the service failed to make it."""
        return self.row.state == SubmissionState.INFRASTRUCTURE_ERROR.value


class Regrades(StorePart):
    """Opens, shows, applies and discards re-grades; safe to share between threads."""

    def __init__(self, database: Database) -> None:
        super().__init__(database)
        self._latest: dict[str, tuple[_Mark, Regrade]] = {}

    def open(self, wanted: Wanted, signed: Signature) -> Regrade:
        """Queue a trial grading for every submission that `wanted` names.

        Raises RefusedError: no submission fits, the assignment has an open re-grade, or the course is archived.
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
            require_open(session, signed.course)
            if session.execute(_open_ones(signed.course, wanted.assignment)).first() is not None:
                raise RefusedError("regrade_open")
            originals = _chosen(session, wanted, signed.course)
            if not originals:
                raise RefusedError("nothing_to_regrade")
            session.add(row)
            session.flush()
            trials = [_trial_row(original, row.id, signed.at) for original in originals]
            session.add_all(trials)
            session.flush()
            return _regrade(session, row)

    def get(self, regrade_id: str, course: str | None) -> Regrade | None:
        """Return one re-grade of a course, or None."""
        with self._database.reading() as session:
            row = session.get(RegradeRow, regrade_id)
            return None if row is None or row.course != course else self._counted(session, row)

    def all(self, course: str | None) -> tuple[Regrade, ...]:
        """Return the re-grades of a course, newest first."""
        statement = (
            select(RegradeRow)
            .where(col(RegradeRow.course) == course)
            .order_by(col(RegradeRow.created_at).desc(), col(RegradeRow.id))
        )
        with self._database.reading() as session:
            return tuple(self._counted(session, row) for row in session.execute(statement).scalars().all())

    def _counted(self, session: Session, row: RegradeRow) -> Regrade:
        """Return a re-grade. Its trials are counted again only when something has changed."""
        # the texts, too: somebody who is forgotten is in none of them any more
        mark: _Mark = (row.state, row.wanted, row.outcome, row.reason, row.undone_reason, row.created_by)
        if row.state == RegradeState.OPEN.value:
            mark += _mark_of(session, row.id)
        latest = self._latest.get(row.id)
        if latest is None or latest[0] != mark:
            latest = mark, _regrade(session, row)
            self._latest[row.id] = latest
            for oldest in list(self._latest)[:-_REMEMBERED]:
                self._latest.pop(oldest, None)
        return latest[1]

    def apply(self, regrade_id: str, signed: Signature, reason: str) -> Regrade:
        """Make the trial gradings the gradings of their submissions; older ones stay in the history.

        Raises RefusedError: there is none, it was applied or discarded before, or trials still run.
        """
        return self._decide(regrade_id, signed, reason, RegradeState.APPLIED)

    def discard(self, regrade_id: str, signed: Signature, reason: str) -> Regrade:
        """Drop the trial gradings. Raises as `apply` does, but trials may still run."""
        return self._decide(regrade_id, signed, reason, RegradeState.DISCARDED)

    def undo(self, regrade_id: str, signed: Signature, reason: str) -> Regrade:
        """Undo an applied re-grade: the gradings from before it count again.

        What people judged stays, as when a re-grade is applied. Where there was no grading before, there is none
        again.

        Raises:
            RefusedError: there is none; it is not applied; or a later re-grade has taken the place of one of its
                gradings, and must be undone first.
        """
        with self._database.writing() as session:
            row = _locked(session, regrade_id, signed.course)
            if row.state != RegradeState.APPLIED.value:
                raise RefusedError("regrade_not_applied")
            row.state, row.undone_reason = RegradeState.UNDONE.value, reason
            row.undone_at, row.undone_by = signed.at, signed.actor
            for change in undo(session, row.id):
                _note_change(session, change, row, signed, reason)
            session.flush()
            subject = f"regrade {row.id} of {row.assignment}"
            record(session, signed, "regrade.undone", subject, before=row.id, reason=reason)
            return _regrade(session, row)

    def changes_of(self, submission_id: str) -> tuple[ToldChange, ...]:
        """Return what re-grades changed of a submission, the latest first."""
        own = _told_changes().where(col(ToldChangeRow.submission_id) == submission_id)
        return self._read_changes(
            own.order_by(col(ToldChangeRow.at).desc(), col(ToldChangeRow.undone).desc())
        )

    def unseen(self, course: str, student: str) -> tuple[ToldChange, ...]:
        """Return what re-grades changed of a student's submissions that the student has not seen, oldest first."""
        theirs = (col(SubmissionRow.course) == course, col(SubmissionRow.student) == student)
        unseen = _told_changes().where(*theirs, col(ToldChangeRow.seen_at).is_(None))
        return self._read_changes(unseen.order_by(col(ToldChangeRow.at), col(ToldChangeRow.submission_id)))

    def mark_seen(self, submission_id: str, now: datetime) -> None:
        """Note that the student has seen what re-grades changed of a submission."""
        with self._database.writing() as session:
            session.execute(
                update(ToldChangeRow)
                .where(
                    col(ToldChangeRow.submission_id) == submission_id, col(ToldChangeRow.seen_at).is_(None)
                )
                .values(seen_at=now)
            )

    def _read_changes(self, statement: Select[Any]) -> tuple[ToldChange, ...]:
        return tuple(_told_change(*row) for row in self._rows(statement))

    def history(self, submission_id: str) -> tuple[PastGrading, ...]:
        """Return every grading of a submission, oldest first."""
        statement = (
            select(GradingRow, RegradeRow, col(SubmissionRow.graded_attempt))
            .join(SubmissionRow, col(SubmissionRow.id) == col(GradingRow.submission_id))
            .outerjoin(RegradeRow, col(RegradeRow.id) == col(GradingRow.regrade))
            .where(col(GradingRow.submission_id) == submission_id)
            .order_by(col(GradingRow.attempt))
        )
        return tuple(_past(*row) for row in self._rows(statement))

    def _decide(self, regrade_id: str, signed: Signature, reason: str, state: RegradeState) -> Regrade:
        with self._database.writing() as session:
            row = _locked(session, regrade_id, signed.course)
            if row.state != RegradeState.OPEN.value:
                raise RefusedError("regrade_decided")
            _hold(session, row.id)
            trials = _trials_of(session, row.id)
            outcome = _regrade(session, row, trials)
            if state is RegradeState.APPLIED:
                for trial in _adopt(session, trials, row.id):
                    _note_change(session, trial.change, row, signed, reason)
            _delete_trials(session, row.id)
            row.state, row.reason = state.value, reason
            row.decided_at, row.decided_by = signed.at, signed.actor
            row.outcome = json.dumps(
                {
                    "failed": outcome.failed,
                    "same": outcome.same,
                    "kept": outcome.kept,
                    "changes": [asdict(change) for change in outcome.changes],
                }
            )
            session.flush()
            subject = f"regrade {row.id} of {row.assignment}"
            record(session, signed, f"regrade.{state.value}", subject, after=row.id, reason=reason)
            return _regrade(session, row)


def _locked(session: Session, regrade_id: str, course: str | None) -> RegradeRow:
    """Return a re-grade of a course that nobody else decides or undoes meanwhile."""
    row = session.get(RegradeRow, regrade_id, with_for_update=True)
    if row is None or row.course != course:
        raise RefusedError("regrade_not_found")
    return row


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
            best_so_far = best.get(row.student)
            if best_so_far is None or (row.score or 0.0) > (best_so_far.score or 0.0):
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


def _regrade(session: Session, row: RegradeRow, trials: list[_Trial] | None = None) -> Regrade:
    """Return a re-grade; an open one by its `trials`, which are read when not given."""
    if row.state == RegradeState.OPEN.value:
        trials = _trials_of(session, row.id) if trials is None else trials
        graded = [trial.change for trial in trials if not trial.waits and not trial.failed]
        changes = tuple(change for change in graded if change.items or change.before != change.after)
        kept = sum(len(change.kept) for change in graded)
        waiting, failed = sum(trial.waits for trial in trials), sum(trial.failed for trial in trials)
        same = len(graded) - len(changes)
    else:
        outcome = json.loads(row.outcome)
        changes = tuple(from_plain(ScoreChange, change) for change in outcome["changes"])
        waiting, failed, same = 0, outcome["failed"], outcome["same"]
        kept = outcome["kept"]
    return as_contract(
        row,
        Regrade,
        wanted=from_json(Wanted, row.wanted),
        state=RegradeState(row.state),
        waiting=waiting,
        failed=failed,
        same=same,
        changes=changes,
        kept=kept,
    )


def _note_change(
    session: Session, change: ScoreChange, regrade: RegradeRow, signed: Signature, reason: str
) -> None:
    """Record a change in the audit log and for the student, if it is one."""
    if change.before == change.after and not change.items:
        return
    before, after = {"score": change.before}, {"score": change.after, **_judgements_in_log(change)}
    subject = f"submission {change.submission}"
    record(session, signed, "grade.change", subject, before=before, after=after, reason=reason)
    session.add(
        ToldChangeRow(
            submission_id=change.submission,
            regrade=regrade.id,
            undone=regrade.state == RegradeState.UNDONE.value,
            change=json.dumps(asdict(change)),
            at=signed.at,
        )
    )


def _told_changes() -> Select[Any]:
    row: Any = ToldChangeRow
    return (
        select(row, RegradeRow)
        .join(RegradeRow, col(RegradeRow.id) == col(ToldChangeRow.regrade))
        .join(SubmissionRow, col(SubmissionRow.id) == col(ToldChangeRow.submission_id))
    )


def _told_change(row: ToldChangeRow, regrade: RegradeRow) -> ToldChange:
    return as_contract(
        row,
        ToldChange,
        submission=row.submission_id,
        assignment=regrade.assignment,
        change=from_json(ScoreChange, row.change),
        reason=regrade.undone_reason if row.undone else regrade.reason,
        seen=row.seen_at is not None,
    )


def _judgements_in_log(change: ScoreChange) -> dict[str, list[str]]:
    """Return what became of people's judgements, for the audit log."""
    fates = {"judgements kept": list(change.kept), "judgements void": list(change.void)}
    return {name: items for name, items in fates.items() if items}


def _past(grading: GradingRow, regrade: RegradeRow | None, standing: int | None) -> PastGrading:
    return as_contract(
        grading,
        PastGrading,
        status=grading.verdict,
        by="" if regrade is None else regrade.decided_by,
        reason="" if regrade is None else regrade.reason,
        stands=grading.attempt == standing,
    )


def _originals(regrade_id: str) -> Select[str | None]:
    """Select the submissions that the trials of a re-grade are made of."""
    return select(col(SubmissionRow.original)).where(col(SubmissionRow.regrade) == regrade_id)


def _trials_of(session: Session, regrade_id: str) -> list[_Trial]:
    """Return the trials of a re-grade in order of student and arrival."""
    rows = session.execute(select(SubmissionRow).where(col(SubmissionRow.regrade) == regrade_id)).scalars()
    trials = {row.original: row for row in rows}
    statement = (
        select(SubmissionRow)
        .where(col(SubmissionRow.id).in_(_originals(regrade_id)))
        .order_by(col(SubmissionRow.student), col(SubmissionRow.received_at), col(SubmissionRow.id))
    )
    originals = list(session.execute(statement).scalars())
    latest = {submission.id: submission.graded_attempt for submission in (*originals, *trials.values())}
    scores = item_scores(session, {id_: attempt for id_, attempt in latest.items() if attempt is not None})
    judgements = judgements_by(session, [original.id for original in originals])

    def standing_of(row: SubmissionRow) -> StandingScores:
        return StandingScores(items=tuple(scores.get(row.id, ())), score=row.score)

    return [
        _Trial(
            trials[original.id],
            original,
            score_change(
                original.id,
                original.student,
                standing_of(original),
                standing_of(trials[original.id]),
                judgements.get(original.id, ()),
            ),
        )
        for original in originals
    ]


def _hold(session: Session, regrade_id: str) -> None:
    """Lock the trials of a re-grade and their originals: a result that comes now waits until they are gone."""
    concerned = or_(
        col(SubmissionRow.regrade) == regrade_id, col(SubmissionRow.id).in_(_originals(regrade_id))
    )
    in_order = select(col(SubmissionRow.id)).where(concerned).order_by(col(SubmissionRow.id))
    session.execute(in_order.with_for_update()).all()


def _adopt(session: Session, trials: Sequence[_Trial], regrade_id: str) -> list[_Trial]:
    """Copy trials' gradings to their submissions as the latest ones; return the trials it was done with.

    Failed trials are left out, and those whose submission is being graded right now. The number of statements does
    not grow with the number of trials, because other writers of a SQLite database wait meanwhile.

    Raises RefusedError: trials still run.
    """
    if any(trial.waits for trial in trials):
        raise RefusedError("regrade_running")
    adopted = [one for one in trials if not one.failed and one.original.state in _ENDS]
    for table in reversed(_OF_GRADING):
        session.execute(_copy(table, regrade_id))
    for trial in adopted:
        _take_over(trial.original, trial.row)
    session.flush()
    judged = set(session.execute(_judged_ones(regrade_id)).scalars())
    for trial in adopted:
        if trial.original.id in judged:
            settle(session, trial.original)
    return adopted


def _judged_ones(regrade_id: str) -> Select[str]:
    """Select which submissions of a re-grade have judgements by people."""
    ids = col(JudgementRow.submission_id)
    return select(ids).distinct().where(ids.in_(_originals(regrade_id)))


def _copy(table: type[SQLModel], regrade_id: str) -> Insert:
    """Copy what belongs to the trials' gradings to the next attempts of their submissions."""
    trial, original, rows = aliased(SubmissionRow), aliased(SubmissionRow), table.__table__  # type: ignore[attr-defined]
    of_its_own = ("submission_id", "attempt", "regrade", "replaced")
    names = [column.name for column in rows.columns if column.name not in of_its_own]
    key: list[Any] = [col(original.id), col(original.attempt) + 1]
    origin: list[Any] = [literal(regrade_id), col(original.graded_attempt)] if table is GradingRow else []
    of_trial = and_(rows.c.submission_id == trial.id, rows.c.attempt == trial.graded_attempt)
    source = (
        select(*key, *origin, *(rows.c[name] for name in names))
        .select_from(rows)
        .join(trial, of_trial)
        .join(original, col(original.id) == col(trial.original))
        .where(
            col(trial.regrade) == regrade_id,
            col(trial.state) == SubmissionState.GRADED.value,
            col(original.state).in_(_ENDS),
        )
    )
    return insert(rows).from_select(
        ["submission_id", "attempt", *(["regrade", "replaced"] if origin else []), *names], source
    )


def _take_over(original: SubmissionRow, trial: SubmissionRow) -> None:
    original.state = SubmissionState.GRADED.value
    original.attempt += 1  # a worker that still grades it can no longer store its result
    original.graded_attempt = original.attempt
    # both instants: their difference tells the pace of gradings
    original.started_at, original.finished_at = trial.started_at, trial.finished_at
    original.trouble = ""
    original.verdict = trial.verdict
    original.score, original.max_score = trial.score, trial.max_score
    original.report_sha256 = trial.report_sha256
    original.to_judge = trial.to_judge


def _delete_trials(session: Session, regrade_id: str) -> None:
    """Delete trials and their gradings. A worker that still grades one finds its claim void."""
    ids = select(col(SubmissionRow.id)).where(col(SubmissionRow.regrade) == regrade_id)
    statements = [delete(table).where(table.submission_id.in_(ids)) for table in _OF_GRADING]  # type: ignore[attr-defined]
    for statement in (*statements, delete(SubmissionRow).where(col(SubmissionRow.regrade) == regrade_id)):
        session.execute(statement, execution_options={"synchronize_session": False})


def _mark_of(session: Session, regrade_id: str) -> _Mark:
    """Return a value that changes whenever the trials of an open re-grade, or their originals, change."""
    trial, original = aliased(SubmissionRow), aliased(SubmissionRow)
    numbers = [func.sum(col(trial.attempt)), func.sum(func.coalesce(col(trial.graded_attempt), 0))]
    numbers += [func.sum(case((col(trial.state) == state.value, 1), else_=0)) for state in SubmissionState]
    numbers += [func.sum(col(original.attempt)), func.sum(func.coalesce(col(original.graded_attempt), 0))]
    statement = (
        select(func.count(), *numbers)
        .join_from(trial, original, col(original.id) == col(trial.original))
        .where(col(trial.regrade) == regrade_id)
    )
    judged = (
        select(func.count())
        .join_from(trial, JudgementRow, col(JudgementRow.submission_id) == col(trial.original))
        .where(col(trial.regrade) == regrade_id)
    )
    return (*session.execute(statement).one(), session.execute(judged).scalar_one())
