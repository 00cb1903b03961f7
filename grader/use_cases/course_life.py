"""What becomes of a course from one term to the next: it is copied, archived, and reopened.

Only the operator makes the first course, on the server. An instructor makes further ones as copies of the own, and
teaches them: whom else a course belongs to, its instructors decide.
"""

from dataclasses import dataclass, replace
from datetime import timedelta

from grader.contracts.errors import CourseError, RefusedError
from grader.contracts.identity import Caller, Course, Role
from grader.contracts.text import Text
from grader.store.course_life import NewCourse
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
    """Return the caller's course.

    Raises:
        RefusedError: the caller may not see the class, or there is no course.
    """
    require_staff(caller)
    if caller.course is None:
        raise RefusedError("no_course")
    return services.courses.get(caller.course)


def copy_course(services: Services, caller: Caller, new: NewCourse) -> CopiedCourse:
    """Make a course with the rules of the caller's, which the caller teaches.

    Raises:
        RefusedError: the caller is no instructor, there is no course, or `new` does not fit.
    """
    require_instructor(caller)
    course = own_course(services, caller)
    known = member_of(services, caller, caller.person or "")
    teacher = replace(known, course=new.id, role=Role.INSTRUCTOR, sections=())
    try:
        made = services.course_life.copy(course.id, new, teacher, caller.signature)
    except CourseError as error:
        raise RefusedError("invalid_course", Text(zh=error.told("zh"), en=error.told("en"))) from None
    _, token = services.tokens.issue(made.id, teacher.id, timedelta(days=_DAYS), caller.signature)
    return CopiedCourse(course=made, instructor=teacher.id, token=token)


def archive_course(services: Services, caller: Caller, reason: str, *, archived: bool) -> Course:
    """Let the caller's course be read only, or be changed again.

    Raises:
        RefusedError: the caller is no instructor, there is no course, or it has an open re-grade.
    """
    require_instructor(caller)
    own_course(services, caller)
    change = services.course_life.archive if archived else services.course_life.reopen
    return change(services.signature(caller), reason)
