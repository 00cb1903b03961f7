"""The playground in the browser: a script is written, run, mended, handed in; a car is driven. All is real."""

import os
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from grader.catalog import Catalog, default_root
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


def _marks(browser: Browser) -> list[str]:
    said = "return [...document.getElementById('editor').shadowRoot.querySelectorAll('.cm-said')]"
    return browser.js(f"{said}.map((one) => one.textContent)")


def test_what_is_written_is_kept_and_python_says_what_it_does_not_take(student: Browser) -> None:
    _write(student, "x = 1\nif x = 2:\n    pass\n")
    student.until(lambda: student.says("#kept") == "Saved.")
    student.until(lambda: _marks(student))
    assert "==" in _marks(student)[0]
    _write(student, "kept = 1\n")
    student.until(lambda: not _marks(student))
    _write(student, "left = 2\n")  # kept as the page is left
    student.open("/assignments/square")
    student.open(PAGE)
    student.until(lambda: _content(student))
    assert _content(student).text.strip() == "left = 2"
    student.open("/assignments/straight/practice?lang=en")
    student.until(lambda: _content(student))
    assert "import rclpy" in _content(student).text  # of its own


def test_an_attempt_is_mended_where_it_failed(student: Browser, course: School, tmp_path: Path) -> None:
    wrong = tmp_path / "drive.py"
    wrong.write_text("import rclpy\nrclpy.init()\nnobody()\n")
    student.hand_in("square", wrong)
    hinted = student.one(".next a[href='#L3']")
    assert "3" in hinted.text
    student.click(".actions a[href*='mend=']")
    student.until(lambda: _content(student) and _marks(student))
    assert "nobody()" in _content(student).text
    assert "NameError" in _marks(student)[0]
    assert student.js("return location.search") == ""
    _write(student, "else_ = 1\n")
    student.one("#last").click()
    student.until(lambda: "nobody()" in _content(student).text)


@pytest.mark.slow
def test_what_was_tried_comes_onto_the_result_by_itself(
    student: Browser, course: School, tmp_path: Path
) -> None:
    from selenium.webdriver.common.keys import Keys

    wrong = tmp_path / "one_radian.py"
    wrong.write_bytes(Catalog().scripts("square")["wrong/one_radian.py"])
    student.hand_in("square", wrong)
    student.until(lambda: student.all("#explanation details") and not student.all("[data-looking]"))
    assert not student.one("#explanation details p").is_displayed()
    more = student.one("#explanation summary")
    more.send_keys(Keys.ENTER)
    link = student.one("#explanation details[open] > p a")
    student.until(lambda: student.all(f".lines {link.get_attribute('hash')}.hinted"))
    link.send_keys(Keys.ENTER)
    assert student.js("return location.hash") == link.get_attribute("hash")
    student.one("#explanation details details summary").send_keys(Keys.ENTER)
    assert student.one("#explanation .change").is_displayed()
    student.command("Emulation.setScriptExecutionDisabled", value=True)  # a reload tells as well
    try:
        student.driver.refresh()
        assert student.all("#explanation .change")
        assert not student.all("[data-looking]")
    finally:
        student.command("Emulation.setScriptExecutionDisabled", value=False)


def test_names_of_rclpy_are_completed(student: Browser) -> None:
    from selenium.webdriver.common.keys import Keys

    _write(student, "import rclpy\nfrom geometry_msgs.msg import ")
    content = _content(student)
    content.send_keys("Twi")
    student.until(lambda: "Twist" in _suggestions(student))
    content.send_keys(Keys.TAB)
    student.until(lambda: _lines(student)[1].endswith("import Twist"))
    content.send_keys(Keys.ENTER, "self.create_pub")
    student.until(lambda: _suggestions(student) == ["create_publisher"])
    content.send_keys(Keys.TAB)
    student.until(lambda: _lines(student)[2] == "self.create_publisher")
    content.send_keys("()", Keys.ENTER, "rclpy.spin_u")
    student.until(lambda: _suggestions(student) == ["spin_until_future_complete"])
    content.send_keys(Keys.ENTER)  # a new line, and nothing that was not typed
    content.send_keys("mine = rclpy.create_node('a')", Keys.ENTER, "mine.create_pub")
    student.until(lambda: _suggestions(student) == ["create_publisher"])
    assert _lines(student)[1:4] == [
        "from geometry_msgs.msg import Twist", "self.create_publisher()", "rclpy.spin_u",
    ]  # fmt: skip


def _lines(browser: Browser) -> list[str]:
    """The program alone, without what stands below its lines."""
    lines = "return [...document.getElementById('editor').shadowRoot.querySelectorAll('.cm-line')]"
    return browser.js(f"{lines}.map((one) => one.textContent)")


def _suggestions(browser: Browser) -> list[str]:
    """What can be chosen now: while the list is made anew, nothing."""
    ready = ".cm-tooltip-autocomplete:not(.cm-tooltip-autocomplete-disabled) li"
    listed = f"return [...document.getElementById('editor').shadowRoot.querySelectorAll('{ready}')]"
    return browser.js(f"{listed}.map((one) => one.textContent)")


