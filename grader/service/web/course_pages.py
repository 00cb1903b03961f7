"""The course itself: what it is, a copy for the next term, the archive, what is erased."""

from typing import Annotated, Literal

from fastapi import APIRouter, Depends, Form, Query, Response
from fastapi.responses import RedirectResponse, StreamingResponse
from pydantic import BaseModel, Field

from grader.contracts.errors import RefusedError
from grader.service.requests.answers import to_save
from grader.service.web.access import (
    InstructorDep,
    PageErrand,
    QueryWhole,
    StaffDep,
    require_staff,
)
from grader.service.web.errors import form_problem
from grader.service.web.forms import OWN_FORM
from grader.service.web.pages import page
from grader.store.course_life import MOST_DAYS_MOVED, MOST_DAYS_OLD, NewCourse
from grader.use_cases import course_life, people
from grader.use_cases.course_export import export
from grader.use_cases.course_life import CopiedCourse
from grader.use_cases.people import members

router = APIRouter(prefix="/class/course", include_in_schema=False, dependencies=[Depends(require_staff)])
Done = Annotated[Literal["", "archived", "changed", "reopened", "erased", "forgotten"], Query()]
_A_YEAR = 364  # the same days of the week


class CopyForm(BaseModel):
    """A course that begins as a copy."""

    id: str = Field(default="", max_length=200)
    title: str = Field(default="", max_length=200)
    move_days: Annotated[QueryWhole, Field(ge=0, le=MOST_DAYS_MOVED)] = _A_YEAR


@router.get("")
def read_course(
    errand: StaffDep,
    older_than: Annotated[QueryWhole | None, Query(ge=1, le=MOST_DAYS_OLD)] = None,
    done: Done = "",
) -> Response:
    """Show what the course is, what can be done with it, and what of it is older than some days."""
    return _course_page(errand, older_than=older_than, done=done)


@router.get("/export.zip")
def export_course(errand: InstructorDep) -> Response:
    """Send everything of the course."""
    headers = to_save(f"{errand.caller.course}.zip")
    return StreamingResponse(export(errand.services, errand.caller), 200, headers, "application/zip")


@router.post("/copy", dependencies=OWN_FORM)
def copy_course(errand: InstructorDep, form: Annotated[CopyForm, Form()]) -> Response:
    """Make a course with the rules of this one and show its token, this once."""
    new = NewCourse(id=form.id.strip(), title=form.title, move_days=form.move_days)
    try:
        copied = course_life.copy_course(errand.services, errand.caller, new)
    except RefusedError as error:
        return _course_page(errand, form=form, error=error, of="copy")
    return _course_page(errand, copied=copied)


@router.post("/settings", dependencies=OWN_FORM)
def change_settings(
    errand: InstructorDep,
    title: Annotated[str, Form(max_length=200)],
    time_zone: Annotated[str, Form(max_length=64)],
) -> Response:
    """Change the title and the time zone of the course."""
    try:
        people.change_course(errand.services, errand.caller, "", title=title, time_zone=time_zone)
    except RefusedError as error:
        return _course_page(errand, error=error, of="settings")
    return RedirectResponse("/class/course?done=changed", status_code=303)


@router.post("/archive", dependencies=OWN_FORM)
def archive_course(
    errand: InstructorDep,
    archived: Annotated[bool, Form()],
    reason: Annotated[str, Form(max_length=1_000)] = "",
) -> Response:
    """Archive the course, or reopen it."""
    try:
        course_life.archive_course(errand.services, errand.caller, reason.strip(), archived=archived)
    except RefusedError as error:
        return _course_page(errand, error=error, of="archive")
    return RedirectResponse(f"/class/course?done={'archived' if archived else 'reopened'}", status_code=303)


@router.post("/erase", dependencies=OWN_FORM)
def erase_old_work(
    errand: InstructorDep,
    older_than: Annotated[QueryWhole, Form(ge=1, le=MOST_DAYS_OLD)],
    reason: Annotated[str, Form(max_length=1_000)] = "",
) -> Response:
    """Erase the submissions that are older than the given number of days."""
    course_life.erase_old_work(errand.services, errand.caller, older_than, reason.strip())
    return RedirectResponse("/class/course?done=erased", status_code=303)


@router.post("/forget", dependencies=OWN_FORM)
def forget_student(
    errand: InstructorDep,
    person: Annotated[str, Form(max_length=64)],
    again: Annotated[str, Form(max_length=64)],
    reason: Annotated[str, Form(max_length=1_000)] = "",
) -> Response:
    """Forget a student whose id was typed twice."""
    try:
        if person.strip() != again.strip():
            raise RefusedError("not_the_same")
        course_life.forget_student(errand.services, errand.caller, person.strip(), reason.strip())
    except RefusedError as error:
        return _course_page(errand, error=error, of="forget")
    return RedirectResponse("/class/course?done=forgotten", status_code=303)


def _course_page(  # noqa: PLR0913
    errand: PageErrand,
    *,
    form: CopyForm | None = None,
    error: RefusedError | None = None,
    of: str = "",
    copied: CopiedCourse | None = None,
    older_than: int | None = None,
    done: str = "",
) -> Response:
    problem = None if error is None else form_problem(error, errand.language, field=of)
    services, caller, has_course = errand.services, errand.caller, errand.caller.course is not None
    shows_old = older_than is not None and has_course and caller.is_instructor
    return page(
        errand.request,
        "course.html",
        status=200 if problem is None else problem.status,
        course=course_life.own_course(services, caller) if has_course else None,
        members=len(members(services, caller)),
        form=form or CopyForm(),
        most_days=MOST_DAYS_MOVED,
        problem=problem,
        problem_of=of,
        older_than=older_than,
        most_days_old=MOST_DAYS_OLD,
        old=course_life.old_work(services, caller, older_than) if shows_old and older_than else None,
        copied=copied,
        done=done,
    )
