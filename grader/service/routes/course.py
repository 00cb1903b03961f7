"""The caller's course from one term to the next: copied, archived, emptied of what is old."""

from typing import Annotated

from fastapi import APIRouter, Depends, Response, status
from fastapi.responses import StreamingResponse
from pydantic import Field, StrictBool

from grader.service.requests.answers import PRIVATE, to_save
from grader.service.requests.dependencies import InstructorDep, StaffDep
from grader.service.routes.people import CourseView, PersonId
from grader.service.routes.problems import responses
from grader.service.routes.views import View
from grader.store.course_life import MOST_DAYS_MOVED, MOST_DAYS_OLD, NewCourse
from grader.use_cases import course_export, course_life
from grader.use_cases.bodies import Body, Whole


async def _keep_private(response: Response) -> None:
    response.headers.update(PRIVATE)


router = APIRouter(prefix="/api/v1", tags=["course"], dependencies=[Depends(_keep_private)])
_ON_READ = ("forbidden", "no_course", "invalid_request")
_ON_CHANGE = (*_ON_READ, "malformed_body", "too_large")


class NewCourseBody(Body):
    """A course that begins with the rules of the caller's."""

    id: str = Field(max_length=64, examples=["ros2-2027"])
    title: str = Field(default="", max_length=200, description="Empty: the id.", examples=["ROS 2 入门"])
    move_days: Annotated[Whole, Field(ge=0, le=MOST_DAYS_MOVED)] = Field(
        default=0, description="How many days later every date is."
    )


class NewCourseView(View):
    """A new course, and the token that opens it to the instructor. It is shown this once."""

    course: CourseView
    person: str = Field(examples=["wang"])
    token: str = Field(examples=["7KQ2M-9TXHC"])


class ArchiveBody(Body):
    """Whether the course can only be read."""

    archived: StrictBool
    reason: str = Field(default="", max_length=1_000, description="Goes into the audit log.")


class SpaceView(View):
    """How many submissions, trials included, and how many bytes of them."""

    submissions: int = Field(examples=[6300])
    sources_bytes: int = Field(examples=[7_600_000])
    reports_bytes: int = Field(examples=[21_000_000])
    trajectories_bytes: int = Field(examples=[80_000_000])


class OldWorkBody(Body):
    """Which submissions shall be erased."""

    older_than_days: Annotated[Whole, Field(ge=1, le=MOST_DAYS_OLD)] = Field(examples=[400])
    dry_run: StrictBool = Field(default=False, description="Only tell what would be erased.")
    reason: str = Field(default="", max_length=1_000, description="Goes into the audit log.")


class OldWorkView(SpaceView):
    """What is erased, or would be."""

    dry_run: bool = Field(description="Nothing was erased.")


class ForgetBody(Body):
    """Why somebody is forgotten."""

    reason: str = Field(default="", max_length=1_000, description="Goes into the audit log.")


class ForgottenView(View):
    """What stands where a student's id stood, and how many submissions were erased."""

    pseudonym: str = Field(examples=["forgotten-9f2c01aa"])
    submissions: int = Field(examples=[17])


@router.get("/course", summary="The caller's course", responses=responses(*_ON_READ))
def read_course(errand: StaffDep) -> CourseView:
    """Return what the course is, and whether it is archived."""
    return CourseView.of(course_life.own_course(errand.services, errand.caller))


@router.post(
    "/courses",
    summary="Copy the course",
    status_code=status.HTTP_201_CREATED,
    responses=responses(*_ON_CHANGE, "invalid_course"),
)
def copy_course(errand: InstructorDep, body: NewCourseBody) -> NewCourseView:
    """Make a course with the same rules and published assignments, without its people and work."""
    new = NewCourse(id=body.id, title=body.title, move_days=body.move_days)
    copied = course_life.copy_course(errand.services, errand.caller, new)
    return NewCourseView(course=CourseView.of(copied.course), person=copied.instructor, token=copied.token)


@router.put(
    "/course/archived",
    summary="Archive or reopen the course",
    responses=responses(*_ON_CHANGE, "regrade_open"),
)
def archive_course(errand: InstructorDep, body: ArchiveBody) -> CourseView:
    """Let the course only be read (409 `course_archived` for changes and uploads), or be changed again."""
    return CourseView.of(
        course_life.archive_course(errand.services, errand.caller, body.reason, archived=body.archived)
    )


@router.get("/course/space", summary="What the course takes", responses=responses(*_ON_READ))
def read_space(errand: StaffDep) -> SpaceView:
    """Return what is stored of the course's submissions; rows and indexes come on top."""
    return SpaceView.of(course_life.space(errand.services, errand.caller))


@router.post("/course/retention", summary="Erase what is old", responses=responses(*_ON_CHANGE))
def erase_old_work(errand: InstructorDep, body: OldWorkBody) -> OldWorkView:
    """Erase submissions of an age, with reports, grades and comments; or tell what that would be."""
    if body.dry_run:
        space = course_life.old_work(errand.services, errand.caller, body.older_than_days)
    else:
        space = course_life.erase_old_work(errand.services, errand.caller, body.older_than_days, body.reason)
    return OldWorkView.of(space, dry_run=body.dry_run)


@router.post(
    "/members/{person}/forget",
    summary="Forget a student",
    responses=responses(*_ON_CHANGE, "member_not_found", "only_students"),
)
def forget_student(errand: InstructorDep, person: PersonId, body: ForgetBody) -> ForgottenView:
    """Erase what a student handed in and every trace of who they are; this cannot be undone."""
    forgotten = course_life.forget_student(errand.services, errand.caller, person, body.reason)
    return ForgottenView.of(forgotten)


@router.get(
    "/course/export.zip",
    summary="Everything of the course",
    response_class=StreamingResponse,
    responses={
        200: {
            "description": "A zip: members, grades, rules, the audit log; of each submission the file, report, "
            "points by people and comments; a manifest with the SHA-256 of every file.",
            "content": {"application/zip": {"schema": {"type": "string", "format": "binary"}}},
        },
        **responses(*_ON_READ),
    },
)
def export_course(errand: InstructorDep) -> StreamingResponse:
    """Return all that is stored of the course, made while it is sent."""
    headers = to_save(f"{errand.caller.course}.zip", **PRIVATE)
    return StreamingResponse(
        course_export.export(errand.services, errand.caller), 200, headers, "application/zip"
    )
