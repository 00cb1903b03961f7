"""Grading again as pages: choose, watch, look at the difference, decide; and the history of a submission."""

import re
from collections.abc import Callable
from dataclasses import replace
from html import unescape

import pytest

from grader.contracts.grading import GradingJob
from grader.contracts.regrade import ScoreChange, Wanted
from grader.service.web.regrade_table import ChangesQuery, changes
from grader.store.audit import Signature
from grader.use_cases.services import Services
from tests.unit.service.web.conftest import Browser


def text_of(page: str) -> str:
    """What a page says, without tags and with single spaces."""
    return " ".join(unescape(re.sub(r"<[^>]*>", " ", page)).split())


def better_for_short_files(job: GradingJob) -> GradingJob:
    """One item more for files of one word, one less for longer ones."""
    words = job.source.split()
    return replace(job, source=b"good " * (2 if len(words) == 1 else len(words) - 1))


@pytest.fixture
def wang(browser: Browser, tokens: dict[str, str]) -> Browser:
    browser.get("/?lang=en")
    browser.enter(token=tokens["wang"])
    return browser


@pytest.fixture
def handed_in(wang: Browser, put: Callable[..., str]) -> dict[str, str]:
    return {
        "li": put(b"good", student="li", course="ros"),
        "han": put(b"good good good", student="han", course="ros"),
        "li spin": put(b"good", student="li", course="ros", assignment="spin"),
    }


def start(browser: Browser, **order: str) -> str:
    answer = browser.post("/class/regrades", {"assignment": "square", "which": "all", **order})
    assert answer.status_code == 303, text_of(answer.text)
    return answer.headers["Location"]


def test_a_trial_shows_its_progress(wang: Browser, handed_in: dict[str, str]) -> None:
    page = start(wang)
    text = wang.get(page).text
    assert "0 of 2 done" in text
    assert '/trial.js"' in text
    assert 'http-equiv="refresh"' not in text  # it would lose the reason that is being written
    assert f'<noscript><p><a href="{page}">' in text
    assert 'value="apply"' not in text
    assert wang.get(page + "/state.json").json() == {"waiting": 2, "total": 2, "open": True}


def test_the_difference_names_who_and_by_which_item(
    wang: Browser, handed_in: dict[str, str], grade_waiting: Callable[..., None]
) -> None:
    page = start(wang)
    grade_waiting(better_for_short_files)
    text = text_of(wang.get(page).text)
    assert "1 gain 1 lose 0 stay as they are" in text
    assert "li 5 10 +5 Number of sides: 0 → to 5" in text
    assert "han 15 10 −5 Corner angles: 5 → to 0" in text
    only = text_of(wang.get(page + "?part=lose").text)
    assert "han 15 10 −5" in only
    assert "li 5 10" not in only


def test_both_gradings_stand_side_by_side(
    wang: Browser, handed_in: dict[str, str], grade_waiting: Callable[..., None]
) -> None:
    page = start(wang)
    change = f"{page}/changes/{handed_in['li'].rpartition('/')[2]}"
    assert wang.get(change).status_code == 409  # not made yet
    grade_waiting(better_for_short_files)
    assert f'href="{change}"' in wang.get(page).text
    for decided in (False, True):
        if decided:
            wang.post(page, {"decision": "apply", "reason": "x"})
        text = text_of(wang.get(change).text)
        assert "A · 5 / 100" in text
        assert "B · 10 / 100" in text
        assert ("on trial" in text) is not decided


def test_applying_changes_the_scores_and_says_who_and_why(
    wang: Browser, handed_in: dict[str, str], grade_waiting: Callable[..., None], services: Services
) -> None:
    page = start(wang)
    grade_waiting(better_for_short_files)
    answer = wang.post(page, {"decision": "apply", "reason": "corner tolerance was too tight"})
    assert answer.status_code == 303
    assert services.submissions.get(handed_in["li"].rpartition("/")[2]).score == 10.0
    text = wang.get(page).text
    assert "applied" in text
    assert "corner tolerance was too tight" in text
    assert 'value="apply"' not in text
    history = text_of(wang.get("/class/regrades").text)
    assert "✓ applied 1 1 2 wang: corner tolerance was too tight" in history
    assert wang.post(page, {"decision": "apply", "reason": "again"}, page="/").status_code == 409


def test_an_applied_one_is_undone_and_the_student_told(
    wang: Browser, handed_in: dict[str, str], grade_waiting: Callable[..., None], tokens: dict[str, str]
) -> None:
    page = start(wang)
    grade_waiting(better_for_short_files)
    wang.post(page, {"decision": "apply", "reason": "fairer <now>"})
    wang.enter(token=tokens["li"])
    assert "points changed by a re-grade: 1" in wang.get("/").text
    text = text_of(wang.get(handed_in["li"]).text)
    assert "5 → to 10 Reason: fairer <now> Number of sides: 0 → to 5" in text
    assert "points changed by a re-grade" not in wang.get("/").text

    wang.enter(token=tokens["wang"])
    assert wang.post(page, {"decision": "undo", "reason": " "}).status_code == 422
    assert wang.post(page, {"decision": "undo", "reason": "too soon"}).status_code == 303
    assert "undone" in text_of(wang.get("/class/regrades").text)
    assert 'value="undo"' not in wang.get(page).text
    assert wang.post(page, {"decision": "undo", "reason": "x"}, page="/class/regrades").status_code == 409
    wang.enter(token=tokens["li"])
    assert "points changed by a re-grade: 1" in wang.get("/").text
    assert "A re-grade was undone" in wang.get(handed_in["li"]).text


