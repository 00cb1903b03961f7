"""Both ways through the pages in a real headless Chromium, against the real service.

Skipped, and said so in the summary, where Chromium or its driver is missing; where GRADER_REQUIRE_BROWSER is set
(in CI) that is a failure.
"""

from collections.abc import Iterator
from itertools import combinations
from pathlib import Path

import httpx
import pytest

from grader.catalog import Catalog
from grader.commands.demo import DemoUpload, await_grades, hand_in, serving
from grader.render.terminal import console
from tests.e2e.axe import assert_sound
from tests.e2e.chromium import PHONE, Browser

pytestmark = pytest.mark.browser

HOME, ARROW_RIGHT = "\ue011", "\ue014"  # as WebDriver spells these keys
MOTION = {"name": "prefers-reduced-motion", "value": "no-preference"}
CLOCK = """
let now = 0, step = null;
performance.now = () => now;
window.requestAnimationFrame = (next) => { step = next; };
window.pass = (ms) => { const next = step; step = null; now += ms; next?.(now); };
"""  # gives a page a clock that only the test moves
HOSTILE = """
import rclpy
from rclpy.node import Node

EVIL = "</pre><img src=x onerror='window.pwned=1'><script>window.pwned=1</script>\\u202e\\x1b[31m"
rclpy.init()
node = Node("evil")
node.get_logger().info(EVIL)
print(EVIL)
raise RuntimeError(EVIL)
"""


@pytest.fixture(scope="module")
def service(programs: tuple[str, str], tmp_path_factory: pytest.TempPathFactory) -> Iterator[httpx.Client]:
    """The real service with a small class in it."""
    squares = Catalog().scripts("square")
    with serving(tmp_path_factory.mktemp("service")) as client:
        uploads = [
            DemoUpload("ada", "square", "solution.py", squares["solution.py"]),
            DemoUpload("bo", "square", "one_radian.py", squares["wrong/one_radian.py"]),
            DemoUpload("bo", "square", "five_sides.py", squares["wrong/five_sides.py"]),
            DemoUpload("chen", "spin", "one_radian.py", Catalog().scripts("spin")["wrong/one_radian.py"]),
        ]
        await_grades(client, [hand_in(client, upload) for upload in uploads], console())
        yield client


@pytest.fixture(scope="module")
def address(service: httpx.Client) -> str:
    return str(service.base_url)


@pytest.fixture
def token(service: httpx.Client) -> str:
    return service.headers["Authorization"].removeprefix("Bearer ")


def test_the_students_way(browser: Browser, tmp_path: Path) -> None:
    script = tmp_path / "one_radian.py"
    script.write_bytes(Catalog().scripts("square")["wrong/one_radian.py"])
    browser.open("/")
    browser.click('a[href="/assignments/square"]')
    browser.type("#student", "20260123")
    browser.one("#file").send_keys(str(script))
    assert "one_radian.py" in browser.one("#chosen").text
    browser.one("#upload button").click()
    browser.until(lambda: browser.all("#score"))
    assert browser.one("#score .big").text == "40"
    assert "下一步" in browser.one(".score .next").text
    statuses = [one.text for one in browser.all(".item .mark")]
    assert "✗ 未过" in statuses
    assert "✓ 通过" in statuses
    browser.click('a[hreflang="en"]')
    assert browser.js("return document.documentElement.lang") == "en"
    browser.click('.top a[href="/submissions"]')
    assert browser.one("h1").text == "My attempts"
    assert "one_radian.py" in browser.one("main").text


def apart(boxes: list[dict[str, float]]) -> bool:
    """Whether there are several and none covers a part of another one."""
    return len(boxes) > 1 and not any(
        one["left"] < other["right"]
        and other["left"] < one["right"]
        and one["top"] < other["bottom"]
        and other["top"] < one["bottom"]
        for one, other in combinations(boxes, 2)
    )


