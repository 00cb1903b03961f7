"""Who the caller is, who is in the course, and what was changed by whom."""

from datetime import datetime
from typing import Annotated, Any

from fastapi import APIRouter, Depends, File, Path, Query, Response, UploadFile, status
from pydantic import Field

from grader.contracts.assignment import Distro, RunsAs
from grader.contracts.identity import MOST_SESSION_HOURS, Role, RosterEntry
from grader.service.requests.answers import PRIVATE
from grader.service.requests.dependencies import ErrandDep, InstructorDep, LanguageDep, QueryWhole, StaffDep
from grader.service.requests.middleware import MOST_BYTES, known_parts
from grader.service.routes.problems import responses
from grader.service.routes.views import View
from grader.use_cases import people, signing_in
from grader.use_cases.bodies import Body, Whole
from grader.use_cases.people import changes, members, myself

router = APIRouter(prefix="/api/v1", tags=["people"])
_PAGE = 100
_LARGEST_ID = 2**63 - 1  # of a row in the database
_ON_CHANGE = ("forbidden", "no_course", "course_archived", "invalid_request")
PersonId = Annotated[str, Path(max_length=64, description="Id of a member.", examples=["20260123"])]


class CourseView(View):
    """The caller's course."""

    id: str = Field(examples=["ros2-2026"])
    title: str = Field(examples=["ROS 2 入门"])
    time_zone: str = Field(examples=["Asia/Shanghai"])
    distro: Distro = Field(
        description="Release of ROS 2 that scripts find where an assignment names none.", examples=["humble"]
    )
    runs_as: RunsAs = Field(description="How scripts are started where an assignment does not say.")
    session_hours: int = Field(description="How long members stay signed in on a page, at most.")
    archived_at: datetime | None = Field(description="Since when it can only be read; null: it is taught.")


class CourseBody(Body):
    """What a course shall be like, and why."""

    distro: Distro | None = Field(
        default=None,
        description="Release of ROS 2 of its scripts; an assignment that names one keeps its own. null: stays.",
    )
    runs_as: RunsAs | None = Field(
        default=None,
        description="How its scripts are started, likewise: by python3, or as ros2 run calls main().",
    )
    title: str | None = Field(default=None, max_length=200, examples=["ROS 2 入门"])
    time_zone: str | None = Field(
        default=None, max_length=64, description="Dates stay the instants that they are.", examples=["UTC"]
    )
    session_hours: int | None = Field(
        default=None, ge=1, le=MOST_SESSION_HOURS, description="For sessions that begin from now on."
    )
    reason: str = Field(default="", max_length=1_000, description="Goes into the audit log.")


class MeView(View):
    """Who the token belongs to. Without courses nobody's identity is known."""

    course: CourseView | None
    person: str | None = Field(examples=["20260123"])
    name: str | None = Field(examples=["李雷"])
    role: Role | None = Field(examples=["student"])


class MemberView(View):
    """Somebody in the course."""

    id: str = Field(examples=["20260123"])
    name: str = Field(examples=["李雷"])
    role: Role = Field(examples=["student"])
    email: str = Field(description="May be empty.", examples=["lilei@example.edu"])
    sections: list[str] = Field(
        description="That a student is in, or an assistant looks after.", examples=[["A"]]
    )


class MemberBody(Body):
    """What somebody shall be in the course. What is left out stays as it is."""

    name: str = Field(default="", max_length=200, description="Empty: stays.", examples=["李雷"])
    role: Role | None = Field(default=None, description="A new member is a student unless this says more.")
    email: str | None = Field(default=None, max_length=254, examples=["lilei@example.edu"])
    sections: list[str] | None = Field(default=None, max_length=100, examples=[["A"]])


class ChangeView(View):
    """A member before and after an import."""

    before: MemberView
    after: MemberView


class SkippedView(View):
    """A row of a class list that cannot be imported."""

    sheet: str = Field(description="Of a workbook with a sheet for each section; else empty.", examples=[""])
    row: int = Field(description="As the file's own program counts it, from 1.", examples=[12])
    reason: str = Field(examples=["20260123 stands in line 4 already"])


