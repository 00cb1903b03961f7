"""The queue: submissions that wait, claims under leases, and what becomes of a claim.

Guarantees, whatever is killed when: an accepted submission is graded or ends as ``infrastructure_error``;
a result is stored at most once per claim and only from the latest claim. A claim raises `attempt`, and
`finish` writes only where the row still carries that number and is ``running``: a worker that wakes up late,
or a submission delivered twice, changes nothing. A claim whose lease ran out goes back to the queue in
`reconcile`.
"""

from collections.abc import Collection
from dataclasses import dataclass
from datetime import datetime, timedelta
from statistics import fmean

from sqlalchemy import Connection, case, func, select
from sqlmodel import Session, col

from grader.contracts.assignment import Assignment
from grader.contracts.grading import GradingResult
from grader.contracts.judgement import to_judge
from grader.contracts.submission import Claim, QueueState, SubmissionState
from grader.store import claim_rows
from grader.store.columns import Clock
from grader.store.database import Database
from grader.store.locks import add_once
from grader.store.results import RememberedRows, Values, detail_values, grading_values, insert_grading
from grader.store.tables import GradedAssignmentRow, SubmissionRow
from grader.store.together import together

_TROUBLE_CHARACTERS = 2_000
_MOST_DOUBLINGS = 60  # as many make an hour of any pause
_LATEST = 100  # gradings whose durations tell the pace
_ASSIGNMENTS = "grader_assignments"  # what a connection has seen stored: a database that lost it has others


@dataclass(frozen=True, slots=True, kw_only=True)
class RetryPolicy:
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
    """What `Queue.reconcile` mended: claims queued again, submissions given up, lost announcements made again."""

    requeued: int
    given_up: int
    announced: int = 0


