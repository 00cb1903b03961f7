"""The queue: waiting submissions, claims under leases, and how claims end.

Guarantees, whatever process is killed at any time: an accepted submission is graded or ends as
``infrastructure_error``; a result is stored at most once per claim, and only from the latest claim. A claim
raises `attempt`, and `finish` writes only if the row still has that number and worker and is ``running``. So a
worker that wakes up late, or a submission that was delivered twice, changes nothing. `reconcile` queues a
submission again whose lease has ended.
"""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from datetime import timedelta
from statistics import fmean, median
from typing import Any, NamedTuple

from sqlalchemy import ColumnElement, Connection, bindparam, case, func, or_, select, update
from sqlmodel import Session, col

from grader.contracts.assignment import Assignment
from grader.contracts.explanation import is_worth_trying
from grader.contracts.grading import GradingResult
from grader.contracts.rubric import to_judge
from grader.contracts.submission import Claim, QueueState, SubmissionState
from grader.store.claiming import DUE, change, due_early, instants, resume, take
from grader.store.clock import LONGEST_PAUSE, Clock, ahead, longer_pause
from grader.store.database import Database, add_once
from grader.store.explanations import queue_explanation
from grader.store.gradings import (
    AssignmentRows,
    Values,
    detail_values,
    grading_values,
    insert_grading,
)
from grader.store.intake import LATELY
from grader.store.tables import GradedAssignmentRow, GradingRow, SubmissionRow, table_of

_TROUBLE_CHARACTERS = 2_000
_MOST_TRIES_RUNNING = 2  # once a fault of the host, twice rather of the script
_LATEST = 100  # gradings whose durations tell the pace
# Key under which a connection keeps the digests of assignments known to be stored. The process must not keep them:
# a database may be replaced by another one, and then all connections are new.
_STORED_ASSIGNMENTS = "grader_assignments"

