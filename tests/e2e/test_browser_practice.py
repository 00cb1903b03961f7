"""The playground in the browser: a script is written, run, mended, handed in; a car is driven. All is real."""

import os
from collections.abc import Iterator

import pytest

from grader.catalog import default_root
from tests.e2e.chromium import PHONE, Browser
from tests.e2e.school import School, school
from tests.fakes.postgres import PostgresServer

pytestmark = pytest.mark.browser
SQUARE = default_root() / "square"
PAGE = "/assignments/square/practice?lang=en"


@pytest.fixture(scope="module")
def course(
    programs: tuple[str, str], postgres_server: PostgresServer, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[School]:
    name = f"practice_{os.getpid()}"
    folder = tmp_path_factory.mktemp("school")
    with school(postgres_server.create(name), folder, (), websockets=True) as opened:
        yield opened
    postgres_server.drop(name)


@pytest.fixture(scope="module")
def address(course: School) -> str:
    return course.address


@pytest.fixture
def student(browser: Browser, course: School) -> Browser:
    browser.signed_in("token", course.tokens["20260101"])
    browser.open(PAGE)
    browser.until(lambda: _content(browser))
    return browser


def _content(browser: Browser):
    return browser.js("return document.getElementById('editor').shadowRoot?.querySelector('.cm-content')")


_PASTE = """
    const clipboardData = new DataTransfer();
    clipboardData.setData("text/plain", arguments[1]);
    arguments[0].dispatchEvent(new ClipboardEvent("paste", { clipboardData, bubbles: true, cancelable: true }));
"""


def _write(browser: Browser, script: str) -> None:
    """Put `script` in the place of what is there, as somebody who pastes."""
    from selenium.webdriver.common.keys import Keys

    content = _content(browser)
    content.click()
    content.send_keys(Keys.CONTROL, "a")
    browser.js(_PASTE, content, script)


def _run(browser: Browser) -> None:
    from selenium.webdriver.common.keys import Keys

    _content(browser).send_keys(Keys.CONTROL, Keys.ENTER)
    browser.until(lambda: browser.says("#practice-state") == "The run has ended.")


def test_a_script_is_written_run_mended_and_handed_in(student: Browser, course: School) -> None:
    assert "import rclpy" in _content(student).text  # the starter
    assert student.nameless("a, button, input, select, section") == []
    _write(student, "import rclpy\n\nrclpy.init()\nraise ValueError('left out')\n")
    _run(student)
    assert "ValueError: left out" in student.says("#result")
    _write(student, (SQUARE / "solution.py").read_text(encoding="utf-8"))
    _run(student)
    assert student.one("#replay").get_attribute("data-ready") == "true"
    assert not student.all("#result .failed")
    assert course.services.submissions.of_student("20260101", course="ros2-2026") == ()
    student.click("#hand-in")
    assert student.path.startswith("/submissions/")
    student.until(lambda: student.all("#score"))
    assert "100 / 100" in student.says("#score")


def test_what_is_refused_is_told_and_not_called_a_lost_connection(student: Browser) -> None:
    from selenium.webdriver.common.keys import Keys

    _write(student, "x = 1\n" * 100_000)
    _content(student).send_keys(Keys.CONTROL, Keys.ENTER)
    student.until(lambda: "large" in student.says("#refused"))
    assert student.one("#run").is_enabled()
    student.open("/playground?lang=en")
    student.js("document.querySelector('#start [name=form_token]').value = 'x'")
    student.one("#start button").click()
    student.until(lambda: "form" in student.says("#car-state"))
    assert len(student.complaints()) == 2  # of these two answers


def test_the_page_fits_a_phone(student: Browser) -> None:
    student.resize(PHONE)
    student.open(PAGE)
    student.until(lambda: _content(student))
    assert student.js("return document.documentElement.scrollWidth") <= PHONE[0]


def test_a_car_is_driven_by_keys_and_buttons(student: Browser) -> None:
    from selenium.webdriver.common.keys import Keys

    student.resize(PHONE)
    student.open("/playground?lang=en")
    student.one("#start button").click()
    student.until(lambda: student.says("#car-state") == "Connected.")
    assert student.one("#url").get_property("value").startswith("ws://127.0.0.1:")
    student.until(lambda: student.says("#place").startswith("x 5.54 m"))
    assert student.js("return document.activeElement.id") == "view"
    places = {(one.rect["x"], one.rect["y"]) for one in student.all(".pad button")}
    assert len(places) == len(student.all(".pad button"))
    student.js(_HOLD, "ArrowUp")
    student.until(lambda: not student.says("#place").startswith("x 5.54 m"))
    student.js(_RELEASE, "ArrowUp")
    student.one(".pad .left").send_keys(Keys.ENTER)
    student.until(lambda: not student.says("#place").endswith(" 0°"))
    student.until(lambda: len(student.all("#topic option")) > 3)
    student.one("#topic option[value='/turtle1/pose']").click()
    student.until(lambda: '"theta"' in student.says("#echo"))
    student.one("#hold").click()
    student.until(lambda: student.one("#hold").get_attribute("aria-pressed") == "true")
    assert student.nameless("a, button, input, select, section, [tabindex='0']") == []
    assert student.js("return document.documentElement.scrollWidth") <= PHONE[0]


_HOLD = (
    "document.activeElement.dispatchEvent(new KeyboardEvent('keydown', {key: arguments[0], bubbles: true}))"
)
_RELEASE = (
    "document.activeElement.dispatchEvent(new KeyboardEvent('keyup', {key: arguments[0], bubbles: true}))"
)
