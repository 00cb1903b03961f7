"""Teams on the pages: the student's form, the list that staff writes, whose a submission is."""

from collections.abc import Callable

import pytest

from grader.contracts.identity import RosterEntry
from grader.contracts.rules import Rules
from grader.store.audit import Signature
from grader.use_cases.services import Services
from tests.unit.service.web.conftest import Browser
from tests.unit.similarity.students import own_code, renamed

SQUARE = "/assignments/square"
TEAMS = "/class/teams/square"
OWN = f"class Own:{own_code(1)}"


@pytest.fixture
def together(tokens: dict[str, str], services: Services, browser: Browser) -> None:
    signed = Signature(services.clock(), "ros", "wang")
    services.rules.set("square", Rules(team_size=2), signed)
    services.courses.import_roster("ros", [RosterEntry(id="han", name="韩梅")], "wang")
    browser.get("/?lang=en")


@pytest.mark.usefixtures("together")
def test_students_join_with_a_code_and_see_one_upload(
    browser: Browser, tokens: dict[str, str], services: Services
) -> None:
    browser.enter(token=tokens["li"])
    assert "You are in no team" in browser.get(SQUARE).text
    assert browser.post(f"{SQUARE}/team", {"action": "start"}, page=SQUARE).status_code == 303
    [team] = services.teams.of("ros", "square")
    assert f"<code>{team.code}</code>" in browser.get(SQUARE).text

    browser.enter(token=tokens["han"])
    joined = browser.post(f"{SQUARE}/team", {"action": "join", "code": team.code.lower()}, page=SQUARE)
    assert joined.status_code == 303
    assert "Team: han 韩梅, li" in browser.get(SQUARE).text
    handed_in = browser.hand_in("square", b"good").headers["Location"]
    assert "Team: han 韩梅, li" in browser.get(handed_in).text

    browser.enter(token=tokens["li"])
    assert "square.py" in browser.get("/submissions").text
    assert browser.get(handed_in).status_code == 404  # it is han's; li has one of their own
    assert browser.post(f"{SQUARE}/team", {"action": "leave"}, page=SQUARE).status_code == 409


@pytest.mark.usefixtures("together")
def test_an_instructor_writes_the_teams(browser: Browser, tokens: dict[str, str], services: Services) -> None:
    browser.enter(token=tokens["wang"])
    assert "Students without a team (2)" in browser.get(TEAMS).text
    wrong = browser.post(TEAMS, {"teams": "li, nobody"}, page=TEAMS)
    assert wrong.status_code == 422
    assert "nobody" in wrong.text
    assert "li, nobody</textarea>" in wrong.text
    assert browser.post(TEAMS, {"teams": "\nli、 han\n"}, page=TEAMS).status_code == 303
    assert [one.members for one in services.teams.of("ros", "square")] == [("han", "li")]
    assert "han li</textarea>" in browser.get("/class/teams/straight?like=square").text
    assert '<option value="square">' in browser.get("/class/teams/straight").text
    assert 'name="like"' not in browser.get(TEAMS).text  # no other assignment is for teams
    browser.enter(token=tokens["ta"])
    assert "<textarea" not in browser.get(TEAMS).text


@pytest.mark.usefixtures("together")
def test_scripts_of_one_team_are_not_compared(
    browser: Browser, tokens: dict[str, str], services: Services, put: Callable[..., str]
) -> None:
    put(OWN.encode(), student="li", course="ros")
    put(renamed(OWN).encode(), student="han", course="ros")
    browser.enter(token=tokens["ta"])
    listed = "/class/similar/square"
    assert "/class/similar/square/pair" in browser.get(listed).text
    services.teams.set(Signature(services.clock(), "ros", "wang"), "square", [["li", "han"]])
    assert "/class/similar/square/pair" not in browser.get(listed).text
