"""A course from one term to the next: copied, archived so that it can only be read, emptied of what is old."""

from dataclasses import dataclass, replace
from datetime import datetime, timedelta
from zoneinfo import ZoneInfo

from sqlalchemy import delete, select
from sqlmodel import Session, col

from grader.contracts.errors import CourseError, RefusedError
from grader.contracts.identity import (
    Course,
    Member,
    Role,
    checked_id,
    folded_id,
    unknown_course,
    unknown_members,
)
from grader.contracts.regrade import RegradeState
from grader.store.audit import Signature, record
from grader.store.clock import TimedPart
from grader.store.courses import add_course, add_members
from grader.store.database import empty_log, in_lots, one_at_a_time
from grader.store.erasing import AT_ONCE, Space, erase, finished_before, ids_of, space_of
from grader.store.forgetting import (
    Forgotten,
    give_new_id,
    is_known,
    known_as,
    new_pseudonym,
    rename_everywhere,
)
from grader.store.own_assignments import copy_own_assignments
from grader.store.rules import add_rules, rules_of
from grader.store.tables import (
    OF_MEMBERS,
    CourseRow,
    MemberRow,
    RegradeRow,
    SubmissionRow,
    as_contract,
)

MOST_DAYS_MOVED = 3_660
MOST_DAYS_OLD = 36_600


@dataclass(frozen=True, slots=True, kw_only=True)
class NewCourse:
    """A course that begins as a copy of another one.

    Attributes:
        title: blank: the id.
        move_days: how many days later than in the other one every date is.
    """

    id: str
    title: str
    move_days: int = 0


