"""Learning platforms that send a course's students here."""

from datetime import datetime
from typing import Annotated

from fastapi import APIRouter, Path, Query, Response, status
from pydantic import Field

from grader.contracts.identity import Seen
from grader.contracts.platform import NewPlatform
from grader.service.requests.answers import PRIVATE
from grader.service.requests.dependencies import InstructorDep
from grader.service.routes.problems import responses
from grader.service.routes.views import View
from grader.use_cases import platform_people, platforms
from grader.use_cases.bodies import Body

router = APIRouter(prefix="/api/v1/course/platforms", tags=["course"])
_ON_READ = ("forbidden", "no_course", "invalid_request")
_ON_CHANGE = (*_ON_READ, "course_archived", "malformed_body", "too_large", "platforms_not_set_up")
PlatformId = Annotated[str, Path(max_length=16, description="Id of a platform.", examples=["1f0c9a7be2d4"])]


class PlatformBody(Body):
    """What a platform shows of the tool that it made of this service."""

    title: str = Field(max_length=200, examples=["Moodle"])
    issuer: str = Field(max_length=255, description="Platform ID.", examples=["https://moodle.example.edu"])
    client_id: str = Field(max_length=255, examples=["Yt7gXs0Qa2kRw9E"])
    deployment: str = Field(max_length=255, description="Deployment ID.", examples=["1"])
    login_url: str = Field(
        max_length=1_000,
        description="Authentication request URL.",
        examples=["https://moodle.example.edu/mod/lti/auth.php"],
    )
    token_url: str = Field(
        max_length=1_000,
        description="Access token URL.",
        examples=["https://moodle.example.edu/mod/lti/token.php"],
    )
    keys_url: str = Field(
        max_length=1_000,
        description="Public keyset URL.",
        examples=["https://moodle.example.edu/mod/lti/certs.php"],
    )


class PlatformView(PlatformBody, View):
    """A platform that sends people to the course."""

    id: str = Field(examples=["1f0c9a7be2d4"])
    created_at: datetime


class ActivityView(View):
    """An activity of a platform that was opened."""

    platform: str = Field(description="Id of the platform.", examples=["1f0c9a7be2d4"])
    resource: str = Field(description="The platform's id of it.", examples=["7"])
    title: str = Field(examples=["走正方形"])
    assignment: str = Field(description="Where it leads; empty: to all of them.", examples=["square"])
    takes_scores: bool = Field(description="The platform has said where its scores go.")
    used_at: datetime


class UnsentView(View):
    """A score that a platform does not take."""

    platform: str = Field(description="Id of the platform.", examples=["1f0c9a7be2d4"])
    resource: str = Field(description="The platform's id of the activity.", examples=["7"])
    person: str = Field(examples=["20260123"])
    trouble: str = Field(description="Why.", examples=["status 400: no such user"])
    tries: int = Field(description="Failed ones in a row.", examples=[2])
    not_before: datetime = Field(description="When it is tried again.")


class PlatformsView(View):
    """The platforms of a course."""

    platforms: list[PlatformView] = Field(description="Oldest first.")
    activities: list[ActivityView] = Field(description="The one that was opened last is first.")
    unsent: list[UnsentView]


@router.get("", summary="The course's learning platforms", responses=responses(*_ON_READ))
def read_platforms(errand: InstructorDep, response: Response) -> PlatformsView:
    """Return the platforms, which activities there lead here, and which scores they do not take."""
    response.headers.update(PRIVATE)
    return PlatformsView(
        platforms=[
            PlatformView.of(platform) for platform in platforms.platforms_of(errand.services, errand.caller)
        ],
        activities=[
            ActivityView.of(activity, takes_scores=bool(activity.line_item))
            for activity in platforms.links_of(errand.services, errand.caller)
        ],
        unsent=[UnsentView.of(score) for score in platforms.troubles_of(errand.services, errand.caller)],
    )


@router.post(
    "",
    summary="Add a learning platform",
    status_code=status.HTTP_201_CREATED,
    responses=responses(
        *_ON_CHANGE, "invalid_platform", "platform_differs", "platform_exists", "too_many_platforms"
    ),
)
def post_platform(errand: InstructorDep, body: PlatformBody) -> PlatformView:
    """Let a platform (LTI 1.3) send people to the course; it opens no other, and gives nobody a role."""
    new = NewPlatform(**{name: value.strip() for name, value in body.model_dump().items()})
    return PlatformView.of(platforms.add_platform(errand.services, errand.caller, new))


@router.delete(
    "/{platform}",
    summary="Remove a learning platform",
    status_code=status.HTTP_204_NO_CONTENT,
    responses=responses(*_ON_READ, "platform_not_found"),
)
def delete_platform(errand: InstructorDep, platform: PlatformId) -> None:
    """Take nobody in from it any more, and send it no scores. Its people are signed out."""
    platforms.remove_platform(errand.services, errand.caller, platform)


class NewPersonView(View):
    """A student of a platform's course whom this course lacks."""

    id: str = Field(examples=["20260123"])
    name: str = Field(examples=["王小明"])
    email: str | None = Field(examples=["wang@example.edu"])


class PeopleView(View):
    """Whom taking a platform's people in adds. Nobody is changed or removed, and all are students."""

    added: list[NewPersonView] = Field(description="In order of id.")
    known: int = Field(description="How many the course has.", examples=[41])
    nameless: list[str] = Field(
        description="Students there without an id that can stand in a class list, by their names.",
        examples=[[]],
    )
    others: int = Field(description="How many there are no students.", examples=[2])
    plan: str = Field(description="Names whom this adds.", examples=["1f0c9a7be2d45a60"])


_PEOPLE = (*_ON_READ, "platform_not_found", "platform_tells_nobody", "platform_people_refused")


@router.get(
    "/{platform}/people",
    summary="Whom a platform's course has and this one lacks",
    responses=responses(*_PEOPLE),
)
def read_people(errand: InstructorDep, platform: PlatformId, response: Response) -> PeopleView:
    """Ask the platform (NRPS 2.0). It has said where, once somebody opened an activity there."""
    response.headers.update(PRIVATE)
    return _people(platform_people.plan(errand.services, errand.caller, platform))


@router.post(
    "/{platform}/people",
    summary="Take a platform's people into the class list",
    responses=responses(*_PEOPLE, "course_archived", "changed_meanwhile"),
)
def post_people(
    errand: InstructorDep,
    platform: PlatformId,
    plan: Annotated[str, Query(max_length=64, description="Refuse if others would be added.")] = "",
) -> PeopleView:
    """Add as students whom the course lacks."""
    seen = Seen.one(plan) if plan else Seen(None)
    return _people(platform_people.add(errand.services, errand.caller, platform, seen))


def _people(plan: platform_people.PeoplePlan) -> PeopleView:
    return PeopleView.of(plan, plan=plan.tag)
