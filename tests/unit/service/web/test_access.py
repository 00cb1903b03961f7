"""Who sees which page, and what a form needs to be believed."""

from collections.abc import Callable

import httpx
import pytest
from fastapi import Request, Response

from grader.contracts.identity import Caller, Role
from grader.contracts.rules import Rules
from grader.service.requests.dependencies import SESSION_COOKIE
from grader.service.web.entrance import own_address
from grader.service.web.forms import COOKIE, set_private_cookie
from grader.store.audit import Signature
from grader.store.tokens import MOST_SESSIONS
from grader.use_cases.services import Services
from tests.fakes import server
from tests.fakes.places import all_taken
from tests.unit.service.web.conftest import PAGE, Browser

CLASS_PAGES = (
    "/class",
    "/class/assignments/square",
    "/class/students/s1",
    "/class/service",
    "/class/compare",
)
LI = Caller(course="ros", person="li", role=Role.STUDENT)
OWN_DATA = ("", "/state.json", "/trajectory.json", "/sketch.json", "/plot.png", "/recording.mcap")


@pytest.mark.parametrize("path", [*CLASS_PAGES, "/submissions", "/submissions/nothing"])
def test_personal_pages_ask_who_it_is(browser: Browser, path: str) -> None:
    answer = browser.get(path)
    assert answer.status_code == 303
    assert answer.headers["Location"].startswith("/enter?next=%2F")


@pytest.mark.parametrize("path", CLASS_PAGES)
def test_a_student_id_does_not_open_the_class(browser: Browser, path: str) -> None:
    browser.enter(student="s1")
    assert browser.get(path).status_code == 303


@pytest.mark.parametrize("part", OWN_DATA)
def test_a_submission_is_its_owners_and_the_instructors(
    browser: Browser, put: Callable[..., str], part: str
) -> None:
    address = put(student="s1") + part
    assert browser.get(address).status_code == 303
    browser.enter(student="s2")
    assert browser.get(address).status_code == 404
    browser.enter(student="s1")
    assert browser.get(address).status_code == 200
    browser.post("/leave", {}, page="/")
    assert browser.get(address).status_code == 303
    browser.enter(token=server.TOKEN)
    assert browser.get(address).status_code == 200


def test_entering_leads_back(browser: Browser) -> None:
    asked = browser.get("/class?show=stuck").headers["Location"]
    answer = browser.post("/enter", {"token": server.TOKEN, "next": "/class?show=stuck"}, page=asked)
    assert answer.headers["Location"] == "/class?show=stuck"


def test_a_link_on_another_site_leads_on_once_before_anybody_is_asked(browser: Browser) -> None:
    """Such a link brings no session along; what the page leads to does."""
    browser.enter(token=server.TOKEN)
    session = {name: browser.client.cookies.pop(name) for name in list(browser.client.cookies)}
    elsewhere = {**PAGE, "Sec-Fetch-Site": "cross-site"}
    asked = browser.client.get("/class?show=stuck", headers=elsewhere, follow_redirects=False)
    passing = browser.client.get(asked.headers["Location"], headers=elsewhere)
    assert 'http-equiv="refresh" content="0;url=/class?show=stuck"' in passing.text
    assert 'name="token"' not in passing.text
    browser.client.cookies.update(session)
    assert browser.get("/class?show=stuck").status_code == 200
    browser.client.cookies.clear()
    own = {**PAGE, "Sec-Fetch-Site": "same-origin"}
    assert 'name="token"' in browser.client.get(asked.headers["Location"], headers=own).text


@pytest.mark.parametrize("address", ["https://evil.example/", "//evil.example", ""])
def test_a_link_on_another_site_leads_to_our_pages_only(browser: Browser, address: str) -> None:
    elsewhere = {**PAGE, "Sec-Fetch-Site": "cross-site"}
    shown = browser.client.get("/enter", params={"next": address}, headers=elsewhere).text
    assert "refresh" not in shown
    assert 'name="token"' in shown


@pytest.mark.parametrize(
    "address",
    [
        "//evil.example",
        "https://evil.example",
        "/\\evil.example",
        "javascript:alert(1)",
        "/a\nb",
        "/\u202e",
        "class",
    ],
)
def test_entering_leads_nowhere_else(browser: Browser, address: str) -> None:
    assert own_address(address) == ""
    answer = browser.post("/enter", {"student": "s1", "next": address}, page="/enter")
    assert answer.headers["Location"] == "/submissions"


def test_a_wrong_token_opens_nothing(browser: Browser) -> None:
    answer = browser.enter(token="x" * 30)
    assert answer.status_code == 403
    assert "grader_session" not in answer.headers.get("set-cookie", "")
    assert browser.get("/class").status_code == 303