class Queue:
    """Hands submissions to workers and takes their results; safe to share between threads."""

    def __init__(self, database: Database, clock: Clock, policy: RetryPolicy) -> None:
        self._database = database
        self._clock = clock
        self._policy = policy
        self._remembered = RememberedRows()

    @property
    def lease_s(self) -> float:
        """For how long a claim lives without being renewed."""
        return self._policy.lease_s

    def claim(self, worker: str) -> Claim | None:
        """Take the submission that is due first, or None when nothing is due."""
        if self._database.is_sqlite:  # an idle poll must not take the only write lock
            with self._database.reading() as session:
                if session.connection().execute(claim_rows.DUE, {"now": self._clock()}).first() is None:
                    return None
        with self._database.writing() as session:
            return self._take(session.connection(), worker)

    def renew(self, claims: Collection[Claim]) -> set[Claim]:
        """Extend the leases of `claims`; return those that are still valid. One that is not never is again."""
        now, held = self._clock(), set()
        with self._database.writing() as session:
            for claim in sorted(claims, key=lambda one: one.submission_id):  # rows are locked in one order
                values = {"lease_until": now + timedelta(seconds=self._policy.lease_s)}
                if claim_rows.change(session.connection(), claim, values):
                    held.add(claim)
        return held

    def finish(self, claim: Claim, result: GradingResult, assignment: Assignment | None = None) -> bool:
        """Store `result` as the grading of `claim`; False when the claim is no longer valid.

        `assignment` is kept as it was graded. The row and everything that belongs to the grading change in
        one transaction. May be called again when the connection broke during the commit.
        """
        return self._finish(claim, result, assignment, None)[0]

    def finish_and_claim(
        self, claim: Claim, result: GradingResult, assignment: Assignment, worker: str
    ) -> tuple[bool, Claim | None]:
        """Do what `finish` does and, in the same transaction, what `claim` does.

        So a slot that has just graded takes the next submission that is due without having been told of one. The
        announcement that somebody would have been told by is taken away. Called again because the connection broke
        during the commit, it returns what was claimed then: `worker` must know of no other claim of its own.
        """
        return self._finish(claim, result, assignment, worker)

    def fail(self, claim: Claim, trouble: str) -> SubmissionState | None:
        """End a try that failed on the grader's side: queued again after a pause, or given up.

        Returns:
            The new state, or None when the claim is no longer valid.
        """
        now = self._clock()
        given_up = claim.tries >= self._policy.max_tries
        state = SubmissionState.INFRASTRUCTURE_ERROR if given_up else SubmissionState.QUEUED
        doublings = min(claim.tries - 1, _MOST_DOUBLINGS)
        pause_s = min(self._policy.backoff_s * 2.0**doublings, claim_rows.LONGEST_PAUSE.total_seconds())
        values = {
            "state": state.value,
            "not_before": now + timedelta(seconds=pause_s),
            "finished_at": now if given_up else None,
            "lease_until": None,
            "trouble": trouble[:_TROUBLE_CHARACTERS],
        }
        with self._database.writing() as session:
            if not claim_rows.change(session.connection(), claim, values):
                return None
            if not given_up:
                self._announce(session, claim, now)
            return state

    def hand_back(self, claim: Claim) -> bool:
        """Return an unfinished submission to its place in the queue; the try does not count."""
        now = self._clock()
        values = {
            "state": SubmissionState.QUEUED.value,
            "tries": max(claim.tries - 1, 0),
            "not_before": now,
            "lease_until": None,
        }
        with self._database.writing() as session:
            if not claim_rows.change(session.connection(), claim, values):
                return False
            self._announce(session, claim, now)
            return True

    def hand_back_all(self, workers: Collection[str]) -> list[str]:
        """Do what `hand_back` does with all that `workers` hold, and return it.

        Also with what they never heard of: the answer to a commit that claimed it was lost.
        """
        now = self._clock()
        tries = col(SubmissionRow.tries) - 1
        values = {"state": SubmissionState.QUEUED.value, "tries": tries, "not_before": now}
        with self._database.writing() as session:
            returned = claim_rows.void(session, [col(SubmissionRow.worker).in_(workers)], values)
            self._database.announcer.queued(session, returned, now)
        return [one.submission_id for one in returned]

    def reconcile(self, *, all_running: bool = False) -> Reconciled:
        """Put claims past their lease back into the queue; give up those that were tried too often.

        Args:
            all_running: treat every claim as void. Only right when no worker lives (see `presence` of workers).
        """
        now = self._clock()
        lost = [] if all_running else [claim_rows.lease_ended(now)]
        spent = col(SubmissionRow.tries) >= self._policy.max_tries
        values = {"not_before": now, "trouble": "the worker that graded this stopped without an answer"}
        ended = {**values, "state": SubmissionState.INFRASTRUCTURE_ERROR.value, "finished_at": now}
        again = {**values, "state": SubmissionState.QUEUED.value, "finished_at": None}
        with self._database.writing() as session:
            given_up = claim_rows.void(session, [*lost, spent], ended)
            requeued = claim_rows.void(session, [*lost, ~spent], again)
            self._database.announcer.queued(session, requeued, now)
            announced = self._database.announcer.mend(session, now)
        return Reconciled(requeued=len(requeued), given_up=len(given_up), announced=announced)

    def sweep(self) -> Reconciled:
        """Do of `reconcile` what judges no claim, and undo what a clock that was ahead did to the queue."""
        now = self._clock()
        with self._database.writing() as session:
            claim_rows.bring_forward(session, now)
            announced = self._database.announcer.mend(session, now)
        return Reconciled(requeued=0, given_up=0, announced=announced)

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
            ahead = select(func.count()).select_from(SubmissionRow).where(waiting, first)
            return int(session.execute(ahead).scalar_one())

    def mean_duration_s(self) -> float | None:
        """Return how long the latest gradings took from claim to result; None when there are none yet."""
        row = SubmissionRow
        latest = (  # nothing else is asked of them here, so that the index on `finished_at` finds them
            select(col(row.state), col(row.started_at), col(row.finished_at))
            .where(col(row.finished_at).is_not(None))
            .order_by(col(row.finished_at).desc())
            .limit(_LATEST)
        )
        with self._database.reading() as session:
            rows = session.execute(latest).all()
        spans = [
            (end - start).total_seconds()
            for state, start, end in rows
            if state == SubmissionState.GRADED.value and start is not None and end is not None
        ]
        return fmean(spans) if spans else None

    def _announce(self, session: Session, claim: Claim, now: datetime) -> None:
        self._database.announcer.queued(session, claim_rows.found(session, claim), now)

    def _finish(
        self, claim: Claim, result: GradingResult, assignment: Assignment | None, worker: str | None
    ) -> tuple[bool, Claim | None]:
        now = self._clock()
        graded = None if assignment is None else self._remembered.values(assignment)
        grading = grading_values(claim, result, now, None if graded is None else graded["sha256"])
        details = detail_values(grading, result)
        with self._database.changing() as connection:
            known_there: set[str] = connection.info.setdefault(_ASSIGNMENTS, set())
            current = claim_rows.change(connection, claim, _outcome(claim, result, grading))
            stored = current or claim_rows.stored_already(connection, grading)
            known = None
            if worker is not None and stored and not current:  # the answer to an earlier commit got lost
                known = claim_rows.resume(connection, worker, self._clock(), self._policy.lease_s)
            taken = None if worker is None or known else self._take(connection, worker)
            with together(connection, last=True):
                if current and graded is not None and graded["sha256"] not in known_there:
                    add_once(connection, GradedAssignmentRow, **graded)
                if current:
                    insert_grading(connection, grading, details)
                if taken is not None:
                    self._database.announcer.claimed(connection, taken)
        if current and graded is not None:
            known_there.add(graded["sha256"])
        return stored, known or taken

    def _take(self, connection: Connection, worker: str) -> Claim | None:
        return claim_rows.take(connection, worker, self._clock(), self._policy.lease_s)


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