_grading = table_of(GradingRow).c
_STORED = select(_grading.worker, _grading.report_sha256).where(
    _grading.submission_id == bindparam("id"), _grading.attempt == bindparam("under")
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Retries:
    """How long a claim lives and how often a submission is tried.

    Attributes:
        lease_s: a claim not renewed for so long is void.
        max_tries: claims before a submission ends as ``infrastructure_error``.
        backoff_s: wait after the first failed try; doubled for each further one, up to an hour.
    """

    lease_s: float = 15.0
    max_tries: int = 5
    backoff_s: float = 1.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Reconciled:
    """What `Queue.reconcile` mended: claims queued again, submissions given up."""

    requeued: int
    given_up: int


class Finished(NamedTuple):
    """Whether a result was stored, and what was claimed in the same transaction."""

    stored: bool
    following: Claim | None = None


class _Claimant(NamedTuple):
    """The worker that wants the next submission, and whether only one whose turn has come, as in `Queue.claim`."""

    worker: str
    in_turn: bool


class Queue:
    """Hands submissions to workers and takes their results; safe to share between threads."""

    def __init__(self, database: Database, clock: Clock, retries: Retries) -> None:
        self._database = database
        self._clock = clock
        self._retries = retries
        self._assignments = AssignmentRows()

    @property
    def lease_s(self) -> float:
        """For how long a claim lives without being renewed."""
        return self._retries.lease_s

    def claim(self, worker: str, *, in_turn: bool = False) -> Claim | None:
        """Take the submission that is due first, or None when nothing is due.

        `in_turn`: leave what its student's other uploads put back until its turn has come, if others might wait
        for it long: another upload of the student is being graded, or was lately and took long.
        """
        with self._database.reading() as session:  # an idle look must not take SQLite's only write lock
            connection, now = session.connection(), self._clock()
            due = connection.execute(DUE, instants(now, in_turn)).first()
            if due is None and (not in_turn or due_early(connection, now) is None):
                return None
        with self._database.writing() as session:
            return take(session.connection(), worker, self._clock(), self.lease_s, in_turn)

    def renew(self, claims: Collection[Claim]) -> set[Claim]:
        """Extend the leases of `claims`; return those that are still valid. One that is not never is again."""
        now, held = self._clock(), set()
        with self._database.writing() as session:
            for claim in sorted(claims, key=lambda one: one.submission_id):  # rows are locked in one order
                values = {"lease_until": now + timedelta(seconds=self._retries.lease_s)}
                if change(session.connection(), claim, values):
                    held.add(claim)
        return held

    def finish(self, claim: Claim, result: GradingResult, assignment: Assignment) -> bool:
        """Store `result` as the grading of `claim`; False when the claim is no longer valid.

        `assignment` is kept as it was graded. The row and everything that belongs to the grading change in
        one transaction. May be called again when the connection broke during the commit.
        """
        return self._finish(claim, result, assignment, None).stored

    def finish_and_claim(
        self,
        claim: Claim,
        result: GradingResult,
        assignment: Assignment,
        worker: str,
        in_turn: bool = False,
    ) -> Finished:
        """Do what `finish` does and, in the same transaction, what `claim` does.

        When the connection broke during the commit, call it again: it returns what that commit claimed. `worker`
        must then know of no other claim of its own.
        """
        return self._finish(claim, result, assignment, _Claimant(worker, in_turn))

    def fail(self, claim: Claim, trouble: str, *, had_run: bool = False) -> SubmissionState | None:
        """End a try that failed on the grader's side: queued again after a pause, or given up.

        It is queued behind what waits by then: what fails again and again delays nobody. `had_run` says that the
        script was running when the try failed, so that it may be the cause: then fewer tries are made.

        Returns:
            The new state, or None when the claim is no longer valid.
        """
        now = self._clock()
        most = min(self._retries.max_tries, _MOST_TRIES_RUNNING) if had_run else self._retries.max_tries
        given_up = claim.tries >= most
        state = SubmissionState.INFRASTRUCTURE_ERROR if given_up else SubmissionState.QUEUED
        due = now + longer_pause(self._retries.backoff_s, claim.tries)
        values = {
            "state": state.value,
            "not_before": due,
            "turn_at": due,
            "finished_at": now if given_up else None,
        }
        return state if self._release(claim, values, trouble) else None

    def hand_back(self, claim: Claim, trouble: str = "", pause_s: float = 0.0) -> bool:
        """Return an unfinished submission to its place in the queue; the try does not count.

        It is not claimed again for `pause_s`. `trouble` says why it could not be graded yet.
        """
        now = self._clock()
        values = {
            "state": SubmissionState.QUEUED.value,
            "tries": max(claim.tries - 1, 0),
            "not_before": now + timedelta(seconds=pause_s),
        }
        return self._release(claim, values, trouble or None)

    def put_behind(self, claim: Claim, trouble: str) -> bool:
        """Return an unfinished one to the queue, behind what others bring in ten minutes: the try counts."""
        now = self._clock()
        values = {"state": SubmissionState.QUEUED.value, "turn_at": now + LATELY, "not_before": now}
        return self._release(claim, values, trouble)

    def hand_back_all(self, workers: Collection[str]) -> list[str]:
        """Do what `hand_back` does with every claim of `workers`; return the submissions.

        That includes claims that they never heard of, because the answer to the commit was lost.
        """
        now = self._clock()
        tries = col(SubmissionRow.tries) - 1
        values = {"state": SubmissionState.QUEUED.value, "tries": tries, "not_before": now}
        with self._database.writing() as session:
            return _void(session, [col(SubmissionRow.worker).in_(workers)], values)

    def reconcile(self, *, all_running: bool = False) -> Reconciled:
        """Put claims past their lease back into the queue; give up those that were tried too often.

        `all_running`: treat every claim as void. Only right when no worker lives (see `presence` of workers).
        """
        now = self._clock()
        lost = [] if all_running else [~ahead(col(SubmissionRow.lease_until), now)]
        spent = col(SubmissionRow.tries) >= self._retries.max_tries
        values = {"not_before": now, "trouble": "the worker that graded this stopped without an answer"}
        ended = {**values, "state": SubmissionState.INFRASTRUCTURE_ERROR.value, "finished_at": now}
        again = {**values, "state": SubmissionState.QUEUED.value, "finished_at": None}
        with self._database.writing() as session:
            given_up = _void(session, [*lost, spent], ended)
            requeued = _void(session, [*lost, ~spent], again)
        return Reconciled(requeued=len(requeued), given_up=len(given_up))

    def bring_forward(self) -> None:
        """Make due what waits for an instant that no pause reaches: the clock was ahead when it was queued.

        Rows that another transaction holds are left for the next time: two transactions could wait for each other.
        """
        now, row = self._clock(), SubmissionRow
        put_off = or_(col(row.tries) == 0, col(row.not_before) > now + LONGEST_PAUSE)
        waits = col(row.state) == SubmissionState.QUEUED.value
        put_off_rows = select(col(row.id)).where(waits, col(row.not_before) > now, put_off)
        ids = put_off_rows.with_for_update(skip_locked=True)
        with self._database.writing() as session:
            session.execute(
                update(row).where(col(row.id).in_(ids)).values(not_before=now),
                execution_options={"synchronize_session": False},
            )

    def state(self) -> QueueState:
        """Count what waits, runs and was given up."""
        counted = (SubmissionState.QUEUED, SubmissionState.RUNNING, SubmissionState.INFRASTRUCTURE_ERROR)
        statement = (
            select(col(SubmissionRow.state), func.count(), func.min(col(SubmissionRow.queued_at)))
            .where(col(SubmissionRow.state).in_([state.value for state in counted]))
            .group_by(col(SubmissionRow.state))
        )
        with self._database.reading() as session:
            rows = {state: (count, oldest) for state, count, oldest in session.execute(statement)}
        nothing = (0, None)
        queued, oldest = rows.get(SubmissionState.QUEUED.value, nothing)
        return QueueState(
            queued=queued,
            running=rows.get(SubmissionState.RUNNING.value, nothing)[0],
            infrastructure_errors=rows.get(SubmissionState.INFRASTRUCTURE_ERROR.value, nothing)[0],
            oldest_queued_at=oldest,
        )

    def position(self, submission_id: str) -> int | None:
        """Return how many submissions are before a waiting one, or None when it does not wait."""
        mine = select(
            col(SubmissionRow.state), col(SubmissionRow.priority), col(SubmissionRow.turn_at)
        ).where(col(SubmissionRow.id) == submission_id)
        with self._database.reading() as session:
            row = session.execute(mine).first()
            if row is None or row[0] != SubmissionState.QUEUED.value:
                return None
            _, priority, turn_at = row
            first = case(
                (col(SubmissionRow.priority) != priority, col(SubmissionRow.priority) < priority),
                (col(SubmissionRow.turn_at) != turn_at, col(SubmissionRow.turn_at) < turn_at),
                else_=col(SubmissionRow.id) < submission_id,
            )
            waiting = col(SubmissionRow.state) == SubmissionState.QUEUED.value
            before = select(func.count()).select_from(SubmissionRow).where(waiting, first)
            return int(session.execute(before).scalar_one())

    def free_bytes(self) -> int | None:
        """Return how much room the disk of the queue has; None of a server's."""
        return self._database.free_bytes()

    def is_due(self, *, in_turn: bool = False) -> bool:
        """Return whether a submission is due; `in_turn`: one whose turn has come."""
        with self._database.reading() as session:
            due = session.connection().execute(DUE, instants(self._clock(), in_turn=in_turn))
            return due.first() is not None

    def mean_duration_s(self) -> float | None:
        """Return how long the latest gradings took from claim to result; None when there are none yet."""
        spans = self._latest_durations_s()
        return fmean(spans) if spans else None

    def median_duration_s(self) -> float | None:
        """Return how long an ordinary one of the latest gradings took; None when there are none yet."""
        spans = self._latest_durations_s()
        return median(spans) if spans else None

    def _latest_durations_s(self) -> list[float]:
        row = SubmissionRow
        latest = (  # no condition on the state: the index on `finished_at` alone answers this
            select(col(row.state), col(row.started_at), col(row.finished_at))
            .where(col(row.finished_at).is_not(None))
            .order_by(col(row.finished_at).desc())
            .limit(_LATEST)
        )
        with self._database.reading() as session:
            rows = session.execute(latest).all()
        return [
            (end - start).total_seconds()
            for state, start, end in rows
            if state == SubmissionState.GRADED.value and start is not None and end is not None
        ]

    def _release(self, claim: Claim, values: Mapping[str, Any], trouble: str | None) -> bool:
        """End `claim` by writing `values`; False when it was not valid.

        `trouble` None: what is kept of an earlier one stays.
        """
        ended: dict[str, Any] = {**values, "lease_until": None}
        if trouble is not None:
            ended["trouble"] = trouble[:_TROUBLE_CHARACTERS]
        with self._database.writing() as session:
            return change(session.connection(), claim, ended)

    def _finish(
        self,
        claim: Claim,
        result: GradingResult,
        assignment: Assignment,
        claimant: _Claimant | None,
    ) -> Finished:
        now = self._clock()
        graded = self._assignments.of(assignment)
        grading = grading_values(claim, result, now, graded["sha256"])
        # A result that a power cut, or a crash of the server, takes away is graded again and comes out the same.
        with self._database.writing(lasting=False) as session:
            connection = session.connection()
            stored_already = _stored_assignments(connection)
            current = change(connection, claim, _outcome(claim, result, grading))
            if current:
                if graded["sha256"] not in stored_already:
                    add_once(connection, GradedAssignmentRow, **graded)
                insert_grading(connection, grading, detail_values(grading, result))
                if is_worth_trying(assignment, result.report):
                    queue_explanation(connection, claim.submission_id, claim.attempt, now)
            stored = current or _stored_already(connection, grading)
            answer_lost = stored and not current
            following = None if claimant is None else self._claim_next(session, claimant, answer_lost)
        if current:
            stored_already.add(graded["sha256"])
        return Finished(stored, following)

    def _claim_next(self, session: Session, claimant: _Claimant, answer_lost: bool) -> Claim | None:
        """Claim what is due next.

        `answer_lost` says that an earlier commit stored the result and its answer was lost. What that commit
        claimed counts.
        """
        worker, in_turn = claimant
        connection = session.connection()
        claimed = resume(connection, worker, self._clock(), self.lease_s) if answer_lost else None
        if claimed is None:
            claimed = take(connection, worker, self._clock(), self.lease_s, in_turn)
        return claimed


def _outcome(claim: Claim, result: GradingResult, grading: Values) -> Values:
    """Return what changes of a submission's row when it is graded."""
    report = result.report
    return {
        "state": SubmissionState.GRADED.value,
        "finished_at": grading["finished_at"],
        "lease_until": None,
        "trouble": "",
        "graded_attempt": claim.attempt,
        "verdict": report.status.value,
        "score": report.score,
        "max_score": report.max_score,
        "report_sha256": grading["report_sha256"],
        "to_judge": to_judge(report.items) or None,
    }


def _stored_assignments(connection: Connection) -> set[str]:
    """Return the digests of assignments known to be stored. Add to them only after the commit, which may fail."""
    stored: set[str] = connection.info.setdefault(_STORED_ASSIGNMENTS, set())
    return stored


def _stored_already(connection: Connection, grading: Values) -> bool:
    """Whether `grading` was stored under this very claim: the answer to an earlier commit got lost."""
    there = connection.execute(_STORED, {"id": grading["submission_id"], "under": grading["attempt"]}).first()
    return there is not None and tuple(there) == (grading["worker"], grading["report_sha256"])


def _void(session: Session, condition: Sequence[ColumnElement[bool]], values: Mapping[str, Any]) -> list[str]:
    """Write `values` to running rows because nobody grades them any more; return their ids.

    Rows that another transaction holds are left out: that transaction takes care of them.
    """
    running = col(SubmissionRow.state) == SubmissionState.RUNNING.value
    rows = select(col(SubmissionRow.id)).where(running, *condition).order_by(col(SubmissionRow.id))
    ids = rows.with_for_update(skip_locked=True)
    statement = update(SubmissionRow).where(col(SubmissionRow.id).in_(ids))
    statement = statement.values(**values, lease_until=None).returning(col(SubmissionRow.id))
    return list(session.execute(statement, execution_options={"synchronize_session": False}).scalars())
