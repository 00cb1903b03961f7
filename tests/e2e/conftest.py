import os
import shutil
from collections.abc import Iterator

import pytest

from tests.e2e.chromium import DESKTOP, Browser, chromium


def _found(*names: str) -> str:
    for name in names:
        if path := shutil.which(name):
            return path
    missing = f"{names[0]} is not installed, so the pages were not tried in a browser"
    if os.environ.get("GRADER_REQUIRE_BROWSER"):
        pytest.fail(missing)
    pytest.skip(missing)


@pytest.fixture(scope="session")
def programs() -> tuple[str, str]:
    """Chromium and its driver."""
    return _found("chromium", "chromium-browser", "google-chrome"), _found("chromedriver")


@pytest.fixture(scope="session")
def window(programs: tuple[str, str], tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    """One window for all tests."""
    with chromium(programs, tmp_path_factory.mktemp("profile"), "") as opened:
        yield opened


@pytest.fixture
def browser(window: Browser, address: str) -> Iterator[Browser]:
    """The one window, as if nobody had used it, at the module's service, whose fixture is `address`."""
    window.address = address
    window.open("/static/icon.svg")
    window.driver.delete_all_cookies()
    window.resize(DESKTOP)
    yield window
    assert window.complaints() == []