def test_private_cookies_stay_private(browser: Browser) -> None:
    cookies = [
        *browser.enter(token=server.TOKEN).headers.get_list("set-cookie"),
        *browser.enter(student="s1").headers.get_list("set-cookie"),
    ]
    assert {one.split("=")[0] for one in cookies} == {"grader_session", "grader_student"}
    for one in cookies:
        assert "HttpOnly" in one
        assert "SameSite=strict" in one
        assert "Max-Age" not in one


@pytest.mark.parametrize(("scheme", "secure"), [("http", False), ("https", True)])
def test_cookies_are_secure_over_https(scheme: str, secure: bool) -> None:
    response = Response()
    request = Request(
        {"type": "http", "scheme": scheme, "server": ("grader", 80), "headers": [], "path": "/"}
    )
    set_private_cookie(request, response, "name", "value")
    assert ("Secure" in response.headers["set-cookie"]) is secure


@pytest.mark.parametrize("path", ["/enter", "/leave", "/assignments/square"])
@pytest.mark.parametrize("token", [None, "", "x" * 32, "\u4e2d"])
def test_foreign_forms_are_refused(
    browser: Browser, services: Services, path: str, token: str | None
) -> None:
    browser.get("/enter")  # the browser has its token; the form does not
    data = {"student": "s1", **({} if token is None else {"form_token": token})}
    files = {"file": ("a.py", b"good")} if "assign" in path else None
    answer = browser.client.post(path, data=data, files=files, headers=PAGE, follow_redirects=False)
    assert answer.status_code == 403
    assert services.submissions.of_student("s1") == ()


def test_a_form_without_the_cookie_is_refused(client: httpx.Client) -> None:
    token = "x" * 32
    answer = client.post("/enter", data={"student": "s1", "form_token": token}, headers=PAGE)
    assert answer.status_code == 403


@pytest.mark.parametrize(("site", "status"), [("cross-site", 403), ("same-site", 403), ("same-origin", 303)])
def test_the_browser_is_believed_about_foreign_forms(browser: Browser, site: str, status: int) -> None:
    browser.get("/enter")
    data = {"student": "s1", "form_token": browser.client.cookies[COOKIE]}
    headers = {**PAGE, "Sec-Fetch-Site": site}
    answer = browser.client.post("/enter", data=data, headers=headers, follow_redirects=False)
    assert answer.status_code == status


class TestCourse:
    """With a course everybody shows a token."""

    def test_a_student_id_is_not_enough(self, browser: Browser, tokens: dict[str, str]) -> None:
        assert 'name="student"' not in browser.get("/enter").text
        browser.get("/enter")
        answer = browser.enter(student="li")
        assert answer.status_code == 303
        assert "grader_student" not in answer.headers.get("set-cookie", "")
        assert browser.get("/submissions").status_code == 303

    def test_handing_in_needs_a_token(
        self, browser: Browser, services: Services, tokens: dict[str, str]
    ) -> None:
        assert 'type="file"' not in browser.get("/assignments/square").text
        assert browser.hand_in("square", b"good", student="li").status_code in {303, 403}
        assert services.submissions.of_student("li", course="ros") == ()
        assert services.submissions.of_student("li") == ()
        browser.enter(token=tokens["li"])
        assert browser.hand_in("square", b"good").headers["Location"].startswith("/submissions/")
        assert len(services.submissions.of_student("li", course="ros")) == 1

    def test_students_see_their_own_work_only(
        self, browser: Browser, tokens: dict[str, str], put: Callable[..., str]
    ) -> None:
        own, other = put(student="li", course="ros"), put(student="han", course="ros")
        browser.enter(token=tokens["li"])
        assert browser.get(own).status_code == 200
        assert browser.get(other).status_code == 404
        assert browser.get("/class").status_code == 403

    @pytest.mark.parametrize("person", ["ta", "wang"])
    def test_staff_see_the_class(
        self, browser: Browser, tokens: dict[str, str], put: Callable[..., str], person: str
    ) -> None:
        put(student="li", course="ros")
        assert browser.enter(token=tokens[person]).headers["Location"] == "/class"
        assert 'href="/class/students/li' in browser.get("/class").text
        assert browser.get("/class/students/li").status_code == 200

    def test_another_courses_work_does_not_exist(
        self, browser: Browser, tokens: dict[str, str], put: Callable[..., str]
    ) -> None:
        foreign = put(student="li", course=None)
        browser.enter(token=tokens["wang"])
        assert browser.get(foreign).status_code == 404
        own = browser.get("/class/students/li?lang=en").text
        assert "Nothing handed in yet" in own
        assert foreign not in own
        assert browser.get("/class/students/nobody").status_code == 404

    def test_hidden_items_stay_hidden(
        self, browser: Browser, services: Services, tokens: dict[str, str], put: Callable[..., str]
    ) -> None:
        hiding = Rules(hidden_items=("closed",), attempts=5)
        services.rules.set("square", hiding, Signature(services.clock(), "ros", "wang"), "")
        own = put(student="li", course="ros")
        browser.enter(token=tokens["li"])
        for path in ("/assignments/square", own, own + "/sketch.json", "/submissions"):
            text = browser.get(path).text
            assert "回到起点</h3>" not in text, path
            assert '"ok":false' not in text, path
        assert "还可提交 4 次" in browser.get("/assignments/square").text
        browser.enter(token=tokens["wang"])
        assert "回到起点</h3>" in browser.get(own).text


