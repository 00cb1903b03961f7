"""The instructor's desk: what somebody who teaches with this stumbled over once."""

from collections.abc import Callable

import httpx
import pytest

from grader.contracts.grading import AssignmentSource
from grader.contracts.identity import RosterEntry
from grader.contracts.rules import Rules
from grader.contracts.text import Text
from grader.store.audit import Signature
from grader.use_cases.services import Services
from tests.unit.service.web.conftest import Browser


@pytest.fixture
def wang(client: httpx.Client, tokens: dict[str, str]) -> Browser:
    browser = Browser(client)
    browser.enter(token=tokens["wang"])
    return browser


def test_staff_see_the_code_and_the_browsers_session_opens_the_file(
    wang: Browser, put: Callable[..., str]
) -> None:
    own = put(b"good = 'look here'\n", student="li", course="ros")
    text = wang.get(own).text
    assert "look here" in text
    assert f'href="{own}/source"' in text
    assert wang.get(f"{own}/source").content == b"good = 'look here'\n"


def test_hidden_items_are_hidden_in_what_an_instructor_exports_for_students(
    wang: Browser, put: Callable[..., str], services: Services
) -> None:
    rules = Rules(hidden_items=("closed",))
    services.rules.set("square", rules, Signature(services.clock(), "ros", "wang"))
    submission = put(student="li", course="ros").rpartition("/")[2]
    tests = wang.get(f"/class/submissions/{submission}/gradescope.json").json()["tests"]
    hidden = {one["number"] for one in tests if one["visibility"] == "hidden"}
    items = [item.id for item in services.assignments.get("square").items]
    assert hidden == {str(items.index("closed") + 1)}


def test_a_file_that_is_wrong_is_named_where_operators_look(
    wang: Browser,
    client: httpx.Client,
    services: Services,
    shipped: AssignmentSource,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    told = Text(zh="第 3 行写了一半", en="line 3 is cut off")
    monkeypatch.setattr(type(shipped), "troubles", lambda self: {"own": told})
    assert "第 3 行写了一半" in wang.get("/class/service").text
    assert client.get("/healthz").json()["broken_assignments"] == ["own"]


def test_canvas_finds_its_columns_in_every_language(wang: Browser, put: Callable[..., str]) -> None:
    put(student="li", course="ros")
    pages = [wang.get(f"/class/gradebook.csv?format=canvas&lang={one}").content for one in ("zh", "en")]
    assert pages[0] == pages[1]


def test_every_page_of_the_class_says_which_course_it_is(wang: Browser, services: Services) -> None:
    title = services.courses.get("ros").title
    for path in ("/class", "/class/gradebook", "/class/rules", "/class/people", "/class/course"):
        assert f'<span class="course">{title}' in wang.get(path).text, path


def test_an_empty_name_in_a_list_takes_no_name_away(services: Services, tokens: dict[str, str]) -> None:
    services.courses.import_roster("ros", [RosterEntry(id="li", name="李雷")], "wang")
    services.courses.import_roster("ros", [RosterEntry(id="li", name="")], "wang")
    member = services.courses.member("ros", "li")
    assert member is not None
    assert member.name == "李雷"
