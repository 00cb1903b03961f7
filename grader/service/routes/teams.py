"""Teams for an assignment: students form them with a code, instructors put them together."""

from typing import Annotated

from fastapi import APIRouter, Response
from pydantic import Field

from grader.contracts.team import LARGEST_TEAM
from grader.service.requests.answers import PRIVATE
from grader.service.requests.dependencies import AssignmentId, ErrandDep, InstructorDep, StaffDep
from grader.service.routes.problems import responses
from grader.service.routes.views import View
from grader.use_cases import teams as use_case
from grader.use_cases.bodies import Body

router = APIRouter(prefix="/api/v1/assignments/{assignment_id}", tags=["teams"])
_ON_READ = ("assignment_not_found", "invalid_request")
_ON_CHANGE = (*_ON_READ, "malformed_body", "too_large", "course_archived")
_MOST_TEAMS = 2_000
Person = Annotated[str, Field(max_length=64, examples=["20260123"])]


class TeamView(View):
    """Who hands in together."""

    code: str = Field(description="By which others join, unless staff formed it.", examples=["7KX3WQ4H"])
    members: list[str] = Field(examples=[["20260123", "20260124"]])
    by_staff: bool = Field(description="Staff formed it: nobody joins or leaves it.")


class OwnTeam(View):
    """The caller's team."""

    team: TeamView | None = Field(description="Null: the caller hands in alone.")
    team_size: int = Field(description="Most members; 1: the assignment is not for teams.", examples=[3])


class TeamList(View):
    """All teams of an assignment."""

    teams: list[TeamView]


class Joining(Body):
    """Which team to join."""

    code: str | None = Field(default=None, max_length=40, description="Null: a new one.")


class TeamsChange(Body):
    """New teams, in place of all that there were."""

    teams: list[Annotated[list[Person], Field(min_length=1, max_length=LARGEST_TEAM)]] = Field(
        max_length=_MOST_TEAMS
    )


@router.get("/team", summary="One's own team", responses=responses(*_ON_READ))
def read_own(errand: ErrandDep, response: Response, assignment_id: AssignmentId) -> OwnTeam:
    """Return with whom the caller hands in."""
    response.headers.update(PRIVATE)
    team, size = use_case.own_team(errand.services, errand.caller, assignment_id)
    return OwnTeam(team=None if team is None else TeamView.of(team), team_size=size)


@router.put(
    "/team",
    summary="Form or join a team",
    responses=responses(*_ON_CHANGE, "no_teams", "team_not_found", "team_full", "team_fixed"),
)
def join(errand: ErrandDep, assignment_id: AssignmentId, joining: Joining) -> TeamView:
    """Put the caller, a student, into the team with the code, or into a new one."""
    return TeamView.of(use_case.join_team(errand.services, errand.caller, assignment_id, joining.code))


@router.delete(
    "/team",
    summary="Leave one's team",
    status_code=204,
    responses=responses(*_ON_READ, "course_archived", "no_teams", "team_fixed"),
)
def leave(errand: ErrandDep, assignment_id: AssignmentId) -> None:
    """Take the caller out of a team that students formed and that has handed in nothing with them."""
    use_case.leave_team(errand.services, errand.caller, assignment_id)


@router.get("/teams", summary="All teams", responses=responses(*_ON_READ, "forbidden"))
def read_all(errand: StaffDep, assignment_id: AssignmentId) -> TeamList:
    """Return the teams; to an assistant those with a student whom they look after."""
    teams = use_case.teams_of(errand.services, errand.caller, assignment_id)
    return TeamList(teams=[TeamView.of(team) for team in teams])


@router.put(
    "/teams",
    summary="Put teams together",
    responses=responses(*_ON_CHANGE, "forbidden", "no_course", "unknown_student"),
)
def change_all(errand: InstructorDep, assignment_id: AssignmentId, change: TeamsChange) -> TeamList:
    """Put teams in place of all that there were. What was handed in stays with whoever has it."""
    use_case.set_teams(errand.services, errand.caller, assignment_id, change.teams)
    return read_all(errand, assignment_id)
