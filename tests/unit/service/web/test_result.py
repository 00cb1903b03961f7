"""The result page is about the student's program, and says what counts."""

import re
from collections.abc import Callable
from dataclasses import replace
from datetime import timedelta
from typing import Any

import pytest

from grader.contracts.assignment import Assignment
from grader.contracts.grading import GradingJob, GradingResult
from grader.contracts.outcome import LogRecord, Stream
from grader.contracts.rubric import ItemStatus
from grader.contracts.rules import LateRule, Rules
from grader.contracts.submission import SubmissionState
from grader.service.web import submission
from grader.service.web.source import source_view
from grader.service.web.waiting import progress
from grader.store.audit import Signature
from grader.use_cases.assignments import published
from grader.use_cases.services import Services
from tests.fakes.grading import grade
from tests.unit.service.web.conftest import Browser


def plain(text: str) -> str:
    """What a page says, without markup and with single spaces."""
    return " ".join(re.sub(r"<[^>]+>", " ", text).split())


@pytest.fixture
def li(browser: Browser, tokens: dict[str, str]) -> Browser:
    browser.get("/?lang=en")
    browser.enter(token=tokens["li"])
    return browser


@pytest.fixture
def ruled(services: Services, tokens: dict[str, str]) -> Callable[[Rules], None]:
    def change(rules: Rules) -> None:
        services.rules.set("square", rules, Signature(services.clock(), "ros", "wang"))

    return change


def test_the_program_is_shown_with_its_failing_line(browser: Browser, put: Callable[..., str]) -> None:
    browser.enter(student="s1")
    address = put(b"raise <b>\x0c\xe2\x80\xa8\r\n\tif good:\n", name="<i>.py")
    text = browser.get(address).text
    assert '<li id="L1" class="wrong-line"><code>raise &lt;b&gt;\\x0c\\u2028</code>' in text
    assert "ValueError: boom</p></li>" in text
    assert '<li id="L2"><code>    if good:</code></li>' in text
    assert 'href="#L1"' in text
    kept = browser.get(f"{address}/source")
    assert kept.content == b"raise <b>\x0c\xe2\x80\xa8\r\n\tif good:\n"
    assert kept.headers["Content-Disposition"] == "attachment; filename*=UTF-8''%3Ci%3E.py"
    assert kept.headers["X-Content-Type-Options"] == "nosniff"


def test_each_case_of_a_robot_has_its_picture(
    browser: Browser, put: Callable[..., str], monkeypatch: pytest.MonkeyPatch
) -> None:
    browser.enter(student="s1")
    address = put(b"good good\n")
    picture = f'<img class="plot" src="{address}/plot.png?case=default"'
    assert browser.get(address).text.count(picture) == 1  # for browsers without scripts

    def with_robot(*arguments: Any) -> Assignment:
        found = published(*arguments)
        return replace(found, world=replace(found.world, kind="robot"))

    monkeypatch.setattr(submission, "published", with_robot)
    text = browser.get(address).text
    assert text.count(picture) == 2
    assert 'loading="lazy"' in text


def test_a_long_file_is_shown_in_part() -> None:
    view = source_view(b"x" * 600 + b"\n" * 2_100, {})
    assert (len(view.lines), view.left_out, view.cut) == (2_000, 100, True)
    assert len(view.lines[0].text) == 500


def test_a_log_message_is_shown_once(browser: Browser, put: Callable[..., str]) -> None:
    def logging(job: GradingJob) -> GradingResult:
        result = grade(job)
        (run,) = result.report.runs
        logs = tuple(LogRecord(t_ns=1, level=20, name="n", message=one) for one in ("one", "two\nlines"))
        printed = (
            "[INFO] [1.000000001] [n]: one\nmine\n[INFO] [1.000000001] [n]: two\nlines\n[INFO] [n]: one\n"
        )
        outcome = replace(run.outcome, logs=logs, stderr=Stream(text=printed))
        return replace(result, report=replace(result.report, runs=(replace(run, outcome=outcome),)))

    browser.enter(student="s1")
    text = browser.get(put(grading=logging)).text
    assert text.count("[n] one") == text.count("[n] two\nlines") == 1
    assert ">mine\n[INFO] [n]: one\n</pre>" in text


def test_cases_share_an_item_with_whole_points(browser: Browser, put: Callable[..., str]) -> None:
    def twice(job: GradingJob) -> GradingResult:
        result = grade(job)
        (run,) = result.report.runs
        first, second = (
            replace(result.report.items[0], id=f"{case}/sides", points=2.5, earned=earned, status=status)
            for case, earned, status in (("1.5", 2.5, ItemStatus.PASSED), ("3", 0.0, ItemStatus.FAILED))
        )
        runs = tuple(replace(run, case=case) for case in ("1.5", "3"))
        recorded = dict.fromkeys(("1.5", "3"), result.trajectories["default"])
        report = replace(result.report, items=(first, second), runs=runs, score=2.5, max_score=5.0)
        return replace(result, report=report, trajectories=recorded)

    browser.enter(student="s1")
    text = plain(browser.get(put(b"raise", assignment="square_input", grading=twice) + "?lang=en").text)
    assert text.count("/ 5 ") == 3  # title, score and the one item
    assert "~ partial 2.5 / 5" in text
    assert text.count("ValueError: boom line 1") == 1


