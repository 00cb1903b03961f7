"""The student's way without any script: look, hand in, wait, read the result."""

from collections.abc import Callable
from dataclasses import replace

import pytest

from grader.contracts.errors import UnknownAssignmentError
from grader.contracts.grading import GradingJob, GradingResult
from grader.contracts.outcome import Stream
from grader.contracts.report import CaseOutput
from grader.use_cases.services import Services
from tests.fakes.grading import grade
from tests.unit.service.web.conftest import Browser

BROKEN = b"def broken(\n"


def test_the_checklist_shows_every_assignment(browser: Browser, services: Services) -> None:
    text = browser.get("/").text
    for one in services.assignments.all():
        assert f'href="/assignments/{one.id}"' in text
        assert one.title.zh in text


def test_the_whole_rubric_is_published(browser: Browser) -> None:
    text = browser.get("/assignments/square?lang=en").text
    for words in (
        "Corner angles",
        "90° ± 3°",
        "25 points",
        "Credit falls smoothly",
        "Only the figure counts",
    ):
        assert words in text


def test_a_file_is_handed_in_without_scripts(browser: Browser, services: Services) -> None:
    answer = browser.hand_in("square", b"good", student="20260123")
    assert answer.status_code == 303
    waiting = browser.get(answer.headers["Location"])
    assert waiting.status_code == 200
    assert '<noscript><meta http-equiv="refresh"' in waiting.text
    assert "square.py" in waiting.text
    (stored,) = services.submissions.of_student("20260123")
    assert services.submissions.source(stored.id) == b"good"


def test_the_id_is_remembered(browser: Browser) -> None:
    browser.hand_in("square", b"good", student="20260123")
    assert 'name="student"' not in browser.get("/assignments/square").text
    assert browser.hand_in("square", b"better").status_code == 303
    assert browser.get("/submissions").text.count('href="/submissions/') == 2


def test_a_result_shows_everything(browser: Browser, put: Callable[..., str]) -> None:
    browser.enter(student="s1")
    text = browser.get(put(b"good raise") + "?lang=en").text
    for words in (
        '<span class="big">5</span>', "well done", "go on", "the script crashed", "ValueError: boom", "line 1",
        "✓</span> passed", "✗</span> failed", "try again", "log 0", "Measured", "Wanted", "3 more bytes",
        '<noscript><img class="plot" src=',
    ):  # fmt: skip
        assert words in text


def test_what_stands_in_line_says_its_place(instructor: Browser, put: Callable[..., str]) -> None:
    waiting = [put(student=one, grading=None) for one in ("s1", "s2")]
    assert [instructor.get(one + "/state.json").json()["position"] for one in waiting] == [0, 1]
    assert "1 before yours" in instructor.get(waiting[1] + "?lang=en").text


def test_state_ends_when_graded(browser: Browser, put: Callable[..., str]) -> None:
    browser.enter(student="s1")
    state = browser.get(put() + "/state.json").json()
    assert state == {"open": False, "state": "graded", "text": "已评分", "position": None}


def test_the_replay_gets_its_data(browser: Browser, put: Callable[..., str]) -> None:
    browser.enter(student="s1")
    address = put()
    assert browser.get(address + "/trajectory.json?case=default").json()["end_ns"] == 2_000_000_000
    sketch = browser.get(address + "/sketch.json?case=default").json()
    assert sketch["view"] == "path"
    assert {"sides", "corners", "ideal_m", "gap", "labels"} <= set(sketch)
    assert browser.get(address + "/plot.png").headers["content-type"] == "image/png"


def test_an_unknown_case_is_told(browser: Browser, put: Callable[..., str]) -> None:
    browser.enter(student="s1")
    assert browser.get(put() + "?case=nonsense").status_code == 404


def test_a_withdrawn_assignment_still_shows_its_results(
    browser: Browser, put: Callable[..., str], services: Services, monkeypatch: pytest.MonkeyPatch
) -> None:
    browser.enter(student="s1")
    address = put()

    def gone(assignment_id: str):
        raise UnknownAssignmentError(assignment_id)

    monkeypatch.setattr(services.assignments, "get", gone)
    page = browser.get(address)
    assert page.status_code == 200
    assert '<span class="big">5</span>' in page.text
    assert browser.get(address + "/sketch.json").json() == {}


@pytest.mark.parametrize(
    ("source", "name", "status", "words"),
    [
        (BROKEN, "a.py", 422, "Python 语法错误"),
        (b"", "a.py", 422, "文件是空的"),
        (b"\xff\xfe", "a.py", 422, "UTF-8"),
        (b"x", "a.zip", 415, "文件类型不对"),
    ],
)
def test_a_refused_file_leads_back_to_the_form(
    browser: Browser, source: bytes, name: str, status: int, words: str
) -> None:
    answer = browser.hand_in("square", source, name=name, student="s1")
    assert answer.status_code == status
    assert words in answer.text
    assert 'href="/assignments/square?lang=en"' in answer.text
    assert 'role="alert"' in answer.text
    assert 'value="s1"' in answer.text  # what was typed is not lost
    assert "grader_student" not in answer.headers.get("set-cookie", "")


