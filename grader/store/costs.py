"""What each student costs the service: the time of their latest gradings, and what waits."""

from collections import defaultdict
from datetime import datetime, timedelta
from typing import Any, Final

from sqlalchemy import Row, or_, select
from sqlmodel import col

from grader.contracts.submission import PersonCost, SubmissionState
from grader.store.clock import TimedPart
from grader.store.tables import SubmissionRow

LATELY: Final = timedelta(hours=1)
_UNFINISHED_STATES = (SubmissionState.QUEUED.value, SubmissionState.RUNNING.value)
_COLUMNS = ("course", "student", "state", "started_at", "finished_at", "tries")


class Costs(TimedPart):
    """Reads what gradings cost; safe to share between threads."""

    def lately(self, course: str | None, *, everywhere: bool = False) -> tuple[PersonCost, ...]:
        """Return the students of a course, or of all, whose submissions wait or were graded in the last hour.

        Whoever held the slots longest comes first.
        """
        row, now = SubmissionRow, self._clock()
        statement = select(*(getattr(row, name) for name in _COLUMNS)).where(
            or_(col(row.state).in_(_UNFINISHED_STATES), col(row.finished_at) >= now - LATELY)
        )
        if not everywhere:
            statement = statement.where(col(row.course) == course)
        by_person: dict[tuple[str | None, str], list[Row[Any]]] = defaultdict(list)
        for one in self._rows(statement):
            by_person[one.course, one.student].append(one)
        costs = (_cost(*person, rows, now) for person, rows in by_person.items())
        return tuple(sorted(costs, key=lambda cost: (-cost.slot_s, -cost.waiting, cost.student)))


def _cost(course: str | None, student: str, rows: list[Row[Any]], now: datetime) -> PersonCost:
    begun = [row for row in rows if row.state != SubmissionState.QUEUED.value and row.started_at is not None]
    spans = ((row.finished_at or now) - row.started_at for row in begun)
    return PersonCost(
        course=course,
        student=student,
        slot_s=sum(max(span.total_seconds(), 0.0) for span in spans),
        gradings=len(begun),
        waiting=sum(row.state == SubmissionState.QUEUED.value for row in rows),
        tries=sum(row.tries for row in rows),
        given_up=sum(row.state == SubmissionState.INFRASTRUCTURE_ERROR.value for row in rows),
    )
