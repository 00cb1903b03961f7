"""The instructor's way: the class, a cell, two attempts, an assignment, the service."""

import re
from collections.abc import Callable
from contextlib import closing

import pytest
from sqlalchemy import update
from sqlmodel import col

from grader.api import warm_up
from grader.contracts.text import Text
from grader.messages import outline
from grader.service.web.pages import compile_all
from grader.store.database import Database
from grader.store.tables import GradedMistakeRow
from grader.use_cases.services import Services
from tests.unit.service.web.conftest import Browser


@pytest.fixture
def school(put: Callable[..., str]) -> dict[str, str]:
    return {
        "ada": put(b"good " * 8, student="ada"),
        "bo": put(b"", student="bo"),
        "bo again": put(b"good good\nchanged = 1", student="bo"),
        "chen": put(b"good", student="chen", assignment="spin"),
        "waiting": put(student="dai", grading=None),
    }


def rows(text: str) -> list[str]:
    return re.findall(r'<th scope="row"><a href="/class/students/([^"?]+)"', text)


def test_the_matrix_shows_every_student(instructor: Browser, school: dict[str, str]) -> None:
    text = instructor.get("/class?lang=en").text
    assert rows(text) == ["ada", "bo", "chen", "dai"]
    assert "4 of 4 students" in text
    assert '×2</span><span class="unseen">2 attempts</span>' in text
    assert "queued" in text


@pytest.mark.parametrize(
    ("query", "students"),
    [
        ("search=A", ["ada", "dai"]),
        ("sort=square&descending=1", ["ada", "bo", "dai", "chen"]),
        ("sort=total", ["dai", "chen", "bo", "ada"]),
        ("show=waiting", ["dai"]),
        ("show=not_begun&assignment=square", ["chen"]),
        ("show=unfinished&assignment=spin", ["ada", "bo", "chen", "dai"]),
        ("show=stuck", []),
        ("page=99", ["ada", "bo", "chen", "dai"]),
    ],
)
def test_the_matrix_is_searched_filtered_and_sorted(
    instructor: Browser, school: dict[str, str], query: str, students: list[str]
) -> None:
    assert rows(instructor.get(f"/class?{query}").text) == students


def test_students_who_try_in_vain_are_stuck(
    instructor: Browser, school: dict[str, str], put: Callable[..., str]
) -> None:
    put(b"", student="bo")
    assert rows(instructor.get("/class?show=stuck").text) == ["bo"]
    assert rows(instructor.get("/class?show=stuck&assignment=spin").text) == []


def test_the_sorted_column_says_so(instructor: Browser, school: dict[str, str]) -> None:
    text = instructor.get("/class?sort=total&descending=1").text
    assert text.count("aria-sort=") == 1
    assert 'aria-sort="descending"' in text


@pytest.mark.parametrize("query", ["show=nonsense", "page=0", "page=x", "search=" + "x" * 200])
def test_a_wrong_query_gets_a_page(instructor: Browser, query: str) -> None:
    assert instructor.get(f"/class?{query}").status_code == 422


def test_a_cell_leads_to_the_attempts(instructor: Browser, school: dict[str, str]) -> None:
    text = instructor.get("/class/students/bo?assignment=square").text
    for address in (school["bo"], school["bo again"]):
        assert f'href="{address}"' in text
    assert text.count('type="radio"') == 4
    assert text.count(" checked>") == 2


def test_a_single_attempt_has_nothing_to_compare(instructor: Browser, school: dict[str, str]) -> None:
    text = instructor.get("/class/students/ada").text
    assert 'type="radio"' not in text
    assert f'href="{school["ada"]}"' in text


def test_unknown_students_are_told(instructor: Browser) -> None:
    unknown = instructor.get("/class/students/nobody?lang=en")
    assert (unknown.status_code, "no such member" in unknown.text) == (404, True)


def test_two_attempts_stand_side_by_side(instructor: Browser, school: dict[str, str]) -> None:
    ids = [school[one].rpartition("/")[2] for one in ("bo again", "bo")]  # in either order
    text = instructor.get(f"/class/compare?first={ids[0]}&second={ids[1]}&lang=en").text
    assert text.index("A · 0") < text.index("B · 10")
    assert text.count(">+5</strong>") == 2
    assert '<span class="added">+changed = 1</span>' in text
    assert text.count("/plot.png") == 2


def test_comparing_needs_two_gradings(instructor: Browser, school: dict[str, str]) -> None:
    first, waiting = (school[one].rpartition("/")[2] for one in ("bo", "waiting"))
    assert instructor.get(f"/class/compare?first={first}&second={waiting}").status_code == 409
    assert instructor.get(f"/class/compare?first={first}").status_code == 422
    assert instructor.get(f"/class/compare?first={first}&second=nothing").status_code == 404


def test_an_assignment_shows_scores_items_and_mistakes(instructor: Browser, school: dict[str, str]) -> None:
    text = instructor.get("/class/assignments/square?lang=en").text
    for words in ("Distribution of best scores", "90–100 %", "Number of sides", "interior_angle"):
        assert words in text
    assert (outline("en", "mistake.interior_angle") or "interior_angle").split("…")[0].strip() in text
    assert instructor.get("/class/assignments/nothing").status_code == 404


@pytest.mark.parametrize(("assignment", "offered"), [("square", True), ("calculation", False)])
def test_only_scripts_are_offered_to_be_compared(instructor: Browser, assignment: str, offered: bool) -> None:
    address = f"/class/similar/{assignment}"
    assert (address in instructor.get(f"/class/assignments/{assignment}").text) == offered
    assert (instructor.get(address).status_code == 200) == offered