def test_the_replay(browser: Browser) -> None:
    browser.enter("student", "bo")
    browser.all("tbody a")[-1].click()  # the earliest attempt
    browser.until(lambda: browser.all("#replay[data-ready]"))
    shown = lambda: float(browser.one("[data-readout] dd").text.split()[0])  # noqa: E731
    place = lambda: browser.one(".car").get_attribute("transform")  # noqa: E731
    end, finish = shown(), place()
    assert end > 10.0
    assert len(browser.all("[data-graphs] svg")) == 2
    assert "✗ 57.8°" in browser.one("[data-plan]").text
    assert apart(
        browser.js(
            "return [...document.querySelectorAll('.remark')].map((one) => one.getBoundingClientRect().toJSON())"
        )
    )
    moments = browser.all(".log button")
    moments[1].click()
    assert shown() == pytest.approx(float(moments[1].text.split()[0]), abs=0.01)
    assert browser.one(".log [aria-current]").text == moments[1].text
    assert browser.all(".remark.later")  # of sides that are not finished yet
    browser.one("[data-scrub]").send_keys(HOME)
    assert shown() == 0.0
    assert place() != finish
    start = place()
    browser.one("[data-scrub]").send_keys(ARROW_RIGHT)
    assert 0.0 < shown() < end
    browser.js(CLOCK)
    browser.one("[data-speed] option[value='8']").click()
    browser.one("[data-play]").click()
    assert browser.one("[data-play]").text == "暂停"
    for _ in range(2):
        browser.js("pass(100)")
    stopped = shown()
    assert 1.6 <= stopped < 2.0
    assert place() != start
    browser.one("[data-play]").click()
    browser.js("pass(100)")
    assert browser.one("[data-play]").text == "播放"
    assert shown() == stopped
    browser.one("[data-play]").click()
    browser.js("pass(60_000)")
    assert shown() == end
    assert browser.one("[data-play]").text == "播放"
    cursor = float(browser.one("[data-graphs] .cursor").get_attribute("x1"))
    browser.one("[data-scrub]").send_keys(HOME)
    assert float(browser.one("[data-graphs] .cursor").get_attribute("x1")) < cursor
    assert not browser.one("[data-overlaid]").is_displayed()
    browser.one("[data-other] option:not([value=''])").click()
    browser.until(lambda: browser.all("[data-plan] path.other"))
    assert browser.one("[data-overlaid]").is_displayed()


@pytest.mark.slow
def test_the_replay_plays_by_itself(browser: Browser) -> None:
    browser.enter("student", "bo")
    browser.command("Emulation.setEmulatedMedia", features=[MOTION])
    browser.click("tbody a")
    browser.until(lambda: browser.one("[data-play]").text == "暂停")
    browser.one("[data-scrub]").send_keys(HOME)
    assert browser.one("[data-play]").text == "播放"  # who does something is left alone
    browser.command("Emulation.setEmulatedMedia", features=[])


def test_a_file_is_dropped(browser: Browser) -> None:
    browser.open("/assignments/hello")
    assert browser.one(".drop-hint").is_displayed()
    drop = """
        const carried = new DataTransfer();
        carried.items.add(new File([arguments[0] ?? "x = 1"], "<b>dropped.py"));
        for (const kind of ["dragover", "drop"]) {
          document.getElementById("drop").dispatchEvent(
            new DragEvent(kind, { dataTransfer: carried, bubbles: true, cancelable: true }));
        }"""
    browser.js(drop)
    assert browser.js("return document.getElementById('file').files[0].name") == "<b>dropped.py"
    assert "<b>dropped.py" in browser.one("#chosen").text
    browser.driver.execute_script(drop, "x" * 300_000)
    assert "256 KiB" in browser.one("#chosen").text
    assert browser.js("return document.getElementById('upload').checkValidity()") is False


@pytest.fixture
def scriptless(browser: Browser) -> Iterator[Browser]:
    """The window while it runs no scripts."""
    browser.command("Emulation.setScriptExecutionDisabled", value=True)
    yield browser
    browser.command("Emulation.setScriptExecutionDisabled", value=False)


@pytest.mark.slow
def test_everything_without_scripts(scriptless: Browser) -> None:
    browser = scriptless
    browser.open("/assignments/square")
    browser.type("#student", "noscript")
    browser.one("#file").send_keys(str(Catalog().folder("square") / "solution.py"))
    browser.one("#upload button").click()
    browser.until(lambda: browser.all("#score"))
    assert browser.one("#score .big").text == "100"
    browser.until(lambda: int(browser.one("#replay img").get_attribute("naturalWidth")) > 100)
    assert browser.one("#replay img").is_displayed()


