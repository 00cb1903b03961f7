"""The course's page: a copy, the archive."""

from collections.abc import Callable
from datetime import timedelta

import httpx
import pytest

from grader.use_cases.services import Services
from tests.unit.service.web.conftest import Browser


@pytest.fixture
def teacher(client: httpx.Client, tokens: dict[str, str]) -> Browser:
    browser = Browser(client)
    browser.enter(token=tokens["wang"])
    return browser


def test_a_copy_opens_with_the_token_that_is_shown(
    teacher: Browser, services: Services, client: httpx.Client
) -> None:
    shown = teacher.post(
        "/class/course/copy", {"id": "ros-2027", "title": "Next", "move_days": "7"}, page="/class/course"
    )
    token = shown.text.partition('<pre class="code">')[2].partition("</pre>")[0]
    caller = services.callers.identify(token)
    assert caller is not None
    assert (caller.course, caller.person, caller.is_instructor) == ("ros-2027", "wang", True)
    refused = teacher.post("/class/course/copy", {"id": "ros-2027", "move_days": "7"}, page="/class/course")
    assert refused.status_code == 422
    assert "已经有课程 ros-2027" in refused.text


def test_title_and_time_zone_are_changed(teacher: Browser, services: Services) -> None:
    new = {"title": "机器人 入门", "time_zone": "Europe/Berlin"}
    done = teacher.post("/class/course/settings", new, page="/class/course")
    assert done.headers["Location"] == "/class/course?done=changed"
    course = services.courses.get("ros")
    assert (course.title, course.time_zone) == ("机器人 入门", "Europe/Berlin")
    shown = teacher.get("/class/course").text
    assert "机器人 入门" in shown
    assert "Europe/Berlin" in shown
    wrong = teacher.post("/class/course/settings", {**new, "time_zone": "Mars/Base"}, page="/class/course")
    assert (wrong.status_code, "本机没有时区" in wrong.text) == (422, True)
    assert services.courses.get("ros") == course


def test_every_page_says_that_the_course_is_archived(
    teacher: Browser, client: httpx.Client, tokens: dict[str, str]
) -> None:
    teacher.post("/class/course/archive", {"archived": "true", "reason": "x"}, page="/class/course")
    for path in ("/", "/class", "/class/course", "/class/gradebook", "/assignments/square"):
        assert "本课程已归档" in teacher.get(path).text, path
    refused = teacher.post("/class/people", {"person": "new", "role": "student"})
    assert (refused.status_code, "课程 ros 已归档" in refused.text) == (409, True)
    student = Browser(client)
    student.enter(token=tokens["li"])
    page = student.get("/assignments/square").text
    assert "课程已归档，只能查看" in page
    assert 'type="file"' not in page
    assert student.hand_in("square", b"good").status_code == 409
    teacher.enter(token=tokens["wang"])
    teacher.post("/class/course/archive", {"archived": "false"}, page="/class/course")
    assert "本课程已归档" not in teacher.get("/class").text


def test_what_is_old_is_shown_before_it_is_erased(
    teacher: Browser, put: Callable[..., str], services: Services
) -> None:
    put(student="li", course="ros")
    services.clock.advance(401 * 86_400)
    teacher.enter(token=services.tokens.issue("ros", "wang", timedelta(days=1), "test")[1])
    shown = teacher.get("/class/course?older_than=400").text
    assert "400 天以前的提交有 1 份" in shown
    assert "ROS" in teacher.get("/class/service").text
    assert "占用的空间" in teacher.get("/class/service").text
    gone = teacher.post("/class/course/erase", {"older_than": "400"}, page="/class/course?older_than=400")
    assert gone.headers["Location"] == "/class/course?done=erased"
    assert services.submissions.of_student("li", course="ros") == ()


def test_a_student_is_forgotten_whose_id_was_typed_twice(
    teacher: Browser, put: Callable[..., str], services: Services
) -> None:
    put(student="li", course="ros")
    page = "/class/course"
    refused = teacher.post("/class/course/forget", {"person": "li", "again": "han"}, page=page)
    assert (refused.status_code, "两次输入不一样" in refused.text) == (422, True)
    refused = teacher.post("/class/course/forget", {"person": "ta", "again": "ta"}, page=page)
    assert (refused.status_code, "只能删除学生的数据" in refused.text) == (409, True)
    done = teacher.post("/class/course/forget", {"person": "li", "again": "li"}, page=page)
    assert done.headers["Location"] == "/class/course?done=forgotten"
    assert services.courses.member("ros", "li") is None
    assert "删除学生数据" in teacher.get("/class/audit").text