def test_the_service_page_tells_queue_and_workers(instructor: Browser, school: dict[str, str]) -> None:
    text = instructor.get("/class/service?lang=en").text
    assert "No worker is alive." in text
    assert "nothing is graded right now" in text
    assert "The first one has been waiting since" in text
    assert "Who cost most in the last hour" in text


def test_gradings_that_are_nobodys_are_named_and_lead_nowhere(
    instructor: Browser, put: Callable[..., str]
) -> None:
    put(b"good", student="")
    text = instructor.get("/class/service?lang=en").text
    assert '<th scope="row">Re-grading (no student)</th>' in text
    assert 'href="/class/students/"' not in text


def test_mistakes_are_outlined_without_their_figures() -> None:
    assert outline("en", "mistake.no_such_mistake") is None
    said = outline("zh", "mistake.crashed")
    assert said is not None
    assert "…" in said
    assert "{" not in said


def test_a_large_class_is_paged(instructor: Browser, put: Callable[..., str], services: Services) -> None:
    for number in range(101):
        put(student=f"s{number:03}", grading=None)
    first = instructor.get("/class?lang=en").text
    assert len(rows(first)) == 100
    assert "Page 1 of 2" in first
    assert rows(instructor.get("/class?page=2").text) == ["s100"]


def test_the_service_page_says_which_files_are_wrong(
    instructor: Browser, monkeypatch: pytest.MonkeyPatch, services: Services
) -> None:
    trouble = Text(zh="assignment.yaml:3: 要是数", en="assignment.yaml:3: must be a number <b>")
    monkeypatch.setattr(services.assignments, "troubles", lambda: {"tri": trouble})
    assert "must be a number &lt;b&gt;" in instructor.get("/class/service?lang=en").text
    assert instructor.client.get("/healthz").json()["broken_assignments"] == ["tri"]


def concerned(text: str) -> list[str]:
    return re.findall(r'<th scope="row"><a href="/class/students/([^"?]+)\?assignment=', text)


def test_a_number_leads_to_the_students_behind_it(instructor: Browser, school: dict[str, str]) -> None:
    text = instructor.get("/class/assignments/square").text
    links = re.findall(r'href="(/class/assignments/square/students[^"]*)"', text)
    items = [one for one in links if "item=" in one]
    assert concerned(instructor.get(links[0]).text) == ["bo", "ada", "dai"]  # who tried most first
    assert concerned(instructor.get(items[-1]).text) == ["bo"]
    assert concerned(instructor.get("/class/assignments/square/students?mistake=wall_hit").text) == ["bo"]
    assert concerned(instructor.get("/class/assignments/square/students?status=queued").text) == ["dai"]
    assert concerned(instructor.get("/class/assignments/square/students?status=unheard").text) == []
    assert instructor.get("/class/assignments/none/students").status_code == 404


def test_a_mistake_that_only_an_earlier_version_knew_still_leads_to_its_students(
    instructor: Browser, school: dict[str, str], sqlite_url: str
) -> None:
    of_one = col(GradedMistakeRow.code) == "wall_hit"
    page = "/class/assignments/square/students?mistake=long_forgotten"
    with closing(Database(sqlite_url)) as database, database.writing() as session:
        session.execute(update(GradedMistakeRow).where(of_one).values(code="long_forgotten"))
    assert "students?mistake=long_forgotten" in instructor.get("/class/assignments/square").text
    assert concerned(instructor.get(page).text) == ["bo"]
    assert instructor.get(page + "s").status_code == 422


def test_who_tries_and_fails_comes_before_who_has_not_begun(
    browser: Browser, tokens: dict[str, str], put: Callable[..., str]
) -> None:
    for _ in range(3):
        put(b"", student="li", course="ros")
    browser.enter(token=tokens["ta"])
    assert rows(browser.get("/class?show=at_risk").text) == ["li", "han"]
    assert "试了 3 次没有进展：" in browser.get("/class?show=at_risk").text
    assert rows(browser.get("/class?show=at_risk&assignment=spin").text) == ["han"]


def test_refused_uploads_are_seen_at_the_student(browser: Browser, tokens: dict[str, str]) -> None:
    browser.enter(token=tokens["li"])
    assert browser.hand_in("square", b"", name="empty.py").status_code == 422
    browser.enter(token=tokens["ta"])
    page = browser.get("/class/students/li").text
    assert "被拒收的提交" in page
    assert "empty.py" in page
    assert "被拒收的提交" not in browser.get("/class/students/li?assignment=spin").text
    assert "提交被拒 1 次" in browser.get("/class?show=at_risk").text


def test_a_service_that_starts_prepares_its_pages(
    services: Services, tokens: dict[str, str], put: Callable[..., str], monkeypatch: pytest.MonkeyPatch
) -> None:
    put(student="li", course="ros")
    compiled: list[bool] = []
    monkeypatch.setattr("grader.api.compile_all", lambda: compiled.append(True))
    monkeypatch.setattr("gc.freeze", lambda: None)  # the tests' process goes on
    warm_up(services).join()
    assert compiled
    monkeypatch.setattr("grader.store.dashboard.counted", None)  # whoever counts anew fails
    assert [one.student for one in services.dashboard.state("ros").progress] == ["li"]


def test_every_template_compiles() -> None:
    compile_all()
