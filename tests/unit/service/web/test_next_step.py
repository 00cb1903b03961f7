"""What a student is led to: the next exercise, the untouched starter."""

import re
from collections.abc import Callable
from dataclasses import replace

import pytest

from grader.contracts.grading import GradingJob, GradingResult
from grader.contracts.rubric import ItemStatus
from grader.contracts.upload import same_program
from grader.use_cases.services import Services
from tests.fakes.grading import grade
from tests.unit.service.web.conftest import Browser


def test_the_checklist_shows_how_far_one_is_and_what_comes_next(
    browser: Browser, put: Callable[..., str], tokens: dict[str, str], services: Services
) -> None:
    first, second = services.assignments.of("ros").all()[:2]
    browser.get("/?lang=en")
    browser.enter(token=tokens["li"])
    assert (
        f"0 of {len(services.assignments.of('ros').all())} exercises have full marks" in browser.get("/").text
    )
    assert f'href="/assignments/{first.id}">Next exercise' in browser.get("/").text
    full = put(b"good", student="li", course="ros", assignment=first.id, grading=_all_points)
    assert f'href="/assignments/{second.id}">Next exercise' in browser.get(full).text
    assert f'href="/assignments/{second.id}">Next exercise' in browser.get("/").text
    assert "1 of " in browser.get("/").text


def _all_points(job: GradingJob) -> GradingResult:
    result = grade(job)
    items = tuple(replace(one, earned=one.points, status=ItemStatus.PASSED) for one in result.report.items)
    most = sum(one.points for one in items)
    return replace(result, report=replace(result.report, items=items, score=most, max_score=most))


def test_pages_name_the_student_and_attempts_have_seconds(
    browser: Browser, put: Callable[..., str], tokens: dict[str, str], services: Services
) -> None:
    browser.enter(token=tokens["li"])
    member = services.courses.member("ros", "li")
    assert member is not None
    put(b"one", student="li", course="ros")
    text = browser.get("/submissions").text
    assert f'<span title="li">{member.name or "li"}</span>' in text
    assert re.search(r"<time>\d{4}-\d\d-\d\d \d\d:\d\d:\d\d</time>", text)


def test_the_untouched_starter_is_told_so(
    browser: Browser, put: Callable[..., str], tokens: dict[str, str]
) -> None:
    browser.get("/?lang=en")
    browser.enter(token=tokens["li"])
    starter = put(b"# my name\n\nimport rclpy  \n", student="li", course="ros")
    changed = put(b"import rclpy\nx = 1\n", student="li", course="ros")
    assert "This is the starter, as it was given" in browser.get(starter).text
    assert "This is the starter" not in browser.get(changed).text


@pytest.mark.parametrize(
    ("other", "is_same"),
    [
        (b"\xef\xbb\xbfif x:\r\n    y()  \r\n", True),
        (b"# a\nif x:\n\n    # b\n    y()\n", True),
        (b"if x:\n  y()\n", False),
        (b"if x:\n    y()  # done\n", False),
        (b"", False),
    ],
)
def test_only_blank_lines_and_comment_lines_make_no_difference(other: bytes, is_same: bool) -> None:
    assert same_program(b"if x:\n    y()\n", other) is is_same


def test_the_first_field_has_the_focus(browser: Browser, tokens: dict[str, str]) -> None:
    assert re.search(r'<input id="token"[^>]* autofocus', browser.get("/enter").text)