class ImportView(View):
    """What importing a class list does, or has done."""

    added: list[MemberView]
    changed: list[ChangeView]
    unchanged: int = Field(examples=[118])
    gone: list[MemberView] = Field(
        description="Students of the course, or of the sections that the list is about, who are not in it."
    )
    returning: list[str] = Field(
        description="Ids of those added who were removed before: their tokens ended then."
    )
    skipped: list[SkippedView]
    dry_run: bool = Field(description="Nothing was changed.")


class TokenBody(Body):
    """How long a new token works."""

    days: Annotated[Whole, Field(ge=1, le=3_660)] = 200


class TokenView(View):
    """A new token. It is shown this once."""

    person: str = Field(examples=["20260123"])
    token: str = Field(examples=["7KQ2M-9TXHC"])


class IdentityView(View):
    """By which name a member signs in at a provider."""

    id: str = Field(examples=["3f2a9c0b1d4e"])
    provider: str = Field(examples=["campus"])
    subject: str = Field(description="The provider's own name for the person.", examples=["20260123"])
    bound_at: datetime
    by_token: bool = Field(
        description="By a token that was shown once; else by an id that the provider said."
    )


class IdentityList(View):
    """By which names a member signs in, oldest first."""

    identities: list[IdentityView]


class MemberList(View):
    """The people of a course in order of their ids."""

    members: list[MemberView]


class AuditView(View):
    """One change of a grade or a setting."""

    id: int
    at: datetime
    actor: str = Field(description="Who did it.", examples=["wang"])
    action: str = Field(examples=["rules.change"])
    subject: str = Field(description="What was changed.", examples=["assignment square"])
    before: Any = Field(description="Null where there was nothing.")
    after: Any = Field(description="Null where there is nothing any more.")
    reason: str = Field(examples=["tolerance was too tight"])


class AuditPage(View):
    """Changes, newest first."""

    entries: list[AuditView]
    next_before: int | None = Field(description="The parameter `before` of the next page; null: no more.")


@router.get("/me", summary="Who the token belongs to", responses=responses())
def read_me(errand: ErrandDep, response: Response) -> MeView:
    """Return the caller's course, name and role."""
    response.headers.update(PRIVATE)
    course, member = myself(errand.services, errand.caller)
    if course is None:
        return MeView(course=None, person=None, name=None, role=errand.caller.role)
    return MeView(
        course=CourseView.of(course),
        person=errand.caller.person,
        name=None if member is None else member.name,
        role=errand.caller.role,
    )


@router.put(
    "/course",
    summary="Change the course",
    responses=responses(*_ON_CHANGE, "invalid_course", "malformed_body", "too_large"),
)
def put_course(errand: InstructorDep, body: CourseBody, response: Response) -> CourseView:
    """Change title, time zone, and, for what is graded from now on, the release of ROS 2 and how scripts start."""
    response.headers.update(PRIVATE)
    course = people.change_course(
        errand.services,
        errand.caller,
        body.reason,
        distro=body.distro,
        runs_as=body.runs_as,
        session_hours=body.session_hours,
        title=body.title,
        time_zone=body.time_zone,
    )
    return CourseView.of(course)


@router.get(
    "/members",
    summary="The people of the course",
    responses=responses("forbidden", "invalid_request"),
)
def read_members(
    errand: StaffDep,
    response: Response,
    role: Annotated[Role | None, Query(description="Only those of this role.")] = None,
) -> MemberList:
    """Return who is in the caller's course; nobody while there are no courses."""
    response.headers.update(PRIVATE)
    listed = members(errand.services, errand.caller, role)
    return MemberList(members=[MemberView.of(member) for member in listed])


@router.post(
    "/members/import",
    dependencies=[Depends(known_parts)],
    summary="Import a class list",
    responses=responses(*_ON_CHANGE, "invalid_roster", "malformed_body", "too_large"),
)
def import_members(  # noqa: PLR0913, PLR0917
    errand: InstructorDep,
    language: LanguageDep,
    response: Response,
    file: Annotated[UploadFile, File(description=".xlsx, .xls, .ods or CSV; at most 1 MiB.")],
    dry_run: Annotated[bool, Query(description="Only tell what would change.")] = False,
    skip: Annotated[bool, Query(description="Import the other rows if some are wrong.")] = False,
    remove: Annotated[bool, Query(description="Remove students who are not in the list.")] = False,
) -> ImportView:
    """Add and change members as a class list says, all or none; what it leaves out stays as it is."""
    response.headers.update(PRIVATE)
    content = file.file.read(MOST_BYTES + 1)
    if dry_run:
        plan = people.plan_import(errand.services, errand.caller, content)
    else:
        plan = people.import_list(errand.services, errand.caller, content, skip=skip, remove=remove)
    skipped = [
        SkippedView(sheet=row.place.sheet, row=row.place.number, reason=row.reason.get(language))
        for row in plan.roster.skipped
    ]
    return ImportView.of(plan.change, skipped=skipped, dry_run=dry_run)