def test_hostile_output_stays_text(browser: Browser, tmp_path: Path) -> None:
    script = tmp_path / "<img src=x onerror=alert(1)>.py"
    script.write_text(HOSTILE)
    browser.signed_in("student", "mallory")
    browser.hand_in("hello", script)
    assert browser.js("return window.pwned") is None
    assert not browser.all("main img[src=x]")
    text = browser.one("main").get_property("textContent")
    assert "<script>window.pwned=1</script>" in text
    assert "\\u202e\\x1b[31m" in text
    assert "<img src=x onerror=alert(1)>.py" in text


@pytest.mark.slow
def test_the_instructors_way(browser: Browser, token: str) -> None:
    browser.enter("token", token)
    assert browser.path == "/class"
    browser.type("#search", "bo")
    browser.click(".filter button")
    assert [one.text for one in browser.all("tbody th")] == ["bo"]
    browser.click('.matrix td a[href*="assignment=square"]')
    assert browser.path == "/class/students/bo"
    browser.click('form[action="/class/compare"] button')
    assert browser.path == "/class/compare"
    assert "+25" in browser.one(".pairs").text
    assert browser.all(".diff .added")
    browser.until(lambda: all(int(one.get_attribute("naturalWidth")) > 100 for one in browser.all(".plot")))
    browser.open("/class/assignments/square")
    assert "转角" in browser.one("#failed").find_element("xpath", "..").text
    browser.open("/class/service")
    assert "就绪" in browser.one("main").text
    browser.click(".who button")
    assert browser.path == "/"
    browser.open("/class")
    assert browser.path == "/enter"


def test_the_keyboard_is_enough(browser: Browser) -> None:
    from selenium.webdriver.common.action_chains import ActionChains
    from selenium.webdriver.common.keys import Keys

    def press(key: str) -> str:
        """Press a key and say where the focus is then."""
        ActionChains(browser.driver).send_keys(key).perform()
        return browser.js(
            "const { id, className, type } = document.activeElement; return id || className || type"
        )

    browser.open("/assignments/square")
    assert press(Keys.TAB) == "skip"
    assert press(Keys.ENTER) == "main"
    press(Keys.TAB)  # the way back to the list
    assert [press(Keys.TAB) for _ in range(3)] == ["student", "file", "submit"]


@pytest.mark.parametrize("language", ["zh", pytest.param("en", marks=pytest.mark.slow)])
def test_a_phone_shows_everything(browser: Browser, token: str, service: httpx.Client, language: str) -> None:
    best = service.get("/api/v1/dashboard").json()["students"][1]["assignments"]["square"]
    result = best["latest_submission"].removeprefix("/api/v1")
    browser.signed_in("token", token)
    browser.resize(PHONE)
    pages = (
        "/", "/assignments/square", result, "/class", "/class/students/bo", "/class/assignments/square",
        "/class/service",
    )  # fmt: skip
    for page in pages:
        browser.open(f"{page}?lang={language}")
        browser.until(lambda: not browser.all("#replay:not([data-ready])"))
        assert browser.js("return document.documentElement.scrollWidth") <= PHONE[0], page
    browser.signed_in("student", "bo")  # whose attempts show their scores without scrolling
    browser.open(f"/submissions?lang={language}")
    assert browser.js(
        "const one = document.querySelector('.scroll'); return one.scrollWidth <= one.clientWidth"
    )


def test_nothing_serious_on_what_is_seen_most(browser: Browser, service: httpx.Client, axe: str) -> None:
    """Every page of a course: `test_accessible_pages`."""
    students = {one["student"]: one for one in service.get("/api/v1/dashboard").json()["students"]}
    of_bo = students["bo"]["assignments"]["square"]
    browser.signed_in("student", "bo")
    assert_sound(browser, axe, ("/assignments/square", of_bo["latest_submission"].removeprefix("/api/v1")))


@pytest.mark.slow
def test_every_control_has_a_name(browser: Browser, token: str) -> None:
    browser.signed_in("token", token)
    for page in ("/class", "/class/students/bo", "/assignments/square", "/enter"):
        browser.open(page)
        assert (
            browser.nameless("a, button, input:not([type=hidden]), select, summary, [role=group], nav, img")
            == []
        )
