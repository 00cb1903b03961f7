"""The instructor's whole way through a course in a real headless Chromium, and what students of it see."""

import os
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import httpx
import pytest

from grader.catalog import default_root
from grader.contracts.regrade import Regrade
from grader.grading.examination.zipped import packed
from grader.use_cases.regrading import regrade_of
from tests.e2e.chromium import PHONE, Browser
from tests.e2e.school import ESSAY, School, school
from tests.fakes.postgres import PostgresServer

pytestmark = pytest.mark.browser

WORK = (
    ("20260101", "square", "wrong/one_radian.py"),
    ("20260101", "square", "solution.py"),
    ("20260102", "square", "wrong/last_side_short.py"),
    ("20260102", "square_input", "solution.py"),
    ("20260101", ESSAY, "solution.txt"),
    ("20260103", ESSAY, "solution.txt"),
)


@pytest.fixture(scope="module")
def course(
    programs: tuple[str, str], postgres_server: PostgresServer, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[School]:
    """On PostgreSQL: `test_browser` is on SQLite, and a browser cannot tell."""
    name = f"school_{os.getpid()}"
    with school(postgres_server.create(name), tmp_path_factory.mktemp("school"), WORK) as opened:
        yield opened
    postgres_server.drop(name)


@pytest.fixture(scope="module")
def address(course: School) -> str:
    return course.address


@pytest.fixture
def wang(browser: Browser, course: School) -> Browser:
    browser.signed_in("token", course.tokens["wang"])
    browser.open("/class?lang=en")
    return browser


def _still_running(*asked: Any) -> Regrade:
    return replace(regrade_of(*asked), waiting=1)


@pytest.mark.slow
def test_grading_again_shows_who_loses_and_is_applied(
    wang: Browser, course: School, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Matrix, cell, compare, then a re-grade after one tolerance was tightened."""
    assert [one.text.split()[0] for one in wang.all(".matrix tbody th")] == [
        "20260101", "20260102", "20260103", "20260104", "20260105",
    ]  # fmt: skip
    wang.click('.matrix td a[href="/class/students/20260101?assignment=square"]')
    wang.click('form[action="/class/compare"] button')
    assert "Two attempts compared" in wang.says()
    course.tighten()
    wang.click('.top a[href="/class"]')
    wang.click('.sections a[href="/class/regrades"]')
    wang.one("#assignment option[value=square]").click()
    wang.one("input[name=which][value=latest]").click()
    wang.click("form.order button")
    wang.until(lambda: wang.all("button[value=apply]"))  # the page shows progress until the trial is complete
    assert "0 gain 1 lose 1 stay as they are" in wang.says(".tiles")
    (line,) = wang.all("#changes ~ .scroll tbody tr")
    assert line.text.startswith("20260102")
    assert "Equal sides" in line.text
    wang.click("#changes ~ .scroll td a")
    assert "Two gradings compared" in wang.says("h1")
    assert "on trial" in wang.says()
    wang.driver.back()
    with monkeypatch.context() as patch:  # as if it were not complete yet
        patch.setattr("grader.service.web.regrading.regrade_of", _still_running)
        wang.driver.refresh()
        assert not wang.all("button[value=apply]")
        wang.type("#reason", "sides must be equal")
    wang.until(lambda: wang.one("[data-ready]").is_displayed())  # no reloading while a reason is written
    wang.click("[data-ready] a")
    wang.until(lambda: wang.one("#reason").get_attribute("value") == "sides must be equal")
    wang.click("button[value=apply]")
    assert "applied wang" in wang.says(".notice")
    wang.click("#changes ~ .scroll th a")
    wang.click('a[href$="/gradings"]')
    assert "wang: sides must be equal" in wang.says()
    assert len(wang.all("tbody tr")) == 2


@pytest.mark.slow
def test_the_gradebook_is_looked_at_and_downloaded(wang: Browser, course: School) -> None:
    wang.click('.sections a[href="/class/gradebook"]')
    assert "100" in wang.says(".matrix tbody tr")
    cookies = {one["name"]: one["value"] for one in wang.driver.get_cookies()}
    for link in wang.all("a[download]"):
        answer = httpx.get(link.get_attribute("href"), cookies=cookies, trust_env=False)
        assert answer.headers["content-type"].startswith(("text/csv", "application/vnd.openxml"))
        assert "李雷" in answer.text or answer.content.startswith(b"PK")


@pytest.mark.slow
def test_rules_are_edited_and_wrong_ones_are_told_at_their_field(wang: Browser) -> None:
    wang.click('.sections a[href="/class/rules"]')
    wang.click('a[href="/class/rules/square"]')
    assert not wang.one("#late-steps ~ *, .when-steps").is_displayed()
    wang.one("#late-steps").click()
    wang.one("input[name=step_after]").send_keys("24")
    wang.one("input[name=step_keep]").send_keys("150")
    wang.click("form.rules button")
    wrong = wang.one("input[name=step_after]")
    assert wrong.get_attribute("aria-invalid") == "true"
    assert wang.one("#steps-error").is_displayed()
    wang.type("input[name=step_keep]", "50")
    wang.click("form.rules button")
    assert "Saved." in wang.says(".done")
    wang.type("#x-student", "20260105")
    wang.type("#x-attempts", "2")
    wang.click("form[aria-labelledby=extend] button")
    assert "20260105 王小明" in wang.says("#extensions ~ .scroll")
    wang.open("/class/audit")
    assert "extension changed" in wang.says()


@pytest.mark.slow
def test_points_by_hand_reach_the_student(wang: Browser, course: School) -> None:
    wang.click('.sections a[href="/class/judgements"]')
    wang.click('a[href*="item=timer"][href^="?"]')
    wang.click("#answers ~ p a.button")
    assert "create_timer" in wang.says(".answer")
    wang.type("#points", "99")
    wang.click("form.points button[value=next]")
    assert wang.one("#points").get_attribute("aria-invalid") == "true"
    first = wang.path
    wang.type("#points", "40.5")
    wang.type("#comment", "Say also <who> calls it.")
    wang.click("form.points button[value=next]")
    assert wang.path not in {first, "/class/judgements"}
    wang.open(first + "?item=publisher")
    wang.type("#points", "45")
    wang.click("form.points button[value=stay]")
    wang.click(".facts a")
    assert "95.5" in wang.says("#score")
    student = wang.says(".crumbs").split()[-1]
    wang.signed_in("token", course.tokens[student])
    wang.open("/submissions")
    wang.click('tbody a[href="' + first.replace("/class/judgements", "/submissions") + '"]')
    assert "Say also <who> calls it." in wang.says()


@pytest.mark.slow
def test_every_run_of_several_is_replayed(browser: Browser, course: School) -> None:
    browser.signed_in("token", course.tokens["20260102"])
    browser.open("/submissions")
    browser.click("tbody tr:first-child a")
    tabs = browser.all(".tabs a")
    assert len(tabs) > 1
    ends = set()
    for number in range(len(tabs)):
        browser.click(f".tabs a:nth-child({number + 1})")
        browser.until(lambda: browser.all("#replay[data-ready]"))
        assert browser.all(".tabs a")[number].get_attribute("aria-current") == "true"
        ends.add(browser.one("[data-scrub]").get_attribute("max"))
    assert len(ends) > 1  # each its own motion


def test_assistants_find_no_way_to_change(browser: Browser, course: School) -> None:
    browser.signed_in("token", course.tokens["zhang"])
    for page in ("/class/regrades", "/class/rules/square"):
        browser.open(page)
        assert browser.all("main form button") == [], page
    assert not browser.all('.sections a[href="/class/audit"]')


@pytest.mark.parametrize("language", ["zh", pytest.param("en", marks=pytest.mark.slow)])
def test_a_phone_shows_everything(browser: Browser, course: School, language: str) -> None:
    browser.signed_in("token", course.tokens["wang"])
    browser.resize(PHONE)
    (regrade, *_) = course.services.regrades.all("ros2-2026") or [None]
    pages = [
        "/class", "/class/gradebook", "/class/judgements", "/class/regrades", "/class/rules",
        "/class/rules/square", "/class/people", "/class/audit", "/class/students/20260105",
        "/class/own", "/class/course",
    ]  # fmt: skip
    pages += [f"/class/regrades/{regrade.id}"] if regrade else []
    for page in pages:
        browser.open(f"{page}?lang={language}")
        assert browser.js("return document.documentElement.scrollWidth") <= PHONE[0], page


@pytest.mark.slow
def test_every_control_has_a_name(wang: Browser) -> None:
    for page in (
        "/class/regrades",
        "/class/rules/square",
        "/class/judgements",
        "/class/gradebook",
        "/class/own",
    ):
        wang.open(page)
        assert wang.nameless("a, button, input:not([type=hidden]), select, textarea, [role=group], nav") == []


@pytest.mark.slow
def test_an_uploaded_assignment_is_examined_and_tried(wang: Browser, tmp_path: Path) -> None:
    """First with a mistake in its file, then right: the worker runs its scripts, the staff see it."""
    folder = default_root() / "calculation"
    files = {str(one.relative_to(folder)): one.read_bytes() for one in folder.rglob("*") if one.is_file()}
    right = files["assignment.yaml"].replace(b"id: calculation", b"id: walk_time")
    zipped = tmp_path / "walk_time.zip"
    wang.click('.sections a[href="/class/own"]')
    for spec in (right.replace(b"points: 80", b"points: many"), right):
        zipped.write_bytes(packed("walk_time", {**files, "assignment.yaml": spec}))
        wang.one("#file").send_keys(str(zipped))
        wang.click("form[aria-labelledby=upload] button")
        if spec != right:
            assert "items.0.points" in wang.says("main table")
    wang.open_once("/class/own", "Can be used")
    assert "Can be used" in wang.says("main")
    wang.open_once("/assignments/walk_time", "Question: time for a square")
    assert "Question: time for a square" in wang.says("h1")
