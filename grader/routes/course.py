"""The caller's course from one term to the next: copied, archived."""

from typing import Annotated

from fastapi import APIRouter, Response, status
from pydantic import BaseModel, ConfigDict, Field

from grader.routes.dependencies import ENTRY_PROBLEMS, InstructorDep, ServicesDep, StaffDep
from grader.routes.people import CourseView
from grader.routes.problems import responses
from grader.store.course_life import MOST_DAYS_MOVED, NewCourse
from grader.use_cases import course_life
from grader.use_cases.bodies import Whole

router = APIRouter(prefix="/api/v1", tags=["course"])
_PRIVATE = {"Cache-Control": "no-store", "Vary": "Authorization"}
_READING = (*ENTRY_PROBLEMS, "forbidden", "no_course", "invalid_request")
_CHANGING = (*_READING, "malformed_body", "too_large")


class NewCourseBody(BaseModel):
    """A course that begins with the rules of the caller's."""

    model_config = ConfigDict(extra="forbid")

    id: str = Field(max_length=64, examples=["ros2-2027"])
    title: str = Field(default="", max_length=200, description="Empty: the id.", examples=["ROS 2 入门"])
    move_days: Annotated[Whole, Field(ge=0, le=MOST_DAYS_MOVED)] = Field(
        default=0, description="How many days later every date is."
    )


class NewCourseView(BaseModel):
    """A new course, and the token that opens it to the instructor. It is shown this once."""

    course: CourseView
    person: str = Field(examples=["wang"])
    token: str = Field(examples=["grader_..."])


class ArchiveBody(BaseModel):
    """Whether the course can only be read."""

    model_config = ConfigDict(extra="forbid")

    archived: bool
    reason: str = Field(default="", max_length=1_000, description="Goes into the audit log.")


@router.get("/course", summary="The caller's course", responses=responses(*_READING))
def read_course(services: ServicesDep, caller: StaffDep, response: Response) -> CourseView:
    """Return what the course is, and whether it is archived."""
    response.headers.update(_PRIVATE)
    return CourseView.model_validate(course_life.own_course(services, caller), from_attributes=True)


@router.post(
    "/courses",
    summary="Copy the course",
    status_code=status.HTTP_201_CREATED,
    responses=responses(*_CHANGING, "invalid_course"),
)
def copy_course(
    services: ServicesDep, caller: InstructorDep, body: NewCourseBody, response: Response
) -> NewCourseView:
    """Make a course with the same rules and published assignments, without its people and work."""
    response.headers.update(_PRIVATE)
    new = NewCourse(id=body.id, title=body.title or body.id, move_days=body.move_days)
    made = course_life.copy_course(services, caller, new)
    return NewCourseView(
        course=CourseView.model_validate(made.course, from_attributes=True),
        person=made.instructor,
        token=made.token,
    )


@router.put(
    "/course/archived",
    summary="Archive or reopen the course",
    responses=responses(*_CHANGING, "regrade_open"),
)
def archive_course(
    services: ServicesDep, caller: InstructorDep, body: ArchiveBody, response: Response
) -> CourseView:
    """Let the course only be read (409 `course_archived` for changes and uploads), or be changed again."""
    response.headers.update(_PRIVATE)
    return CourseView.model_validate(
        course_life.archive_course(services, caller, body.reason, archived=body.archived),
        from_attributes=True,
    )
