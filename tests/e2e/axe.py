"""Whether a page can be used by everybody, as axe-core says, and whether it fits its window.

axe-core comes with axe-playwright-python, of which nothing else is used.
"""

from collections.abc import Iterable

from tests.e2e.chromium import Browser

SIZES = ((390, 844), (1280, 900), (1920, 1080))
_LIGHT, _DARK = ({"name": "prefers-color-scheme", "value": one} for one in ("light", "dark"))
_SERIOUS = """
    const [rules, done] = arguments;
    const options = { resultTypes: ["violations"] };
    if (rules) options.runOnly = { type: "rule", values: rules };
    const places = ({ nodes }) => nodes.map(({ target }) => target.flat().join(" ")).join(", ");
    const serious = ({ impact }) => impact === "serious" || impact === "critical";
    const told = ({ violations }) => violations.filter(serious).map((one) => `${one.id}: ${places(one)}`);
    axe.run(document, options).then((found) => done(told(found)), (error) => done([String(error)]));
"""


def assert_sound(browser: Browser, axe: str, pages: Iterable[str]) -> None:
    """Open pages: axe-core, whose text is `axe`, finds nothing serious or critical, and none is too wide."""
    wrong = {}
    for page in pages:
        browser.open(page)
        browser.until(lambda: not browser.all("#replay:not([data-ready])"))
        if faults := _faults(browser, axe):
            wrong[page] = faults
    assert not wrong, wrong


def _faults(browser: Browser, axe: str) -> list[str]:
    """Return what is wrong with the page that is open, at each width; contrasts in both colours."""
    found = []
    browser.js(axe)
    for size in SIZES:
        browser.resize(size)
        wide = browser.js("return document.documentElement.scrollWidth")
        found += [f"{size[0]}: {wide} px wide"] if wide > size[0] else []
        found += [f"{size[0]}: {one}" for one in browser.driver.execute_async_script(_SERIOUS, None)]
    browser.command("Emulation.setEmulatedMedia", features=[_DARK])
    found += [f"dark: {one}" for one in browser.driver.execute_async_script(_SERIOUS, ["color-contrast"])]
    browser.command("Emulation.setEmulatedMedia", features=[_LIGHT])
    return found
