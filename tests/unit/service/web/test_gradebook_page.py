"""The gradebook, the roster and the audit log as pages."""

import base64
import csv
import io
import re
from collections.abc import Callable

import pytest

from grader.contracts.identity import RosterEntry
from grader.contracts.rules import Counts, Rules
from grader.service.web.people_pages import address
from grader.store.audit import Signature
from grader.use_cases.services import Services
from tests.unit.service.web.conftest import Browser


@pytest.fixture
def wang(browser: Browser, tokens: dict[str, str]) -> Browser:
    browser.get("/?lang=en")
    browser.enter(token=tokens["wang"])
    return browser


def rows(text: str) -> list[str]:
    return re.findall(r'<th scope="row"><a href="/class/students/([^"?]+)"', text)


def test_the_gradebook_shows_what_counts(wang: Browser, services: Services, put: Callable[..., str]) -> None:
    services.rules.set("square", Rules(counts=Counts.LAST), Signature(services.clock(), "ros", "wang"), "")
    put(b"good good", student="li", course="ros")
    last = put(b"good", student="li", course="ros")
    put(b"good", student="li", course="ros", assignment="spin", grading=None)
    text = wang.get("/class/gradebook").text
    assert rows(text) == ["han", "li"]  # who handed in nothing, too; no staff
    assert f'<a href="{last}"><span aria-hidden="true">✗</span>5 <small>best 10</small></a>' in text
    assert ">queued</a>" in text
    assert "<strong>5</strong>" in text


@pytest.mark.parametrize(
    ("query", "students"), [("search=LI", ["li"]), ("search=zz", []), ("page=9", ["han", "li"])]
)
def test_the_gradebook_is_searched(wang: Browser, query: str, students: list[str]) -> None:
    assert rows(wang.get(f"/class/gradebook?{query}").text) == students


def test_the_gradebook_is_downloaded(wang: Browser, put: Callable[..., str]) -> None:
    put(b"good", student="li", course="ros")
    page = wang.get("/class/gradebook").text
    for address_, first in (
        ("/class/gradebook.csv", "student"),
        ("/class/gradebook.csv?format=canvas", "Student"),
    ):
        assert f'href="{address_}" download' in page
        answer = wang.get(address_)
        assert answer.headers["content-disposition"].startswith("attachment; filename=")
        table = list(csv.reader(io.StringIO(answer.text.removeprefix("\ufeff"))))
        assert table[0][0] == first
        assert len({len(row) for row in table}) == 1
    assert wang.get("/class/gradebook.csv?format=xml").status_code == 422
    for address_ in ("/class/gradebook.xlsx", "/class/gradebook.xlsx?layout=registry"):
        assert f'href="{address_}" download' in page
        assert wang.get(address_).content.startswith(b"PK")


def test_the_gradebook_is_of_one_section(wang: Browser, services: Services) -> None:
    services.courses.import_roster("ros", [RosterEntry(id="li", name="", sections=("A",))], "test")
    page = wang.get("/class/gradebook?section=A").text
    assert rows(page) == ["li"]
    assert 'href="/class/gradebook.csv?format=canvas&amp;section=A" download' in page
    assert "han" not in wang.get("/class/gradebook.csv?section=A").text


def test_a_sheet_is_filled_in_or_refused_on_the_page(wang: Browser) -> None:
    def send(column: str):
        files = {"file": ("s.csv", b"id,points\nli,\n99,\n")}
        return wang.post("/class/gradebook/fill", {"column": column}, files=files, page="/class/gradebook")

    shown = send("points").text
    assert "1 rows with an id that nobody in the course has" in shown
    link = re.search(r'href="data:[^,"]*;base64,([^"]+)" download="s.xlsx"', shown)
    assert link is not None
    assert base64.b64decode(link[1]).startswith(b"PK")
    wrong = send("grade")
    assert wrong.status_code == 422
    assert "there are: points" in wrong.text
    assert '<select id="column" name="column"><option>points</option></select>' in wrong.text


def test_the_column_named_as_the_assignment_is_filled_and_who_has_no_points_is_named(
    wang: Browser, put: Callable[..., str]
) -> None:
    put(b"good", student="li", course="ros")
    files = {"file": ("s.csv", "学号,正方形\nli,\nhan,\n".encode())}
    shown = wang.post(
        "/class/gradebook/fill", {"assignment": "square"}, files=files, page="/class/gradebook"
    ).text
    assert "1 rows of students who have no points yet" in shown
    assert "<td>han</td>" in shown


def test_without_a_course_the_gradebook_has_who_handed_in(
    instructor: Browser, put: Callable[..., str]
) -> None:
    put(student="s1")
    assert rows(instructor.get("/class/gradebook").text) == ["s1"]


def test_the_matrix_shows_the_whole_roster(wang: Browser, put: Callable[..., str]) -> None:
    put(b"good", student="li", course="ros")
    text = wang.get("/class").text
    assert rows(text) == ["han", "li"]
    assert "2 of 2 students" in text
    for query, students in (
        ("show=at_risk", ["han"]),
        ("show=not_begun&assignment=square", ["han"]),
        ("sort=activity", ["han", "li"]),
        ("sort=square&descending=1", ["li", "han"]),
        ("search=an", ["han"]),
    ):
        assert rows(wang.get(f"/class?{query}").text) == students, query


def test_names_are_shown_and_found(wang: Browser, services: Services) -> None:
    from grader.contracts.identity import Role, RosterEntry

    services.courses.import_roster("ros", [RosterEntry(id="li", name="李雷", role=Role.STUDENT)], "test")
    for page in ("/class", "/class/gradebook"):
        text = wang.get(f"{page}?search=李").text
        assert rows(text) == ["li"], page
        assert '<span class="name">李雷</span>' in text
    assert "<h1>li 李雷</h1>" in wang.get("/class/students/li").text


def test_the_roster_lists_everybody(wang: Browser) -> None:
    text = wang.get("/class/people").text
    assert [role in text for role in ("student", "assistant", "instructor")] == [True] * 3
    assert "4 of 4 members" in text
    assert "1 of 4 members" in wang.get("/class/people?search=wan").text


def test_without_a_course_the_roster_says_how_to_begin(instructor: Browser) -> None:
    assert "grader course create" in instructor.get("/class/people").text


def test_the_audit_log_is_paged(wang: Browser, services: Services) -> None:
    signed = Signature(services.clock(), "ros", "wang")
    for attempts in range(1, 60):
        services.rules.set("square", Rules(attempts=attempts), signed, f"change {attempts}.")
    newest = wang.get("/class/audit").text
    assert newest.count("rules changed") == 50
    assert "change 59." in newest
    older = re.search(r'href="(/class/audit\?before=\d+)"', newest)
    assert older is not None
    text = wang.get(older[1]).text
    assert "change 9." in text
    assert "change 59." not in text
    assert 'href="/class/audit"' in text


def test_entries_of_the_log_lead_to_what_they_are_about() -> None:
    assert address("submission 019-ab") == "/submissions/019-ab"
    assert address("assignment square") == "/class/rules/square"
    assert address("assignment square, member li") == "/class/rules/square"
    assert address("submission 019-ab, item near/timer") == "/submissions/019-ab"
    assert address("regrade 9f2c of square") == "/class/regrades/9f2c"
    assert address("submission //evil") == ""
    assert address("member li") == ""