def test_a_members_pages_are_limited_as_their_requests_are(
    browser: Browser, services: Services, tokens: dict[str, str]
) -> None:
    browser.enter(token=tokens["li"])
    sent = browser.get("/assignments/square")
    assert sent.status_code == 200
    for _ in range(services.settings.requests_per_minute - 2):  # entering was one, the page another
        services.allowances.requests.take("ros/li")
    for answer in (browser.get("/assignments/square"), browser.hand_in("square", b"good")):
        assert (answer.status_code, "请求太频繁" in answer.text) == (429, True)
        assert int(answer.headers["Retry-After"]) >= 1


def test_a_members_pages_are_made_one_after_the_other(
    browser: Browser, services: Services, tokens: dict[str, str], put: Callable[..., str]
) -> None:
    own = put(student="li", course="ros")
    browser.enter(token=tokens["li"])
    costly, places = services.allowances.costly, services.allowances.requests_at_once
    with all_taken(services.settings.costly_at_once, lambda: costly.one_more(LI, "")):
        for path in (own, f"{own}/plot.png", f"{own}/sketch.json", f"{own}/trajectory.json", "/submissions"):
            assert browser.get(path).status_code == 429, path
        assert browser.get(f"{own}/state.json").status_code == 200
    with all_taken(services.settings.requests_at_once, lambda: places.one_more("ros/li")):
        answer = browser.get("/submissions")
        assert (answer.status_code, "同时发出的请求太多" in answer.text) == (429, True)
    assert browser.get(own).status_code == 200


def test_a_browser_keeps_no_token_but_a_session_that_ends(
    browser: Browser, services: Services, tokens: dict[str, str]
) -> None:
    def opens(session: str) -> bool:
        browser.client.cookies.clear()
        browser.client.cookies.set("grader_session", session)
        return browser.get("/submissions").status_code == 200

    def session() -> str:
        browser.client.cookies.clear()
        browser.enter(token=tokens["li"])
        return browser.client.cookies["grader_session"]

    kept = session()
    assert kept != tokens["li"]
    assert services.callers.identify(kept) is None  # it is no token for the interface
    assert opens(kept)
    assert not opens(tokens["li"])  # and a token is no session
    assert [one.person for one in services.tokens.of_course("ros")].count("li") == 1
    assert opens(kept)
    browser.post("/leave", {}, page="/submissions")
    assert not opens(kept)
    kept = session()
    services.clock.advance(12 * 3_600)
    assert not opens(kept)
    services.courses.change(Signature(services.clock(), "ros", "wang"), session_hours=2)
    kept = session()
    services.clock.advance(3_600)
    assert opens(kept)
    services.clock.advance(3_600)
    assert not opens(kept)
    kept = session()
    (own,) = (one.id for one in services.tokens.of_course("ros") if one.person == "li")
    assert services.tokens.revoke("ros", "wang", token_id=own) == 1
    assert not opens(kept)


def test_who_enters_again_and_again_ends_the_oldest_session_and_is_told_to_wait(
    services: Services, tokens: dict[str, str]
) -> None:
    opened = []
    for _ in range(MOST_SESSIONS + 1):
        services.clock.advance(1)
        opened.append(services.callers.open_session(tokens["li"]))
    assert [services.callers.of_session(one) is not None for one in opened] == [False] + [
        True
    ] * MOST_SESSIONS


def test_entering_counts_as_a_request(browser: Browser, services: Services, tokens: dict[str, str]) -> None:
    for _ in range(services.settings.requests_per_minute):
        services.allowances.requests.take("ros/li")
    assert browser.enter(token=tokens["li"]).status_code == 429
    assert SESSION_COOKIE not in browser.client.cookies
    assert browser.enter(token=tokens["han"]).status_code == 303


@pytest.mark.parametrize("path", ["/", "/class", "/healthz", "/no-such-page", "/static/style.css"])
def test_head_tells_what_get_would(browser: Browser, path: str) -> None:
    told, page = browser.client.head(path), browser.client.get(path)
    assert (told.status_code, told.content) == (page.status_code, b"")
    assert told.headers["Content-Length"] == page.headers["Content-Length"]