def test_a_form_without_a_file_is_shown_again(browser: Browser) -> None:
    fields = {"student": "s1"}
    for answer in (
        browser.post("/assignments/square", fields, files={"other": ("", b"")}),  # no such part at all
        browser.hand_in("square", b"", name="", **fields),  # as a browser sends what was not chosen
    ):
        assert answer.status_code == 415
        assert 'name="file"' in answer.text
        assert 'value="s1"' in answer.text
        assert ".py" in answer.text


def test_a_syntax_error_shows_its_line(browser: Browser) -> None:
    answer = browser.hand_in("square", b"x = 1\n" + BROKEN, student="s1")
    assert "<b>2</b> def broken(" in answer.text


def test_a_wrong_id_is_told_at_its_field(browser: Browser) -> None:
    answer = browser.hand_in("square", b"good", student="../etc")
    assert answer.status_code == 422
    assert 'aria-invalid="true"' in answer.text


def test_a_huge_file_gets_a_page(browser: Browser) -> None:
    answer = browser.hand_in("square", b"x" * 100_000, student="s1")
    assert answer.status_code == 413
    assert "文件太大" in answer.text


def test_texts_are_taken_where_texts_are_asked_for(browser: Browser) -> None:
    page = browser.get("/assignments/calculation").text
    assert 'accept=".txt,.md"' in page
    assert browser.hand_in("calculation", "12 秒".encode(), name="a.txt", student="s1").status_code == 303


def test_an_answer_may_be_written_on_the_page(browser: Browser, services: Services) -> None:
    question, page = "theory_publisher_timer", "/assignments/theory_publisher_timer"
    none = {"file": ("", b"", "application/octet-stream")}  # as browsers send it
    browser.enter(student="20260123")
    assert 'data-draft="20260123"' in browser.get(page).text
    sent = browser.post(page, {"text": "第一行\r\n\r\n第二行"}, files=none, page=page)
    assert sent.status_code == 303
    stored = services.submissions.of_student("20260123", question)[0]
    assert stored.file_name == "answer.txt"
    assert services.submissions.source(stored.id).decode() == "第一行\n\n第二行"
    services.clock.advance(1)
    chosen = {"file": ("mine.txt", "定时器".encode("gbk"), "text/plain")}
    assert browser.post(page, {"text": "written"}, files=chosen, page=page).status_code == 303
    stored = services.submissions.of_student("20260123", question)[0]
    assert (stored.file_name, services.submissions.source(stored.id).decode()) == ("mine.txt", "定时器")
    refused = browser.post(page, {"text": "a\0b"}, files=none, page=page)
    assert refused.status_code == 422
    nothing = browser.post(page, {"text": " "}, files=none, page=page)
    assert (nothing.status_code, "还没有写答案" in nothing.text) == (422, True)
    assert "文件是空的" not in nothing.text
    assert 'name="text"' not in browser.get("/assignments/square").text
    square = "/assignments/square"
    assert browser.post(square, {"text": "x = 1"}, files=none, page=square).status_code == 415


@pytest.mark.parametrize("path", ["/nothing", "/assignments/nothing", "/class/nothing"])
def test_unknown_addresses_get_a_page(browser: Browser, path: str) -> None:
    answer = browser.get(path)
    assert answer.status_code == 404
    assert answer.headers["content-type"].startswith("text/html")


def test_programs_keep_getting_problem_documents(browser: Browser) -> None:
    assert browser.get("/api/v1/nothing").headers["content-type"] == "application/problem+json"
    answer = browser.client.get("/nothing", headers={"Accept": "application/json"})
    assert answer.headers["content-type"] == "application/problem+json"


def test_what_a_script_printed_until_it_was_ended_is_shown(browser: Browser, put: Callable[..., str]) -> None:
    def ended_while_printing(job: GradingJob) -> GradingResult:
        result = grade(job)
        printed = CaseOutput(
            case="default", stdout=Stream(text="spam <b>", dropped_bytes=70_000), stderr=Stream()
        )
        return replace(result, measurements=replace(result.measurements, cut_output=(printed,)))

    browser.enter(student="s1")
    text = browser.get(put(grading=ended_while_printing) + "?lang=en").text
    assert "ended while it was still printing" in text
    assert "spam &lt;b&gt;" in text
    assert "70000 more bytes" in text
    assert "ended while it was still printing" not in browser.get(put()).text
