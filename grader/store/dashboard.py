"""What an instructor asks of the rows, counted by the database."""

from typing import Any

from sqlalchemy import Integer, Subquery, and_, case, cast, distinct, func, or_, select
from sqlmodel import Session, col

from grader.contracts.dashboard import ClassState, ItemFailures, MistakeCount, Progress
from grader.contracts.report import GradeStatus
from grader.contracts.rubric import ItemStatus
from grader.contracts.submission import SubmissionState
from grader.store.database import Database
from grader.store.tables import GradedItemRow, GradedMistakeRow, SubmissionRow


class Dashboard:
    """Counts over all submissions; safe to share between threads."""

    def __init__(self, database: Database) -> None:
        self._database = database

    def state(self) -> ClassState:
        """Count everything on one snapshot, students in order of name."""
        with self._database.reading() as session:
            return ClassState(
                progress=_progress(session), failures=_failures(session), mistakes=_mistakes(session)
            )


def _ranked() -> Subquery:
    """Every submission with its rank among its student's submissions to that assignment."""
    own: Any = {"partition_by": (col(SubmissionRow.student), col(SubmissionRow.assignment))}
    score, received = col(SubmissionRow.score), col(SubmissionRow.received_at)
    identity = col(SubmissionRow.id)
    counts = cast(col(SubmissionRow.state) != SubmissionState.INFRASTRUCTURE_ERROR.value, Integer)
    best_first = (score.desc().nulls_last(), received, identity)
    return select(
        SubmissionRow,
        func.row_number().over(order_by=best_first, **own).label("best_rank"),
        func.row_number().over(order_by=(received.desc(), identity.desc()), **own).label("latest_rank"),
        func.sum(counts).over(**own).label("attempts"),
    ).subquery()


def _progress(session: Session) -> tuple[Progress, ...]:
    ranked = _ranked()
    statement = (
        select(ranked)
        .where(or_(ranked.c.best_rank == 1, ranked.c.latest_rank == 1))
        .order_by(ranked.c.student, ranked.c.assignment)
    )
    best: dict[tuple[str, str], Any] = {}
    latest: dict[tuple[str, str], Any] = {}
    for row in session.execute(statement).mappings():
        key = (row["student"], row["assignment"])
        if row["best_rank"] == 1:
            best[key] = row
        if row["latest_rank"] == 1:
            latest[key] = row
    return tuple(_one_progress(best[key], row) for key, row in latest.items())


def _one_progress(best: Any, latest: Any) -> Progress:
    scored = best["score"] is not None
    return Progress(
        student=latest["student"],
        assignment=latest["assignment"],
        attempts=int(latest["attempts"]),
        best_score=best["score"],
        max_score=best["max_score"],
        best_submission=best["id"] if scored else None,
        latest_submission=latest["id"],
        state=SubmissionState(latest["state"]),
        verdict=None if latest["verdict"] is None else GradeStatus(latest["verdict"]),
        last_activity_at=latest["received_at"],
    )


def _failures(session: Session) -> tuple[ItemFailures, ...]:
    ranked = _ranked()
    failed = col(GradedItemRow.status) == ItemStatus.FAILED.value
    ever = func.count(distinct(ranked.c.student))
    still = func.count(distinct(case((ranked.c.best_rank == 1, ranked.c.student))))
    statement = (
        select(ranked.c.assignment, col(GradedItemRow.item), ever, still)
        .join_from(ranked, GradedItemRow, _of_latest_grading(ranked, GradedItemRow))
        .where(failed)
        .group_by(ranked.c.assignment, col(GradedItemRow.item))
        .order_by(ranked.c.assignment, ever.desc(), col(GradedItemRow.item))
    )
    return tuple(
        ItemFailures(assignment=assignment, item=item, ever=by, still=now)
        for assignment, item, by, now in _rows(session, statement)
    )


def _mistakes(session: Session) -> tuple[MistakeCount, ...]:
    submissions = SubmissionRow.__table__  # type: ignore[attr-defined]
    students = func.count(distinct(submissions.c.student))
    statement = (
        select(submissions.c.assignment, col(GradedMistakeRow.code), students)
        .join_from(submissions, GradedMistakeRow, _of_latest_grading(submissions, GradedMistakeRow))
        .group_by(submissions.c.assignment, col(GradedMistakeRow.code))
        .order_by(submissions.c.assignment, students.desc(), col(GradedMistakeRow.code))
    )
    return tuple(
        MistakeCount(assignment=assignment, code=code, students=count)
        for assignment, code, count in _rows(session, statement)
    )


def _of_latest_grading(submissions: Any, row: type[GradedItemRow] | type[GradedMistakeRow]) -> Any:
    return and_(submissions.c.id == col(row.submission_id), submissions.c.graded_attempt == col(row.attempt))


def _rows(session: Session, statement: Any) -> list[Any]:
    return list(session.execute(statement).all())
