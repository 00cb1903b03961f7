"""Which assignments a course has, and one form for several of them."""

from datetime import UTC, datetime, timedelta

import httpx
import pytest

from grader.contracts.identity import RosterEntry
from grader.contracts.rules import LateRule, Rules, Shown
from grader.store.audit import Signature
from grader.use_cases.services import Services
from tests.unit.service.web.conftest import Browser

DUE = datetime(2026, 3, 20, 15, 59, tzinfo=UTC)  # 23:59 in Shanghai


@pytest.fixture
def wang(client: httpx.Client, tokens: dict[str, str]) -> Browser:
    browser = Browser(client)
    browser.enter(token=tokens["wang"])
    return browser


@pytest.fixture
def li(running, services: Services, client: httpx.Client, tokens: dict[str, str]):
    with httpx.Client(base_url=client.base_url, timeout=30.0, trust_env=False) as other:
        browser = Browser(other)
        browser.enter(token=tokens["li"])
        yield browser


def test_students_see_what_the_course_shows(wang: Browser, li: Browser, services: Services) -> None:
    opens = services.clock() + timedelta(hours=1)
    signed = Signature(services.clock(), "ros", "wang")
    services.rules.set("square", Rules(shown=Shown.DRAFT), signed)
    services.rules.set("spin", Rules(shown=Shown.WHEN_OPEN, opens=opens), signed)
    home = li.get("/").text
    for hidden in ("square", "spin"):
        assert f'/assignments/{hidden}"' not in home
        assert li.get(f"/assignments/{hidden}").status_code == 404
        assert li.hand_in(hidden, b"x = 1\n").status_code == 404
        assert f'/assignments/{hidden}"' in wang.get("/").text
    assert '/class/rules/square"' not in wang.get("/class/gradebook").text
    assert '/class/rules/spin"' in wang.get("/class/gradebook").text
    services.clock.advance(3600.0)
    assert '/assignments/spin"' in li.get("/").text
    assert li.hand_in("spin", b"x = 1\n").status_code == 303


def test_the_release_of_the_course_is_chosen_and_shown(wang: Browser, li: Browser) -> None:
    assert "ROS 2 Jazzy" not in li.get("/assignments/square").text
    assert wang.post("/class/course", {"distro": "jazzy"}).headers["Location"] == "/class/rules?saved=1"
    assert "ROS 2 Jazzy" in li.get("/assignments/square").text
    assert '<option value="jazzy" selected>' in wang.get("/class/rules").text
    assert "ROS 2 版本" in wang.get("/class/audit").text
    assert "ros2 run" not in li.get("/assignments/square").text
    assert wang.post("/class/course", {"distro": "jazzy", "runs_as": "ros2_run"}).status_code == 303
    assert "ros2 run" in li.get("/assignments/square").text
    assert '<option value="ros2_run" selected>' in wang.get("/class/rules").text


def test_one_form_sets_dates_of_several_assignments(wang: Browser, services: Services) -> None:
    before = services.rules.of("ros").of("square")
    chosen = {
        "assignment": ["square", "spin"],
        "action": "rules",
        "due": "2026-03-20T23:59",
        "reason": "week 3",
    }
    assert wang.post("/class/rules", chosen).headers["Location"] == "/class/rules?saved=1"
    wang.post("/class/rules", {"assignment": ["spin"], "action": "rules", "shown": "draft"})
    rules = services.rules.of("ros")
    assert rules.of("square") == Rules(due=DUE)
    assert rules.of("spin") == Rules(due=DUE, shown=Shown.DRAFT)
    assert rules.of("straight") == before == Rules()