def test_discarding_changes_nothing(
    wang: Browser, handed_in: dict[str, str], grade_waiting: Callable[..., None], services: Services
) -> None:
    page = start(wang)
    grade_waiting(better_for_short_files)
    assert wang.post(page, {"decision": "discard", "reason": "no"}).status_code == 303
    assert services.submissions.get(handed_in["li"].rpartition("/")[2]).score == 5.0
    text = wang.get(page).text
    assert "discarded" in text
    assert "/changes/" not in text


def test_a_decision_needs_a_reason(
    wang: Browser, handed_in: dict[str, str], grade_waiting: Callable[..., None]
) -> None:
    page = start(wang)
    grade_waiting()
    answer = wang.post(page, {"decision": "apply", "reason": "  "})
    assert answer.status_code == 422
    assert re.search(r'id="reason"[^>]*aria-invalid="true"[^>]*aria-describedby="reason-error', answer.text)
    assert "Nothing changes for anybody" in answer.text


@pytest.mark.parametrize(
    ("order", "field", "words"),
    [
        ({"assignment": "nothing"}, "assignment", "There is no such assignment"),
        ({"assignment": "hello"}, "students", "No submission matches"),
        ({"students": "li, nobody; 12<34"}, "students", "No student has these ids: nobody, 12&lt;34"),
        ({"students": "ta"}, "students", "No student has these ids: ta"),  # staff hands nothing in
    ],
)
def test_what_is_wrong_stands_at_its_field(
    wang: Browser, handed_in: dict[str, str], order: dict[str, str], field: str, words: str
) -> None:
    answer = wang.post("/class/regrades", {"assignment": "square", "which": "latest", **order})
    assert answer.status_code == 422
    assert f'<span class="wrong" id="{field}-error">{words}' in answer.text
    assert re.search(rf'id="{field}"[^>]*aria-invalid="true"', answer.text)
    assert re.search(r'value="latest" checked', answer.text)  # what was chosen is not lost


def test_one_trial_of_an_assignment_is_open_at_a_time(wang: Browser, handed_in: dict[str, str]) -> None:
    start(wang, students="li,han")
    answer = wang.post("/class/regrades", {"assignment": "square"})
    assert answer.status_code == 422
    assert "has an open trial" in answer.text


def test_assistants_look_and_change_nothing(
    browser: Browser, tokens: dict[str, str], services: Services, put: Callable[..., str]
) -> None:
    put(student="li", course="ros")
    signed = Signature(services.clock(), "ros", "wang")
    page = f"/class/regrades/{services.regrades.open(Wanted(assignment='square'), signed).id}"
    browser.enter(token=tokens["ta"])
    for address in ("/class/regrades", page):
        text = browser.get(address).text
        assert 'method="post" action="/class' not in text
    for address in ("/class/regrades", page):
        data = {"assignment": "square", "decision": "discard", "reason": "x"}
        assert browser.post(address, data).status_code == 403


def test_a_large_difference_is_paged() -> None:
    moved = [
        ScoreChange(
            submission=f"id{number}",
            student=f"s{number}",
            before=5.0,
            after=5.0 + number % 3,
            items=(),
            kept=(),
            void=(),
        )
        for number in range(303)
    ]
    shown = changes(moved, None, {"s100": "Ada"}, "en", ChangesQuery(page=99))
    assert (shown.pages, shown.query.page) == (4, 4)
    assert [line.student for line in shown.lines] == ["s300", "s301", "s302"]
    assert shown.counts == {"all": 303, "gain": 202, "lose": 0, "moved": 101}
    gain = changes(moved, None, {"s100": "Ada"}, "en", ChangesQuery(part="gain"))
    assert len(gain.lines) == 100
    assert [line.name for line in gain.lines if line.student == "s100"] == ["Ada"]


def test_every_grading_of_a_submission_is_listed_and_compared(
    wang: Browser, handed_in: dict[str, str], grade_waiting: Callable[..., None]
) -> None:
    page = start(wang)
    grade_waiting(better_for_short_files)
    wang.post(page, {"decision": "apply", "reason": "too tight"})
    submission = handed_in["li"].rpartition("/")[2]
    assert f'href="/class/submissions/{submission}/gradings"' in wang.get(handed_in["li"]).text
    gradings = f"/class/submissions/{submission}/gradings"
    text = wang.get(gradings).text
    assert "graded when handed in" in text
    assert "wang: too tight" in text
    first, second = re.findall(r'name="first" value="(\d+)"', text)
    for query in (f"first={first}&second={second}", f"first={second}&second={first}"):
        compared = text_of(wang.get(f"{gradings}/compare?{query}").text)
        assert compared.index("A · 5 / 100") < compared.index("B · 10 / 100")
    assert wang.get(f"{gradings}/compare?first={first}&second=99").status_code == 404


def test_reports_are_saved_for_other_graders(wang: Browser, handed_in: dict[str, str]) -> None:
    submission = handed_in["li"].rpartition("/")[2]
    for name, field in (("gradescope", "tests"), ("prairielearn", "gradable")):
        answer = wang.get(f"/class/submissions/{submission}/{name}.json")
        assert field in answer.json()
        assert answer.headers["content-disposition"] == f'attachment; filename="{name}-{submission}.json"'


def test_a_service_without_courses_grades_again_too(
    instructor: Browser, put: Callable[..., str], grade_waiting: Callable[..., None]
) -> None:
    put(b"good", student="s1")
    page = start(instructor, students="s1")
    grade_waiting(better_for_short_files)
    assert instructor.post(page, {"decision": "apply", "reason": "x"}).status_code == 303
    for address in ("/class", "/class/gradebook", "/class/judgements", "/class/audit", page):
        assert instructor.get(address).status_code == 200, address
