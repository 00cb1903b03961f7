"""Teams as pages: the student's, with the code by which others join, and the list that staff writes."""

import re
from typing import Annotated, Literal

from fastapi import APIRouter, Depends, Form, Query, Response
from fastapi.responses import RedirectResponse

from grader.contracts.errors import RefusedError
from grader.contracts.team import LARGEST_TEAM
from grader.service.web.access import (
    AssignmentId,
    InstructorDep,
    KnownDep,
    PageErrand,
    StaffDep,
    require_staff,
)
from grader.service.web.errors import form_problem
from grader.service.web.forms import OWN_FORM
from grader.service.web.pages import page
from grader.use_cases.assignments import require_published
from grader.use_cases.people import names, person
from grader.use_cases.teams import join_team, leave_team, set_teams, team_size, teams_of

own = APIRouter(prefix="/assignments/{assignment_id}/team", include_in_schema=False)
router = APIRouter(prefix="/class/teams", include_in_schema=False, dependencies=[Depends(require_staff)])
_BETWEEN = re.compile(r"[\s,，、;；]+")


@own.post("", dependencies=OWN_FORM)
def change_own(
    errand: KnownDep,
    assignment_id: AssignmentId,
    action: Annotated[Literal["start", "join", "leave"], Form()],
    code: Annotated[str, Form(max_length=40)] = "",
) -> Response:
    """Form, join or leave a team."""
    if action == "leave":
        leave_team(errand.services, errand.caller, assignment_id)
    else:
        join_team(errand.services, errand.caller, assignment_id, code if action == "join" else None)
    return RedirectResponse(f"/assignments/{assignment_id}#team", status_code=303)


@router.get("/{assignment_id}")
def read(
    errand: StaffDep,
    assignment_id: AssignmentId,
    saved: Annotated[str, Query(pattern="^1?$")] = "",
    like: Annotated[str, Query(max_length=64)] = "",
) -> Response:
    """Show the teams, a line each, in a form for instructors; `like`: filled with those of another assignment."""
    teams = teams_of(errand.services, errand.caller, like or assignment_id)
    return _page(
        errand, assignment_id, "\n".join(" ".join(team.members) for team in teams), saved=bool(saved)
    )


@router.post("/{assignment_id}", dependencies=OWN_FORM)
def change(
    errand: InstructorDep,
    assignment_id: AssignmentId,
    teams: Annotated[str, Form(max_length=200_000)] = "",
) -> Response:
    """Put the teams that are written in place of the old ones, or say what is wrong with them."""
    wanted = [line for text in teams.splitlines() if (line := [id_ for id_ in _BETWEEN.split(text) if id_])]
    try:
        set_teams(errand.services, errand.caller, assignment_id, wanted)
    except RefusedError as problem:
        if problem.members.get("field") != "teams":
            raise
        return _page(errand, assignment_id, teams, problem)
    return RedirectResponse(f"/class/teams/{assignment_id}?saved=1", status_code=303)


def _page(
    errand: PageErrand,
    assignment_id: str,
    text: str,
    problem: RefusedError | None = None,
    *,
    saved: bool = False,
) -> Response:
    services, caller = errand.services, errand.caller
    assignment = require_published(services, caller, assignment_id)
    teams = teams_of(services, caller, assignment_id)
    everybody = names(services, caller)
    inside = {member for team in teams for member in team.members}
    refusal = None if problem is None else form_problem(problem, errand.language)
    rules = services.rules.of(caller.course)
    every = services.assignments.of(caller.course).all()
    return page(
        errand.request,
        "teams.html",
        status=200 if refusal is None else refusal.status,
        assignment=assignment,
        others=[one for one in every if one.id != assignment_id and rules.of(one.id).team_size > 1],
        size=team_size(services, caller, assignment_id),
        largest=LARGEST_TEAM,
        teams=teams,
        people={id_: person(everybody, id_) for id_ in everybody},
        alone=[id_ for id_ in everybody if id_ not in inside],
        text=text,
        refusal=refusal,
        saved=saved,
        may_change=caller.is_instructor and caller.course is not None,
    )
