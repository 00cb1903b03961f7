import os
import shutil
from collections.abc import Callable, Iterator
from contextlib import closing
from importlib.resources import files
from importlib.util import find_spec
from pathlib import Path
from subprocess import CompletedProcess
from typing import NoReturn

import pytest

from grader.commands import check, cli
from grader.commands import run as run_command
from grader.grading.slot import Slot
from tests.e2e.chromium import DESKTOP, Browser, chromium
from tests.fakes.grading import Lent
from tests.fakes.prepared import Prepared


def _found(*names: str) -> str:
    for name in names:
        if path := shutil.which(name):
            return path
    return _missing(names[0])


def _missing(program: str) -> NoReturn:
    """Skip a test in a browser for want of a program, or fail where a browser is required."""
    reason = f"{program} is not installed, so the pages were not tried in a browser"
    if os.environ.get("GRADER_REQUIRE_BROWSER"):
        pytest.fail(reason)
    pytest.skip(reason)


@pytest.fixture
def at_terminal(
    slot: Slot, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> Callable[..., CompletedProcess[str]]:
    """`grader` with its arguments, in `tmp_path`: in this process, and with one slot for all tests."""
    for command in (check, run_command):
        monkeypatch.setattr(command, "Slot", lambda config: Lent(slot))
    monkeypatch.chdir(tmp_path)

    def run(*arguments: str | Path) -> CompletedProcess[str]:
        code = cli.run([*map(str, arguments)])
        said = capsys.readouterr()
        return CompletedProcess(arguments, code, said.out, said.err)

    return run


@pytest.fixture(scope="session")
def prepared() -> Iterator[Prepared]:
    """Starts processes of the service for the tests of several."""
    with closing(Prepared()) as made:
        yield made


@pytest.fixture(scope="session")
def programs() -> tuple[str, str]:
    """Chromium and its driver."""
    return _found("chromium", "chromium-browser", "google-chrome"), _found("chromedriver")


@pytest.fixture(scope="session")
def axe() -> str:
    """The text of axe-core."""
    if find_spec("axe_playwright_python") is None:
        _missing("axe-playwright-python")
    return files("axe_playwright_python").joinpath("axe.min.js").read_text(encoding="utf-8")


@pytest.fixture(scope="session")
def window(programs: tuple[str, str], tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    """One window for all tests."""
    with chromium(programs, tmp_path_factory.mktemp("profile"), "") as opened:
        yield opened


@pytest.fixture
def browser(window: Browser, address: str) -> Iterator[Browser]:
    """The one window, as if nobody had used it, at the module's service, whose fixture is `address`."""
    window.address = address
    window.command("Network.clearBrowserCookies")
    window.resize(DESKTOP)
    yield window
    window.driver.get("about:blank")  # what a page still keeps as it is left is kept by whom it was shown to
    assert window.complaints() == []