def test_one_form_sets_lateness_and_attempts_of_all_assignments(wang: Browser, services: Services) -> None:
    chosen = {
        "every": "true", "action": "rules", "late": "linear", "per_day": "10", "accept_late": "48",
        "attempts": "8", "attempts_per_day": "3",
    }  # fmt: skip
    assert wang.post("/class/rules", chosen).status_code == 303
    late = LateRule(kind="linear", per_day=0.1)
    everywhere = Rules(late=late, accept_late_s=172_800, attempts=8, attempts_per_day=3)
    rules = services.rules.of("ros")
    assert {one.id: rules.of(one.id) for one in services.assignments.of("ros").all()} == {
        one.id: everywhere for one in services.assignments.of("ros").all()
    }
    wang.post("/class/rules", {"assignment": ["spin"], "action": "rules", "late": "none", "attempts": "9"})
    after = services.rules.of("ros")
    assert after.of("spin") == Rules(accept_late_s=172_800, attempts=9, attempts_per_day=3)
    assert after.of("square") == everywhere
    for wrong in ({"late": "linear"}, {"late": "linear", "per_day": "0"}, {"attempts": "0"}):
        refused = wang.post("/class/rules", {"assignment": ["spin"], "action": "rules", **wrong})
        assert refused.status_code == 422, wrong
        assert refused.text.count('aria-invalid="true"') == 1, wrong
    assert services.rules.of("ros") == after


def test_what_comes_after_the_first_upload_is_a_draft(wang: Browser, li: Browser, services: Services) -> None:
    every = {one.id for one in services.assignments.of("ros").all()}
    assert services.rules.of("ros").begun_with is None
    assert wang.hand_in("square", b"x = 1\n").status_code == 303  # staff may try before
    assert services.rules.of("ros").begun_with is None
    services.courses.begin("ros", every - {"spin"})  # as if spin had not been there yet
    assert li.hand_in("square", b"x = 1\n").status_code == 303
    assert services.rules.of("ros").begun_with == every - {"spin"}
    assert li.get("/assignments/spin").status_code == 404
    assert services.rules.of("ros").of("spin") == Rules(shown=Shown.DRAFT)
    assert wang.get("/assignments/spin").status_code == 200
    wang.post("/class/rules", {"assignment": ["spin"], "action": "rules", "shown": "always"})
    assert li.get("/assignments/spin").status_code == 200


def test_a_course_begins_with_a_students_first_upload(li: Browser, services: Services) -> None:
    every = {one.id for one in services.assignments.of("ros").all()}
    assert li.hand_in("square", b"x = 1\n").status_code == 303
    assert services.rules.of("ros").begun_with == every


def test_one_form_extends_for_several_people_and_sections(wang: Browser, services: Services) -> None:
    people = [RosterEntry(id=one, name="", sections=("A",)) for one in ("zhou", "zhu")]
    services.courses.import_roster("ros", people, "test")
    wang.post(
        "/class/rules", {"assignment": ["square", "spin"], "action": "rules", "due": "2026-03-01T00:00"}
    )
    more = {"assignment": ["square", "spin"], "action": "extensions", "students": "li", "section": "A"}
    assert wang.post("/class/rules", {**more, "new_due": "2026-03-20T23:59"}).status_code == 303
    wang.post("/class/rules", {**more, "section": "", "extra_attempts": "2"})
    rules = services.rules.of("ros")
    for assignment in ("square", "spin"):
        extended = rules.extended(assignment)
        assert [(one, more.due, more.extra_attempts) for one, more in extended] == [
            ("li", DUE, 2),
            ("zhou", DUE, 0),
            ("zhu", DUE, 0),
        ]


@pytest.mark.parametrize(
    ("typed", "told"),
    [
        ({"due": "2026-03-20T23:59"}, "先在表里勾选作业"),
        ({"assignment": "square", "due": "soon"}, "form.wrong"),
        ({"assignment": "square", "shown": "when_open"}, "先填开放时间"),
        (
            {"assignment": "square", "action": "extensions", "students": "li nobody", "extra_attempts": "1"},
            "不是本课程",
        ),
        ({"assignment": "square", "action": "extensions", "extra_attempts": "1"}, "写学号，或勾选班级"),
        ({"assignment": "square", "action": "extensions", "students": "li"}, "写新的截止时间"),
    ],
)
def test_what_is_wrong_changes_nothing(
    wang: Browser, services: Services, typed: dict[str, str], told: str
) -> None:
    answer = wang.post("/class/rules", typed)
    assert answer.status_code == 422
    if told != "form.wrong":
        assert told in answer.text
    rules = services.rules.of("ros")
    assert (rules.by_assignment, rules.extensions) == ({}, {})
