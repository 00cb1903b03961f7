"""Who the caller is, who is in the course, and what was changed by whom."""

from datetime import datetime
from typing import Annotated, Any

from fastapi import APIRouter, Query, Response
from pydantic import BaseModel, Field

from grader.contracts.identity import Role
from grader.routes.dependencies import (
    ENTRY_PROBLEMS,
    CallerDep,
    InstructorDep,
    QueryWhole,
    ServicesDep,
    StaffDep,
)
from grader.routes.problems import responses
from grader.use_cases.people import changes, members, myself

router = APIRouter(prefix="/api/v1", tags=["people"])
_PAGE = 100
_LARGEST_ID = 2**63 - 1  # of a row in the database


class CourseView(BaseModel):
    """The caller's course."""

    id: str = Field(examples=["ros2-2026"])
    title: str = Field(examples=["ROS 2 入门"])
    time_zone: str = Field(examples=["Asia/Shanghai"])


class MeView(BaseModel):
    """Who the token belongs to. Without courses nobody's identity is known."""

    course: CourseView | None
    person: str | None = Field(examples=["20260123"])
    name: str | None = Field(examples=["李雷"])
    role: Role | None = Field(examples=["student"])


class MemberView(BaseModel):
    """Somebody in the course."""

    id: str = Field(examples=["20260123"])
    name: str = Field(examples=["李雷"])
    role: Role = Field(examples=["student"])


class MemberList(BaseModel):
    """The people of a course in order of their ids."""

    members: list[MemberView]


class AuditView(BaseModel):
    """One change of a grade or a setting."""

    id: int
    at: datetime
    actor: str = Field(description="Who did it.", examples=["wang"])
    action: str = Field(examples=["rules.change"])
    subject: str = Field(description="What was changed.", examples=["assignment square"])
    before: Any = Field(description="Null where there was nothing.")
    after: Any = Field(description="Null where there is nothing any more.")
    reason: str = Field(examples=["tolerance was too tight"])


class AuditPage(BaseModel):
    """Changes, newest first."""

    entries: list[AuditView]
    next_before: int | None = Field(description="The parameter `before` of the next page; null: no more.")


@router.get("/me", summary="Who the token belongs to", responses=responses(*ENTRY_PROBLEMS))
def read_me(services: ServicesDep, caller: CallerDep, response: Response) -> MeView:
    """Return the caller's course, name and role."""
    response.headers.update({"Cache-Control": "no-store", "Vary": "Authorization"})
    course, member = myself(services, caller)
    if course is None:
        return MeView(course=None, person=None, name=None, role=caller.role)
    return MeView(
        course=CourseView.model_validate(course, from_attributes=True),
        person=caller.person,
        name=None if member is None else member.name,
        role=caller.role,
    )


@router.get(
    "/members",
    summary="The people of the course",
    responses=responses(*ENTRY_PROBLEMS, "forbidden", "invalid_request"),
)
def read_members(
    services: ServicesDep,
    caller: StaffDep,
    response: Response,
    role: Annotated[Role | None, Query(description="Only those of this role.")] = None,
) -> MemberList:
    """Return who is in the caller's course; nobody while there are no courses."""
    response.headers.update({"Cache-Control": "no-store", "Vary": "Authorization"})
    found = members(services, caller, role)
    return MemberList(members=[MemberView.model_validate(one, from_attributes=True) for one in found])


@router.get(
    "/audit",
    summary="What was changed, by whom",
    responses=responses(*ENTRY_PROBLEMS, "forbidden", "invalid_request"),
)
def read_audit(
    services: ServicesDep,
    caller: InstructorDep,
    response: Response,
    before: Annotated[
        QueryWhole | None, Query(ge=0, le=_LARGEST_ID, description="Only changes older than this id.")
    ] = None,
    limit: Annotated[QueryWhole, Query(ge=1, le=1_000)] = _PAGE,
) -> AuditPage:
    """Return changes of grades and settings in the caller's course."""
    response.headers.update({"Cache-Control": "no-store", "Vary": "Authorization"})
    entries, more = changes(services, caller, before, limit)
    shown = [AuditView.model_validate(one, from_attributes=True) for one in entries]
    return AuditPage(entries=shown, next_before=more)
