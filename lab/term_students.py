"""A class that hands in on the real pages: windows of Chromium side by side, each for a share of the students.

A student signs in once, with the token, on the page that asks for it. For each file the assignment's page is
opened, the file dropped on its form as from a folder, and its button pressed; the submission's page that follows
ends it. Nothing is sent past that form. An upload is two pages and four questions to the browser: no page is
looked at twice, nobody waits for a grading, and a page counts as there once it can be used.
"""

from __future__ import annotations

import json
import shutil
import statistics
import threading
import time
from collections.abc import Iterable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from benchmarks.processes import cpu_s, reaped_cpu_s, tree

_DROP = """
    const [name, text] = arguments;
    const dataTransfer = new DataTransfer();
    dataTransfer.items.add(new File([text], name));
    const drop = document.getElementById("drop");
    drop.dispatchEvent(new DragEvent("drop", {dataTransfer, bubbles: true, cancelable: true}));
    const [page] = performance.getEntriesByType("navigation");
    document.querySelector("#upload button").click();
    return page.domContentLoadedEventEnd;
"""
_ARRIVED = """
    const [page] = performance.getEntriesByType("navigation");
    return [location.pathname, page.domContentLoadedEventEnd];
"""
_PATIENCE_S = 60.0
_PAUSE_S = 0.005


@dataclass(frozen=True, slots=True)
class Upload:
    """A file to be handed in. `number` names it in the class's plan, also after a restart."""

    number: int
    student: str
    assignment: str
    file_name: str
    text: str


@dataclass(slots=True)
class Handed:
    """What was handed in, kept in a file line by line: an interrupted class goes on where it was.

    Attributes:
        pages_ms: times until pages could be used, by what they are.
        cpu_s: of the browsers, for what was handed in since the start.
    """

    path: Path
    done: set[int] = field(default_factory=set)
    pages_ms: dict[str, list[float]] = field(default_factory=lambda: {"assignment": [], "submission": []})
    cpu_s: float = 0.0
    _lock: threading.Lock = field(default_factory=threading.Lock)

    def __post_init__(self) -> None:
        if self.path.exists():
            for line in self.path.read_text().splitlines():
                self._note(json.loads(line))

    def add(self, upload: Upload, submission: str, assignment_ms: float, submission_ms: float) -> None:
        """Note an upload."""
        line = {
            "number": upload.number,
            "submission": submission,
            "assignment": round(assignment_ms, 1),
            "page": round(submission_ms, 1),
        }
        with self._lock, self.path.open("a") as log:
            log.write(json.dumps(line) + "\n")
            self._note(line)

    def _note(self, line: Mapping[str, Any]) -> None:
        self.done.add(line["number"])
        self.pages_ms["assignment"].append(line["assignment"])
        self.pages_ms["submission"].append(line["page"])

    def told(self) -> str:
        """Return how long pages took in the browser."""
        return ", ".join(
            f"{name} page p50 {statistics.median(ms):.0f} ms, p95 {sorted(ms)[int(len(ms) * 0.95)]:.0f} ms"
            for name, ms in self.pages_ms.items()
            if ms
        )


def hand_in_on_pages(  # noqa: PLR0913, PLR0917
    address: str,
    folder: Path,
    tokens: Mapping[str, str],
    uploads: Iterable[Upload],
    handed: Handed,
    windows: int,
) -> None:
    """Hand in all of `uploads` that are not `handed` yet, each student's in order, in so many windows."""
    by_student: dict[str, list[Upload]] = {}
    for one in uploads:
        if one.number not in handed.done:
            by_student.setdefault(one.student, []).append(one)
    waiting = iter(by_student.items())
    lock = threading.Lock()

    def work(browser: Any) -> None:
        while True:
            with lock:
                student, files = next(waiting, ("", ()))
            if not student:
                return
            _hand_in(browser, tokens[student], files, handed)

    with ExitStack() as stack, ThreadPoolExecutor(windows) as pool:
        browsers = [stack.enter_context(_window(address, folder / f"window{n}")) for n in range(windows)]
        for done in [pool.submit(work, one) for one in browsers]:
            done.result()
        processes = [one for browser in browsers for one in tree(browser.driver.service.process.pid)]
        handed.cpu_s += sum(cpu_s(one) + reaped_cpu_s(one) for one in processes)


def _window(address: str, profile: Path) -> Any:
    from tests.e2e.chromium import chromium

    programs = shutil.which("chromium"), shutil.which("chromedriver")
    assert all(programs), "chromium and chromedriver are needed"
    return chromium(programs, profile, address, load="eager")  # type: ignore[arg-type]


def _hand_in(browser: Any, token: str, files: Sequence[Upload], handed: Handed) -> None:
    browser.command("Network.clearBrowserCookies")
    browser.enter("token", token)
    for upload in files:
        browser.open(f"/assignments/{upload.assignment}")
        assignment_ms = browser.js(_DROP, upload.file_name, upload.text)
        path, submission_ms = _arrived(browser)
        handed.add(upload, path.rpartition("/")[2], assignment_ms, submission_ms)


def _arrived(browser: Any) -> tuple[str, float]:
    """Return the address of the submission's page, once it can be used, and how long that took."""
    deadline_s = time.monotonic() + _PATIENCE_S
    while True:
        path, ms = browser.js(_ARRIVED)
        if path.startswith("/submissions/") and ms:
            return path, ms
        assert not browser.all(".refusal"), browser.says()
        assert time.monotonic() < deadline_s, path
        time.sleep(_PAUSE_S)