def test_what_counts_is_the_same_on_every_page(
    li: Browser, put: Callable[..., str], services: Services, ruled: Callable[[Rules], None]
) -> None:
    late = LateRule(kind="linear", per_day=0.1)
    own = put(b"good good", student="li", course="ros")
    ruled(Rules(due=services.clock() - timedelta(hours=1), late=late, attempts=2))
    before = plain(li.get("/assignments/square").text)
    assert "Handing in now costs 10 % of the points." in before
    home, history, result = (plain(li.get(page).text) for page in ("/", "/submissions", own))
    assert "counts 9 / 100" in home
    assert "Best 10 / 100" in home
    assert "10 / 100 10 % off for lateness: 9 points counts" in history
    assert "This attempt counts: 9 points" in result
    for page in (home, history, result):
        assert "Attempts left: 1" in page
        assert "(past)" in page
    assert "Handing in now costs 10 %" in home
    assert "Handing in now costs 10 %" in result
    put(b"worse", student="li", course="ros")
    result = li.get(own).text
    assert "No attempts are left." in result
    assert 'class="button" href="/assignments/square"' not in result


def test_the_score_reads_the_same_while_items_are_hidden(
    li: Browser, put: Callable[..., str], ruled: Callable[[Rules], None], tokens: dict[str, str]
) -> None:
    ruled(Rules(hidden_items=("closed",)))
    own = put(b"good good", student="li", course="ros")
    assert all("10 / 85 " in plain(li.get(page).text) for page in ("/", "/submissions", own))
    assert "Some items are not shown now" in li.get(own).text
    assert "some items are hidden" in li.get("/").text
    li.enter(token=tokens["wang"])
    assert "hidden from students" in li.get(own).text


def test_the_same_file_again_is_told(browser: Browser) -> None:
    browser.enter(student="s1")
    first, again = (browser.hand_in("square", b"good").headers["Location"] for _ in range(2))
    assert again == f"{first}?same=true"
    assert "this very file before" in browser.get(f"{again}&lang=en").text


def test_no_score_is_told_while_a_person_has_to_grade(browser: Browser, put: Callable[..., str]) -> None:
    def waits(job: GradingJob) -> GradingResult:
        result = grade(job)
        first, second, *_ = result.report.items
        items = (replace(first, status=ItemStatus.NEEDS_MANUAL), second)
        return replace(result, report=replace(result.report, items=items, score=None))

    browser.enter(student="s1")
    text = plain(browser.get(put(b"", grading=waits) + "?lang=en").text)
    assert "1 of the items wait for a person" in text
    assert "The others have earned 0 of 15 points so far." in text
    assert "well done" not in text


def test_a_missing_page_leads_home(browser: Browser) -> None:
    text = browser.get("/assignments/nothing?lang=en").text
    assert '<a class="button" href="/">To the assignments</a>' in text
    assert "/api/" not in text


@pytest.mark.parametrize(
    ("position", "left_s", "words"),
    [
        (0, None, "queued, yours is next"),
        (2, 3.0, "queued, 2 before yours, a few seconds to go"),
        (2, 41.0, "queued, 2 before yours, about 45 s to go"),
        (None, 200.0, "queued, about 4 min to go"),
    ],
)
def test_who_waits_is_told_how_long(position: int | None, left_s: float | None, words: str) -> None:
    told = progress(SubmissionState.QUEUED, position, left_s, "en", is_open=True)
    assert told["text"] == words


def test_staff_go_from_student_to_student(
    browser: Browser, put: Callable[..., str], tokens: dict[str, str]
) -> None:
    han, _, li = (put(one.encode(), student=one[:-1], course="ros") for one in ("han1", "li1", "li2"))
    put(b"mine", student="ta", course="ros")  # no student
    browser.enter(token=tokens["ta"])
    text = browser.get(han).text
    assert f'<a rel="next" href="{li}" accesskey="n"' in text
    assert 'rel="prev"' not in text
    text = browser.get(f"{li}?lang=en").text
    assert f'<a rel="prev" href="{han}" accesskey="p"' in text
    assert 'rel="next"' not in text
    assert '<span class="removed">-li1</span>' in text
    assert '<span class="of">+1 −1</span>' in text
    assert "Compare the two scores" in text
    browser.enter(token=tokens["li"])
    text = browser.get(li).text
    assert 'rel="prev"' not in text
    assert '<span class="course">' in text
    assert '<span class="added">+li2</span>' in text
    assert "/class/compare" not in text
