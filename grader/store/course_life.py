"""From one term to the next: copying a course, and archiving it so that it can only be read."""

from dataclasses import dataclass, replace
from zoneinfo import ZoneInfo

from sqlalchemy import select
from sqlmodel import Session, col

from grader.contracts.errors import CourseError, RefusedError
from grader.contracts.identity import Course, Member, unknown_course
from grader.contracts.regrade import RegradeState
from grader.contracts.text import Text
from grader.store.audit import Signature, record
from grader.store.clock import Clock
from grader.store.courses import add_course, add_members
from grader.store.database import Database, one_at_a_time
from grader.store.rules import add_rules, rules_of
from grader.store.tables import CourseRow, RegradeRow, as_contract

MOST_DAYS_MOVED = 3_660


@dataclass(frozen=True, slots=True, kw_only=True)
class NewCourse:
    """A course that begins as a copy of another one.

    Attributes:
        move_days: how many days later than in the other one every date is.
    """

    id: str
    title: str
    move_days: int = 0


class CourseLife:
    """Copies and archives courses; safe to share between threads."""

    def __init__(self, database: Database, clock: Clock) -> None:
        self._database = database
        self._clock = clock

    def copy(self, course_id: str, new: NewCourse, instructor: Member, actor: str) -> Course:
        """Make a course with the rules of `course_id`: which assignments are shown, dates, lateness, attempts.

        Nobody and nothing that was handed in is copied; `instructor` teaches the new course.

        Raises:
            CourseError: there is no such course, or there is one of the new id, or something is not fit.
        """
        if not 0 <= new.move_days <= MOST_DAYS_MOVED:
            raise CourseError(
                f"dates can be moved by 0 to {MOST_DAYS_MOVED} days, not {new.move_days}",
                f"日期可以推后 0 到 {MOST_DAYS_MOVED} 天，不能是 {new.move_days}",
            )
        now = self._clock()
        signed = Signature(now, new.id, actor)
        with self._database.writing() as session:
            original = session.get(CourseRow, course_id)
            if original is None:
                raise unknown_course(course_id)
            fresh = replace(as_contract(original, Course), id=new.id, title=new.title, created_at=now)
            made = add_course(session, fresh, actor, copy_of=course_id)
            zone = ZoneInfo(original.time_zone)
            for assignment, rules in sorted(rules_of(session, course_id).by_assignment.items()):
                add_rules(session, assignment, rules.moved(new.move_days, zone), signed)
            add_members(session, signed, [instructor])
            subject = f"course {course_id}"
            record(session, Signature(now, course_id, actor), "course.copy", subject, after={"copy": new.id})
            return made

    def archive(self, signed: Signature, reason: str = "") -> Course:
        """Let the course of `signed` be read only; one that is archived stays as it is.

        Raises:
            CourseError: there is no such course.
            RefusedError: it has a re-grade that is not decided.
        """
        with self._database.writing() as session:
            row = _held(session, signed)
            if row.archived_at is None:
                _require_decided(session, row.id)
                row.archived_at = signed.at
                record(session, signed, "course.archive", f"course {row.id}", reason=reason)
            return as_contract(row, Course)

    def reopen(self, signed: Signature, reason: str = "") -> Course:
        """Let the course of `signed` be changed again; one that is not archived stays as it is.

        Raises:
            CourseError: there is no such course.
        """
        with self._database.writing() as session:
            row = _held(session, signed)
            if row.archived_at is not None:
                row.archived_at = None
                record(session, signed, "course.unarchive", f"course {row.id}", reason=reason)
            return as_contract(row, Course)


def _held(session: Session, signed: Signature) -> CourseRow:
    one_at_a_time(session, "course", signed.course)
    row = session.get(CourseRow, signed.course or "", with_for_update=True)
    if row is None:
        raise unknown_course(signed.course or "")
    return row


def _require_decided(session: Session, course: str) -> None:
    undecided = select(col(RegradeRow.assignment)).where(
        col(RegradeRow.course) == course, col(RegradeRow.state) == RegradeState.OPEN.value
    )
    assignment = session.execute(undecided.limit(1)).scalar_one_or_none()
    if assignment is not None:
        raise RefusedError(
            "regrade_open",
            Text(
                zh=f"作业 {assignment} 有未决定的重新评分：请先采用或放弃。",
                en=f"{assignment} has an open re-grade: apply or discard it first.",
            ),
        )