class CourseLife(TimedPart):
    """Copies and archives courses; safe to share between threads."""

    def copy(self, course_id: str, new: NewCourse, instructor: Member, actor: str) -> Course:
        """Make a course with the rules of `course_id`: which assignments are shown, dates, lateness, attempts.

        Nobody and nothing that was handed in is copied; `instructor` teaches the new course.

        Raises CourseError: there is no such course, or there is one of the new id, or something is not fit.
        """
        if not 0 <= new.move_days <= MOST_DAYS_MOVED:
            raise CourseError(
                f"dates can be moved by 0 to {MOST_DAYS_MOVED} days, not {new.move_days}",
                f"日期可以推后 0 到 {MOST_DAYS_MOVED} 天，不能是 {new.move_days}",
                "move_days",
            )
        now = self._clock()
        signed = Signature(now, new.id, actor)
        with self._database.writing() as session:
            original = session.get(CourseRow, course_id)
            if original is None:
                raise unknown_course(course_id)
            fresh = replace(as_contract(original, Course), id=new.id, title=new.title, created_at=now)
            course = add_course(session, fresh, actor, copy_of=course_id)
            session.get_one(CourseRow, course.id).begun_with = original.begun_with
            zone = ZoneInfo(original.time_zone)
            for assignment, rules in sorted(rules_of(session, course_id).by_assignment.items()):
                add_rules(session, assignment, rules.moved(new.move_days, zone), signed)
            copy_own_assignments(session, course_id, signed)
            add_members(session, signed, [instructor])
            subject = f"course {course_id}"
            record(session, Signature(now, course_id, actor), "course.copy", subject, after={"copy": new.id})
            return course

    def archive(self, signed: Signature, reason: str = "") -> Course:
        """Make the course of `signed` read-only; one that is archived stays as it is.

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
        """Allow changes of the course of `signed` again; one that is not archived stays as it is.

        Raises CourseError: there is no such course.
        """
        with self._database.writing() as session:
            row = _held(session, signed)
            if row.archived_at is not None:
                row.archived_at = None
                record(session, signed, "course.reopen", f"course {row.id}", reason=reason)
            return as_contract(row, Course)

    def work_of(self, course: str, person: str) -> int:
        """Return how many submissions `forget` would erase. Raises as `forget`."""
        own = col(SubmissionRow.course) == course, col(SubmissionRow.student) == person
        with self._database.reading() as session:
            _require_student(session, course, person)
            return len(ids_of(session, *own))

    def forget(self, person: str, signed: Signature, reason: str = "") -> Forgotten:
        """Remove a student from the course of `signed`, erase their work, and put a pseudonym in their place.

        Raises CourseError: there is no such course, nothing names such a person, or they are no student.
        """
        course = signed.course or ""
        pseudonym = new_pseudonym()
        with self._database.writing() as session:  # from here on nothing of theirs is taken in
            _held(session, signed)
            _require_student(session, course, person)
            names = known_as(session, course, person)
            for table in OF_MEMBERS:
                theirs = col(table.course) == course, col(table.person) == person
                session.execute(delete(table).where(*theirs))
        with self._database.writing() as session:  # after the last upload that had begun before
            one_at_a_time(session, "uploads", course, person)
            row = SubmissionRow
            own = ids_of(session, col(row.course) == course, col(row.student) == person)
            erase(session, own)
            scrub = rename_everywhere(session, course, person, pseudonym, names)
            after = {"submissions": len(own)}
            record(session, signed, "member.forget", f"member {pseudonym}", after=after, reason=scrub(reason))
        empty_log(self._database)
        return Forgotten(pseudonym=pseudonym, submissions=len(own))

    def renumber(self, person: str, new: str, signed: Signature, reason: str = "") -> None:
        """Give a student of the course of `signed` another id, under which everything of theirs stays.

        Raises CourseError: there is no such student, or `new` cannot be an id or is somebody's.
        """
        course = signed.course or ""
        with self._database.writing() as session:
            _held(session, signed)
            one_at_a_time(session, "uploads", course, person)
            row = session.get(MemberRow, (course, person))
            if row is None or row.role != Role.STUDENT.value:
                raise unknown_members(course, person)
            _require_free(session, course, person, checked_id(new, "id"))
            session.add(MemberRow(**{**row.model_dump(), "person": new}))
            session.flush()  # before what refers to it
            give_new_id(session, course, person, new)
            session.delete(row)
            before, after = {"id": person}, {"id": new}
            record(
                session, signed, "member.renumber", f"member {new}", before=before, after=after, reason=reason
            )

    def space(self, course: str | None = None) -> dict[str, Space]:
        """Return by course (of one, or of all) what is stored of its submissions."""
        of = col(SubmissionRow.course)
        which = of.is_not(None) if course is None else of == course
        with self._database.reading() as session:
            return {key: one for key, one in space_of(session, which).items() if key is not None}

    def old_work(self, course: str | None, older_than_days: int) -> dict[str, Space]:
        """Return by course what `erase_old_work` would erase."""
        with self._database.reading() as session:
            space = space_of(session, *finished_before(self._since(older_than_days), course))
            return {key: one for key, one in space.items() if key is not None}

    def erase_old_work(
        self, course: str | None, older_than_days: int, actor: str, reason: str = ""
    ) -> dict[str, Space]:
        """Erase submissions (of one course, or of all) that arrived so long ago; return what that was.

        Raises CourseError: the age is none.
        """
        since, erased = self._since(older_than_days), self.old_work(course, older_than_days)
        for name in sorted(erased):
            with self._database.reading() as session:
                ids = ids_of(session, *finished_before(since, name))
            signed = Signature(self._clock(), name, actor)
            after = {"submissions": len(ids), "older_than_days": older_than_days}
            with self._database.writing() as session:  # first: what is erased is in the log, whatever happens
                record(session, signed, "course.retain", f"course {name}", after=after, reason=reason)
            for some in in_lots(ids, AT_ONCE):  # transactions that keep nobody waiting for long
                with self._database.writing() as session:
                    erase(session, some)
        if erased:
            empty_log(self._database)
        return erased

    def _since(self, older_than_days: int) -> datetime:
        if not 1 <= older_than_days <= MOST_DAYS_OLD:
            raise CourseError(
                f"an age has 1 to {MOST_DAYS_OLD} days, not {older_than_days}",
                f"天数从 1 到 {MOST_DAYS_OLD}，不能是 {older_than_days}",
                "older_than_days",
            )
        return self._clock() - timedelta(days=older_than_days)


def _require_student(session: Session, course: str, person: str) -> None:
    member = session.get(MemberRow, (course, person))
    if member is None and not is_known(session, course, person):
        raise unknown_members(course, person)
    if member is not None and member.role != Role.STUDENT.value:
        raise CourseError(
            f"{person} is no student: only students are forgotten",
            f"{person} 不是学生：只能删除学生的数据",
        )


def _require_free(session: Session, course: str, person: str, new: str) -> None:
    people = session.execute(select(col(MemberRow.person)).where(col(MemberRow.course) == course)).scalars()
    like = [one for one in people if one != person and folded_id(one) == folded_id(new)]
    if new == person or like or is_known(session, course, new):
        other = like[0] if like else new
        raise CourseError(f"{other} is or was somebody in the course", f"课程里已经有或者有过 {other}", "id")


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
        raise RefusedError.saying(
            "regrade_open",
            zh=f"作业 {assignment} 有未决定的重新评分：请先采用或放弃。",
            en=f"{assignment} has an open re-grade: apply or discard it first.",
        )
