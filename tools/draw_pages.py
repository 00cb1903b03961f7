"""Draw docs/images/web-<page>-<device>-<language>.png: the pages as a headless Chromium shows them.

Opens a course of its own with everything real and grades the assignments' own scripts: ``python
tools/draw_pages.py``. Needs `chromium` and `chromium-driver`.
"""

import shutil
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

from PIL import Image

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from grader.contracts.platform import NewPlatform, PlatformLink  # noqa: E402
from grader.contracts.regrade import Regrade, Wanted  # noqa: E402
from grader.store.audit import Signature  # noqa: E402
from tests.e2e.chromium import Browser, chromium  # noqa: E402
from tests.e2e.school import COURSE, ESSAY, SQUARE, School, school  # noqa: E402

OUT = ROOT / "docs" / "images"
DEVICES = {"desktop": (1280, 1000), "phone": (390, 844)}
TALLEST_PX = {"desktop": 1400, "phone": 1800}
COLOURS = 128  # flat pages: nobody sees the difference, and the files are a third


def main() -> None:
    """Draw the pages named on the command line, or all."""
    OUT.mkdir(parents=True, exist_ok=True)
    with (
        tempfile.TemporaryDirectory() as folder,
        school(f"sqlite:///{folder}/grader.db", Path(folder), signin=_signin(Path(folder))) as opened,
    ):
        pages = {name: (person, address) for name, person, address in _pages(opened)}
        programs = (shutil.which("chromium") or "chromium", shutil.which("chromedriver") or "chromedriver")
        with chromium(programs, Path(folder) / "profile", opened.address) as browser:
            browser.command("Emulation.setScrollbarsHidden", hidden=True)
            for page in sys.argv[1:] or pages:
                person, address = pages[page]
                browser.enter("token", opened.tokens[person])
                for device in DEVICES:
                    for language in ("zh", "en"):
                        _draw(browser, address, device, language, f"web-{page}-{device}-{language}.png")


def _signin(folder: Path) -> Path:
    """Say where the service is, as learning platforms must know."""
    path = folder / "signin.toml"
    path.write_text('public_url = "https://grader.example.edu"\n', encoding="utf-8")
    return path


def _pages(opened: School) -> Iterator[tuple[str, str, str]]:
    """Yield every page's name, who looks at it, and its address."""
    submissions = opened.services.submissions
    first = submissions.of_student("20260101", SQUARE, COURSE)[-1].id
    answer = submissions.of_student("20260101", ESSAY, COURSE)[0].id
    yield "result", "20260101", f"/submissions/{first}"
    yield "class", "wang", "/class"
    yield "gradebook", "wang", "/class/gradebook"
    yield "rules", "wang", f"/class/rules/{SQUARE}"
    yield "points", "wang", f"/class/judgements/{answer}?item=timer"
    _add_platform(opened)
    yield "platforms", "wang", "/class/platforms"
    yield "regrade", "wang", f"/class/regrades/{_trial(opened).id}"


def _add_platform(opened: School) -> None:
    """Add a platform from which the square was opened."""
    services, moodle = opened.services, "https://moodle.example.edu"
    new = NewPlatform(
        title="Moodle",
        issuer=moodle,
        client_id="Yt7gXs0Qa2kRw9E",
        deployment="1",
        login_url=f"{moodle}/mod/lti/auth.php",
        token_url=f"{moodle}/mod/lti/token.php",
        keys_url=f"{moodle}/mod/lti/certs.php",
    )
    added = services.platforms.add(new, Signature(services.clock(), COURSE, "wang"))
    services.platforms.set_people_url(added.id, f"{moodle}/mod/lti/services.php/people")
    services.platforms.open_link(
        PlatformLink(
            platform=added.id,
            resource="7",
            title="走正方形",
            assignment=SQUARE,
            line_item=f"{moodle}/mod/lti/services.php/items/7",
            used_at=services.clock(),
        )
    )


def _trial(opened: School) -> Regrade:
    """Grade the square again with one tolerance less, and wait until every trial grading is made."""
    opened.tighten()
    services = opened.services
    wanted = Wanted(assignment=SQUARE, which="all")
    regrade = services.regrades.open(wanted, Signature(services.clock(), COURSE, "wang"))
    services.doorbell.ring()
    with opened.client("wang") as client:
        while client.get(f"/api/v1/regrades/{regrade.id}").raise_for_status().json()["waiting"]:
            pass
    return regrade


def _draw(browser: Browser, address: str, device: str, language: str, name: str) -> None:
    width, height = DEVICES[device]
    browser.resize((width, height))
    browser.open(f"{address}{'&' if '?' in address else '?'}lang={language}")
    browser.until(lambda: not browser.all("#replay:not([data-ready])"))
    tall = browser.js("return document.documentElement.scrollHeight")
    browser.resize((width, max(height, min(tall, TALLEST_PX[device]))))
    path = OUT / name
    browser.driver.save_screenshot(str(path))
    picture = Image.open(path).convert("RGB").quantize(COLOURS, dither=Image.Dither.NONE)
    picture.save(path, optimize=True)
    print(f"docs/images/{name} {path.stat().st_size // 1024} KiB")


if __name__ == "__main__":
    main()
