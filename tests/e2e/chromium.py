"""Headless Chromium for the tests of the pages and for their pictures in the documentation."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from urllib.parse import urlsplit

import httpx
import pytest

from grader.service.web import forms
from tests.fakes.waiting import wait_until

PATIENCE_S = 60
DESKTOP, PHONE = (1280, 900), (320, 640)
FLAGS = (
    "--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--no-proxy-server",
    "--disable-background-networking", "--disable-component-update", "--disable-sync",
    "--disable-dev-shm-usage",  # a container has little of it, and a page that finds none crashes
    "--enable-blink-features=ComputedAccessibilityInfo",  # what `nameless` asks for
    "--force-prefers-reduced-motion",  # a replay stands still until a test plays it
    # less work for the same pages
    "--in-process-gpu", "--renderer-process-limit=1", "--disable-extensions", "--disable-default-apps",
    "--guest",  # no extensions, sign-in or new-tab page
    # nor a spare process for the next page, nor a page kept for the way back
    "--disable-features=Translate,OptimizationHints,MediaRouter,AutofillServerCommunication,BackForwardCache,"
    "SpareRendererForSitePerProcess,RenderDocument",
)  # fmt: skip


class Browser:
    """One window of Chromium with a profile of its own."""

    def __init__(self, driver, address: str) -> None:
        self.driver = driver
        self.address = address

    def open(self, path: str) -> None:
        self.driver.get(self.address + path)

    def open_once(self, path: str, words: str) -> None:
        """Open a page as soon as it says `words`. Looking without drawing takes a tenth of the time."""
        cookies = {one["name"]: one["value"] for one in self.driver.get_cookies()}
        with httpx.Client(base_url=self.address, cookies=cookies, trust_env=False) as client:
            wait_until(lambda: words in client.get(path).text, PATIENCE_S, pause_s=0.1)
        self.open(path)

    @property
    def path(self) -> str:
        return urlsplit(self.driver.current_url).path

    def one(self, selector: str):
        return self.driver.find_element("css selector", selector)

    def all(self, selector: str):
        return self.driver.find_elements("css selector", selector)

    def type(self, selector: str, text: str) -> None:
        self.one(selector).clear()
        self.one(selector).send_keys(text)

    def until(self, condition: Callable[[], object]) -> None:
        from selenium.common.exceptions import StaleElementReferenceException
        from selenium.webdriver.support.wait import WebDriverWait

        changing = [StaleElementReferenceException]  # the next page came in the middle of the question
        wait = WebDriverWait(self.driver, PATIENCE_S, poll_frequency=0.05, ignored_exceptions=changing)
        wait.until(lambda _: condition())

    def enter(self, field: str, text: str) -> None:
        self.open("/enter")
        self.type(f"#{field}", text)
        self.one(f"form:has(#{field}) button").click()
        self.until(lambda: self.path != "/enter")

    def signed_in(self, field: str, text: str) -> None:
        """Be whom `enter` makes this browser, without the two pages on the way."""
        form_token = "f" * 32  # which a page would have brought
        with httpx.Client(cookies={forms.COOKIE: form_token}, trust_env=False) as client:
            fields = {field: text, forms.FIELD: form_token}
            answer = client.post(f"{self.address}/enter", data=fields)
        assert answer.status_code == 303, answer.text
        given = [
            {"name": name, "value": value, "url": self.address} for name, value in answer.cookies.items()
        ]
        self.command("Network.setCookies", cookies=given)

    def click(self, selector: str) -> None:
        """Click what leads to another page, and wait until that one is there."""
        before = self.one("html").id
        self.one(selector).click()
        self.until(lambda: self.one("html").id != before)
        self.until(lambda: self.js("return document.readyState") == "complete")

    def says(self, selector: str = "main") -> str:
        """What is written there, shown or folded away, with single spaces."""
        return " ".join(self.one(selector).get_property("textContent").split())

    def hand_in(self, assignment: str, path: Path) -> None:
        self.open(f"/assignments/{assignment}")
        self.one("#file").send_keys(str(path))
        self.one("#upload button").click()
        self.until(lambda: self.path.startswith("/submissions/"))
        self.until(lambda: self.all("#score"))

    def js(self, script: str, *arguments: object):
        return self.driver.execute_script(script, *arguments)

    def nameless(self, selector: str) -> list[str]:
        """The markup of what is shown and has no name to be read out. An empty `alt` is decoration."""
        seen = "visibilityProperty: true, opacityProperty: true, contentVisibilityAuto: true"
        named = ":not(img[alt=''])"
        script = """
            return [...document.querySelectorAll(arguments[0])]
                .filter((one) => one.checkVisibility({%s}) && !one.computedName.trim())
                .map((one) => one.outerHTML);
        """
        return self.js(script % seen, f":is({selector}){named}")

    def command(self, name: str, **parameters: object) -> None:
        self.driver.execute_cdp_cmd(name, parameters)

    def resize(self, size: tuple[int, int]) -> None:
        width, height = size
        self.command(
            "Emulation.setDeviceMetricsOverride",
            width=width,
            height=height,
            deviceScaleFactor=1,
            mobile=width < 600,
        )

    def complaints(self) -> list[str]:
        """What the browser itself found wrong: refused by the policy, not found, an exception in a script.

        A form that is shown again because of what was typed is no fault, nor is what was still being loaded for a
        page that a test has left.
        """
        logged = self.driver.get_log("browser")
        severe = [entry["message"] for entry in logged if entry["level"] == "SEVERE"]
        return [line for line in severe if "status of 422" not in line and not line.startswith("about:blank")]


@contextmanager
def chromium(
    programs: tuple[str, str], profile: Path, address: str, load: str = "normal"
) -> Iterator[Browser]:
    """Yield a window. `load` says when a page is there, in WebDriver's words (`pageLoadStrategy`)."""
    from selenium import webdriver
    from selenium.webdriver.chrome.service import Service

    options = webdriver.ChromeOptions()
    options.binary_location = programs[0]
    for flag in (*FLAGS, f"--user-data-dir={profile}"):
        options.add_argument(flag)
    options.page_load_strategy = load
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("NO_PROXY", "127.0.0.1,localhost")
        patch.setenv("no_proxy", "127.0.0.1,localhost")
        driver = webdriver.Chrome(options=options, service=Service(programs[1]))
        try:
            yield Browser(driver, address)
        finally:
            driver.quit()
