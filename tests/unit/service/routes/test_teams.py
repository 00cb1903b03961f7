"""Teams over HTTP."""

from typing import Any

import httpx
import pytest

from grader.contracts.rules import Extension, Rules
from grader.store.audit import Signature
from grader.use_cases.services import Services

TEAM = "/api/v1/assignments/square/team"
TEAMS = "/api/v1/assignments/square/teams"


@pytest.fixture
def together(services: Services, school: Any) -> Any:
    """Headers by person, in a course where two hand in together."""
    services.rules.set("square", Rules(team_size=2), Signature(services.clock(), "ros", "wang"))
    return school


def test_students_form_a_team_and_read_it(client: httpx.Client, together: Any) -> None:
    li, han = together.as_("li"), together.as_("han")
    assert client.get(TEAM, headers=li).json() == {"team": None, "team_size": 2}
    code = client.put(TEAM, headers=li, json={}).json()["code"]
    looks_alike = code.translate(str.maketrans("258", "zsb"))
    typed = f" {looks_alike[:4].lower()} {looks_alike[4:]}"
    joined = client.put(TEAM, headers=han, json={"code": typed}).json()
    assert joined == {"code": code, "members": ["han", "li"], "by_staff": False}
    assert client.get(TEAM, headers=li).json()["team"] == joined
    assert client.get(TEAMS, headers=together.as_("ta")).json() == {"teams": [joined]}
    assert client.delete(TEAM, headers=han).status_code == 204
    assert client.put(TEAM, headers=han, json={"code": "x"}).json()["code"] == "team_not_found"


def test_only_students_and_only_where_the_rules_say_so(client: httpx.Client, together: Any) -> None:
    straight = TEAM.replace("square", "straight")
    assert client.put(straight, headers=together.as_("li"), json={}).json()["code"] == "no_teams"
    assert client.put(TEAM, headers=together.as_("wang"), json={}).json()["code"] == "no_teams"


def test_instructors_put_teams_together(client: httpx.Client, together: Any, services: Services) -> None:
    wang = together.as_("wang")
    made = client.put(TEAMS, headers=wang, json={"teams": [["li", "han"]]}).json()["teams"]
    assert [(one["members"], one["by_staff"]) for one in made] == [(["han", "li"], True)]
    assert client.delete(TEAM, headers=together.as_("li")).json()["code"] == "team_fixed"
    for teams, code in (([["li", "li"]], "invalid_request"), ([["li"], ["ta"]], "unknown_student")):
        refused = client.put(TEAMS, headers=wang, json={"teams": teams}).json()
        assert (refused["code"], refused["field"]) == (code, "teams")
    extension = {"extra_attempts": 1}
    client.put("/api/v1/assignments/square/extensions/li", headers=wang, json=extension)
    assert services.rules.of("ros").extension("square", "han") == Extension(extra_attempts=1)