@pytest.mark.slow
def test_what_is_refused_is_told_and_not_called_a_lost_connection(student: Browser) -> None:
    from selenium.webdriver.common.keys import Keys

    _write(student, "x = 1\n" * 100_000)
    student.complaints()  # of a page that the test before left while it asked for something
    _content(student).send_keys(Keys.CONTROL, Keys.ENTER)
    student.until(lambda: "large" in student.says("#refused"))
    assert student.one("#run").is_enabled()
    student.open("/playground?lang=en")
    student.js("document.querySelector('#start [name=form_token]').value = 'x'")
    student.one("#start button").click()
    student.until(lambda: "form" in student.says("#car-state"))
    assert len(student.complaints()) == 2  # of these two answers


_BUSY = """
import rclpy
rclpy.init()
node = rclpy.create_node('counter')
def tick():
    node.get_logger().info(str(sum(range(300_000))))
    print('printed')
node.create_timer(0.5, tick)
rclpy.spin(node)
"""
_NOTE_PROGRESS = """
    const noted = window.noted = [];
    const parts = ["virtual-time", "stdout", "stderr"].map((id) => document.getElementById(id));
    const note = () => noted.push(parts.map((one) => one.textContent));
    new MutationObserver(note).observe(document.getElementById("so-far"), {childList: true, subtree: true});
"""


@pytest.mark.slow
def test_a_run_tells_meanwhile_how_far_it_is_and_what_it_prints(student: Browser) -> None:
    _write(student, _BUSY)
    student.js(_NOTE_PROGRESS)
    _run(student)
    time, stdout, stderr = student.js("return window.noted.at(-1)")
    assert re.fullmatch(r"[1-9]\d*\.\d s of virtual time", time)
    assert stdout.startswith("printed\n")
    assert "[counter]: 44999850000" in stderr
    assert not student.one("#so-far").is_displayed()


@pytest.mark.slow
def test_it_is_used_without_a_mouse(student: Browser) -> None:
    from selenium.webdriver.common.action_chains import ActionChains
    from selenium.webdriver.common.keys import Keys

    def press(*keys: str) -> None:
        ActionChains(student.driver).send_keys(*keys).perform()

    student.js("document.getElementById('editor').shadowRoot.querySelector('.cm-content').focus()")
    ActionChains(student.driver).key_down(Keys.CONTROL).send_keys("a").key_up(Keys.CONTROL).perform()
    press("mistyped", Keys.ESCAPE, Keys.ESCAPE)  # suggestions, then the editor
    ActionChains(student.driver).key_down(Keys.SHIFT).send_keys(Keys.TAB).key_up(Keys.SHIFT).perform()
    assert student.js("return document.activeElement.id") == "reset"
    student.js("document.getElementById('run').focus()")
    press(Keys.ENTER)
    student.until(lambda: "NameError" in student.says("#result"))
    press(Keys.TAB)
    assert student.js("return document.activeElement.id") == "hand-in"
    press(Keys.ENTER)
    student.until(lambda: student.path.startswith("/submissions/"))


def test_without_scripts_it_leads_to_the_form_for_files(student: Browser) -> None:
    student.command("Emulation.setScriptExecutionDisabled", value=True)
    try:
        student.open(PAGE)
        assert not student.one("#actions").is_displayed()
        student.click("noscript a")
        assert student.path == "/assignments/square"
        assert student.one("#file").is_displayed()
        assert student.one("#upload button").is_displayed()
    finally:
        student.command("Emulation.setScriptExecutionDisabled", value=False)


@pytest.mark.parametrize(("language", "size"), [("zh", PHONE), ("en", (390, 844))], ids=str)
def test_the_page_fits_a_phone(student: Browser, language: str, size: tuple[int, int]) -> None:
    student.resize(size)
    student.open(f"/assignments/square/practice?lang={language}")
    student.until(lambda: _content(student))
    _write(student, (SQUARE / "solution.py").read_text(encoding="utf-8"))
    student.one("#run").click()
    student.until(lambda: student.all("#replay[data-ready='true']"))
    assert student.js("return document.documentElement.scrollWidth") <= size[0]


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
    _press_first(student)
    student.js(_HOLD, "ArrowDown")
    student.js(_HOLD, "ArrowUp")
    student.js(_RELEASE, "ArrowDown")  # the other one is still held
    student.until(lambda: float(student.says("#place").split()[1]) > 6.5)
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


def _press_first(student: Browser) -> None:
    """Press a button while the view has the focus, as after loading: it drives until it is let go."""
    from selenium.webdriver.common.action_chains import ActionChains

    forward = student.one(".pad [data-v='1'][data-w='0']")
    student.js(_NOTE_COMMANDS)
    ActionChains(student.driver).click_and_hold(forward).perform()
    student.until(lambda: not student.says("#place").startswith("x 5.54 m"))
    assert set(student.js("return window.commanded")) == {1}
    ActionChains(student.driver).release().perform()
    assert student.js("return window.commanded.at(-1)") == 0
    student.js("document.getElementById('view').focus()")


_NOTE_COMMANDS = """
    window.commanded = [];
    const send = WebSocket.prototype.send;
    WebSocket.prototype.send = function (frame) {
        const { op, msg } = JSON.parse(frame);
        if (op === "publish") window.commanded.push(msg.linear.x);
        return send.call(this, frame);
    };
"""
_HOLD = (
    "document.activeElement.dispatchEvent(new KeyboardEvent('keydown', {key: arguments[0], bubbles: true}))"
)
_RELEASE = (
    "document.activeElement.dispatchEvent(new KeyboardEvent('keyup', {key: arguments[0], bubbles: true}))"
)
