"""Similar scripts over HTTP: what the document says, and how it refuses."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import httpx

from grader.use_cases.services import Services
from tests.fakes.grading import assignment
from tests.unit.similarity.students import own_code, renamed

OWN, OTHER = (f"class Own:{own_code(i)}" for i in (1, 2))
URL = "/api/v1/assignments/square/similar"


def test_two_similar_scripts(
    client: httpx.Client, upload: Callable[..., httpx.Response], school: Any
) -> None:
    for person, source in (("li", OWN), ("han", renamed(OWN)), ("ta", OTHER)):
        assert upload(source.encode(), student="", headers=school.as_(person)).status_code == 202
    response = client.get(URL, headers=school.as_("ta"))
    assert response.headers["Cache-Control"] == "no-store"
    document = response.json()
    (pair,) = document.pop("pairs")
    assert document == {
        "assignment": "square",
        "compared": 2,
        "not_compared": 0,
        "few": 8,
        "too_little": [],
        "left_out": 0,
        "same_commands": [],
    }
    assert (pair["first"]["student"], pair["second"]["student"]) == ("han", "li")
    assert client.get(pair["first"]["submission"], headers=school.as_("ta")).json()["student"] == "han"
    assert pair["first"]["share"] == pair["second"]["share"] == 1.0
    assert (pair["same_file"], pair["same_commands"]) == (False, False)
    lines = OWN.count("\n")
    (place,) = pair["places"]
    assert 1 <= place["first"]["first_line"] <= 3  # what is before the first hash that is kept is not told
    assert lines - 2 <= place["first"]["last_line"] <= lines + 1


def test_refusals_are_problems(client: httpx.Client, services: Services, school: Any) -> None:
    services.assignments.assignments = (replace(assignment("essay"), input="text"),)
    for asked, code, status in (("essay", "no_scripts", 409), ("none", "assignment_not_found", 404)):
        response = client.get(f"/api/v1/assignments/{asked}/similar", headers=school.as_("ta"))
        assert (response.status_code, response.json()["code"]) == (status, code)