@router.put(
    "/members/{person}",
    summary="Add or change a member",
    responses=responses(*_ON_CHANGE, "invalid_roster", "malformed_body", "too_large"),
)
def put_member(errand: InstructorDep, person: PersonId, body: MemberBody, response: Response) -> MemberView:
    """Put somebody into the course, or change what the body names."""
    response.headers.update(PRIVATE)
    sections = None if body.sections is None else tuple(body.sections)
    entry = RosterEntry(id=person, name=body.name, role=body.role, email=body.email, sections=sections)
    return MemberView.of(people.set_member(errand.services, errand.caller, entry))


@router.delete(
    "/members/{person}",
    summary="Remove a member",
    status_code=status.HTTP_204_NO_CONTENT,
    responses=responses(*_ON_CHANGE, "member_not_found", "invalid_roster"),
)
def delete_member(
    errand: InstructorDep,
    person: PersonId,
    reason: Annotated[str, Query(max_length=1_000, description="Goes into the audit log.")] = "",
) -> None:
    """Take somebody out of the course, with their tokens; what they handed in stays stored."""
    people.remove_member(errand.services, errand.caller, person, reason)


@router.post(
    "/members/{person}/tokens",
    summary="Make a token for a member",
    status_code=status.HTTP_201_CREATED,
    responses=responses(*_ON_CHANGE, "member_not_found", "malformed_body", "too_large"),
)
def make_token(
    errand: InstructorDep, person: PersonId, response: Response, body: TokenBody | None = None
) -> TokenView:
    """Return a new token, which is shown this once; older ones work on."""
    days = (body or TokenBody()).days
    response.headers.update(PRIVATE)
    return TokenView(person=person, token=people.give_token(errand.services, errand.caller, person, days))


@router.get(
    "/members/{person}/identities",
    summary="By which names a member signs in",
    responses=responses("forbidden", "member_not_found", "invalid_request"),
)
def read_identities(errand: InstructorDep, person: PersonId, response: Response) -> IdentityList:
    """Return what sign-in providers call a member."""
    response.headers.update(PRIVATE)
    member = people.member_of(errand.services, errand.caller, person)
    identities = signing_in.ways_of(errand.services, errand.caller, member.id)
    return IdentityList(identities=[IdentityView.of(identity) for identity in identities])


@router.delete(
    "/members/{person}/identities/{identity}",
    summary="Let a member no longer sign in by a name",
    status_code=status.HTTP_204_NO_CONTENT,
    responses=responses(*_ON_CHANGE, "member_not_found", "identity_not_found"),
)
def delete_identity(
    errand: InstructorDep, person: PersonId, identity: Annotated[str, Path(max_length=16)]
) -> None:
    """End a binding and the sessions that it opened; the next time a token is asked for, or the roster decides."""
    signing_in.unbind(
        errand.services, errand.caller, people.member_of(errand.services, errand.caller, person).id, identity
    )


@router.get(
    "/audit",
    summary="What was changed, by whom",
    responses=responses("forbidden", "invalid_request"),
)
def read_audit(
    errand: InstructorDep,
    response: Response,
    before: Annotated[
        QueryWhole | None, Query(ge=0, le=_LARGEST_ID, description="Only changes older than this id.")
    ] = None,
    limit: Annotated[QueryWhole, Query(ge=1, le=1_000)] = _PAGE,
) -> AuditPage:
    """Return changes of grades and settings in the caller's course."""
    response.headers.update(PRIVATE)
    entries, more = changes(errand.services, errand.caller, before, limit)
    shown = [AuditView.of(entry) for entry in entries]
    return AuditPage(entries=shown, next_before=more)
