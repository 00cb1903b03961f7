"""A course from one term to the next: copying, archiving and reopening it, and erasing what is old.

Only the operator makes the first course, on the server. An instructor makes further ones as copies of the own, and
teaches them: whom else a course belongs to, its instructors decide.
"""

from dataclasses import dataclass, replace
from datetime import datetime, timedelta

from grader.contracts.errors import CourseError, RefusedError
from grader.contracts.identity import Caller, Course, Role
from grader.store.course_life import NewCourse
from grader.store.erasing import Space
from grader.store.forgetting import Forgotten
from grader.use_cases.callers import require_instructor, require_staff
from grader.use_cases.people import member_of
from grader.use_cases.services import Services

_DAYS = 200


@dataclass(frozen=True, slots=True, kw_only=True)
class CopiedCourse:
    """A new course, who teaches it, and the token that opens it, which is shown this once."""

    course: Course
    instructor: str
    token: str


def own_course(services: Services, caller: Caller) -> Course:
    """Return the caller's course. For staff of a course."""
    require_staff(caller)
    if caller.course is None:
        raise RefusedError("no_course")
    return services.courses.get(caller.course)


def copy_course(services: Services, caller: Caller, new: NewCourse) -> CopiedCourse:
    """Make a course with the rules of the caller's, which the caller teaches.

    Raises RefusedError: the caller is no instructor, there is no course, or `new` does not fit.
    """
    require_instructor(caller)
    course = own_course(services, caller)
    member = member_of(services, caller, caller.person or "")
    teacher = replace(member, course=new.id, role=Role.INSTRUCTOR, sections=())
    try:
        copy = services.course_life.copy(course.id, new, teacher, caller.signature)
    except CourseError as error:
        raise RefusedError("invalid_course", error.text, field=error.field) from None
    _, token = services.tokens.issue(copy.id, teacher.id, timedelta(days=_DAYS), caller.signature)
    return CopiedCourse(course=copy, instructor=teacher.id, token=token)


def archive_course(services: Services, caller: Caller, reason: str, *, archived: bool) -> Course:
    """Archive the caller's course, which makes it read-only, or reopen it.

    Raises RefusedError: the caller is no instructor, there is no course, or it has an open re-grade.
    """
    require_instructor(caller)
    own_course(services, caller)
    change = services.course_life.archive if archived else services.course_life.reopen
    return change(services.signature(caller), reason)


def forget_student(services: Services, caller: Caller, person: str, reason: str) -> Forgotten:
    """Erase what a student handed in and every trace of who they are; also of one who was removed before.

    Raises:
        RefusedError: the caller is no instructor, there is no course, nobody of that id was in it, or not as a
            student.
    """
    require_instructor(caller)
    course = own_course(services, caller)
    member = services.courses.member(course.id, person)
    if member is not None and member.role is not Role.STUDENT:
        raise RefusedError("only_students")
    try:
        return services.course_life.forget(person, services.signature(caller), reason)
    except CourseError:
        raise RefusedError("member_not_found") from None


def old_work(services: Services, caller: Caller, older_than_days: int) -> Space:
    """Return what `erase_old_work` would erase. For instructors of a course."""
    require_instructor(caller)
    course = own_course(services, caller)
    return services.course_life.old_work(course.id, older_than_days).get(course.id, Space())


def erase_old_work(services: Services, caller: Caller, older_than_days: int, reason: str) -> Space:
    """Erase the submissions of the caller's course that arrived so long ago, with their grades; return them.

    For instructors of a course.
    """
    require_instructor(caller)
    course = own_course(services, caller)
    erased = services.course_life.erase_old_work(course.id, older_than_days, caller.signature, reason)
    return erased.get(course.id, Space())


def space(services: Services, caller: Caller) -> Space:
    """Return what is stored of the caller's course. For staff of a course."""
    course = own_course(services, caller)
    return services.course_life.space(course.id).get(course.id, Space())


def counted_space(services: Services, caller: Caller) -> tuple[datetime, Space, Space] | None:
    """Return when it was counted lately, what was stored of the caller's course, and of all others together.

    None: it is being counted for the first time. For staff of a course.
    """
    course = own_course(services, caller)
    counted = services.space.latest()
    if counted is None:
        return None
    spaces = counted.courses
    others = [one for of, one in spaces.items() if of != course.id]
    return (
        counted.at,
        spaces.get(course.id, Space()),
        Space(
            submissions=sum(other.submissions for other in others),
            sources_bytes=sum(other.sources_bytes for other in others),
            reports_bytes=sum(other.reports_bytes for other in others),
            trajectories_bytes=sum(other.trajectories_bytes for other in others),
        ),
    )
