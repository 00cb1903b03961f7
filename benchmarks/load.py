"""A class hands in its work: how quickly uploads, gradings and the dashboard answer, and whether all is right.

``class``: N students x 7 assignments x 3 attempts on the embedded default, as fast as `--per-second` says.
``deadline``: 2,000 uploads in ten minutes, ever denser, by default on 2 API processes and 2 workers over
PostgreSQL (`--database`). The processes are started in a temporary folder and speak loopback only.

Exit code 1 if anything was lost or the gradebook is not what it must be.
"""

from __future__ import annotations

import argparse
import asyncio
import os
import statistics
import sys
import tempfile
import threading
import time
from collections import Counter
from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import Any

import httpx
from rich.console import Console
from rich.table import Table

from benchmarks import gradebook
from benchmarks.classroom import Upload, bare_rate, graded_scripts, plan, roster
from benchmarks.handing_in import HandingIn, Sent, answered_within, crowded_since, evening, steady
from benchmarks.postgres_server import PostgresServer
from benchmarks.processes import INSTRUCTOR, Memory, Service

_LOOK_S = 1.0
_DASHBOARD = "/api/v1/dashboard"
_PERCENTILES = (50, 95, 99)
_BARE_GRADINGS = 200
_SLOTS = 2
_ENOUGH = 50
_TEACHER_LOOKS_S = 5.0
_UPLOAD_S = 0.1


@dataclass(slots=True)
class Looks:
    """How long the dashboard took, in seconds: after a change, when asked again, and with its ETag."""

    cold: list[float]
    warm: list[float]
    same: list[float]


class Teacher(threading.Thread):
    """Asks for the dashboard every `every_s` seconds while the class hands in and is graded."""

    def __init__(self, client: httpx.Client, every_s: float) -> None:
        super().__init__(daemon=True)
        self._client = client
        self._every_s = every_s
        self._stopped = threading.Event()
        self.looks = Looks([], [], [])

    def run(self) -> None:
        """Ask until told to stop."""
        while not self._stopped.wait(self._every_s):
            self.looks.cold.append(timed(self._client, _DASHBOARD)[0])

    def stop(self) -> None:
        """Ask no more."""
        self._stopped.set()
        self.join()


def main() -> int:
    """Run a profile, print what was seen, return the exit code."""
    options = _options()
    console = Console()
    students = roster(options.students)
    uploads = plan(graded_scripts(), students, options.attempts, options.seed)[: options.uploads]
    if options.profile == "class":
        at_s = steady(len(uploads), options.per_second, options.seed)
    else:
        at_s = evening(len(uploads), options.minutes * 60.0 / options.speed_up, options.seed)
    bare = bare_rate(uploads, _BARE_GRADINGS, _SLOTS)
    console.print(f"two bare grading loops: {bare:.1f} gradings/s; load {os.getloadavg()[0]:.1f}")
    with ExitStack() as stack:
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="grader-load-")))
        database: str | None = options.database
        if database in ("postgres", "embedded"):
            own = database == "postgres"
            database = stack.enter_context(PostgresServer()).url if own else None
        service = Service(folder, apis=options.apis, workers=options.workers, database=database)
        run = Run(stack.enter_context(service), students, console)
        run.hand_in(uploads, at_s)
        code = run.report(bare)
        if options.gradebook is not None:
            options.gradebook.write_bytes(run.gradebook())
        return code


class Run:
    """One run against a service that has just been started."""

    def __init__(self, service: Service, students: Sequence[str], console: Console) -> None:
        """Create the course, its people and its rules."""
        self._service = service
        self._students = students
        self._console = console
        self._tokens = service.enrol(students)
        self._headers = {"Authorization": f"Bearer {self._tokens[INSTRUCTOR]}"}
        self._client = httpx.Client(
            base_url=service.urls[0], headers=self._headers, timeout=60.0, trust_env=False
        )
        gradebook.set_rules(self._client, students)
        self._teacher = Teacher(self._client, _TEACHER_LOOKS_S)
        self._memory = Memory(service)
        self._handing_in = HandingIn(service.urls, self._tokens)
        self._sending_s = 0.0

    def hand_in(self, uploads: Sequence[Upload], at_s: Sequence[float]) -> None:
        """Hand everything in, with a teacher looking on, and wait until it is graded."""
        self._memory.start()
        self._teacher.start()
        started = time.monotonic()
        asyncio.run(self._handing_in.run(uploads, at_s))
        self._sending_s = time.monotonic() - started
        await_empty(self._client)
        self._teacher.stop()
        self._memory.stop()

    def gradebook(self) -> bytes:
        """Return the gradebook as the service hands it out."""
        return self._client.get("/api/v1/gradebook.csv").raise_for_status().content

    def report(self, bare: float) -> int:
        """Print what was seen; return the exit code."""
        quiet = looks_at_rest(self._client)
        accepted = [one for one in self._handing_in.sent if one.accepted and not one.repeated]
        gradings = asyncio.run(read_all(accepted, self._headers))
        report_uploads(self._console, self._handing_in.sent, self._sending_s)
        within = answered_within(self._client, _UPLOAD_S)
        self._console.print(f"of them answered within {_UPLOAD_S} s, as the service measures: {within:.2%}")
        report_gradings(self._console, gradings, bare)
        report_looks(self._console, self._teacher.looks.cold, quiet)
        self._console.print(f"peak memory of all processes: {self._memory.peak_mib:.0f} MiB (proportional)")
        return verdict(self._console, self._client, accepted, gradings, self._students)


def await_empty(client: httpx.Client) -> None:
    """Wait until nothing waits and nothing is graded."""
    while True:
        queue = client.get("/healthz").json()["queue"]
        if not queue["queued"] and not queue["running"]:
            return
        time.sleep(_LOOK_S)


def looks_at_rest(client: httpx.Client) -> Looks:
    """Time the dashboard while nothing else happens: after a change, when asked again, and with its ETag."""
    looks = Looks([], [], [])
    for number in range(10):
        body = {"attempts": number + 1, "reason": "measuring"}
        client.put("/api/v1/assignments/hexagon/rules", json=body).raise_for_status()
        looks.cold.append(timed(client, _DASHBOARD)[0])
        took_s, answer = timed(client, _DASHBOARD)
        looks.warm.append(took_s)
        looks.same.append(timed(client, _DASHBOARD, {"If-None-Match": answer.headers["ETag"]})[0])
    return looks


def timed(
    client: httpx.Client, address: str, headers: dict[str, str] | None = None
) -> tuple[float, httpx.Response]:
    """Return how long a request took, and its answer."""
    started = time.perf_counter()
    answer = client.get(address, headers=headers or {})
    took_s = time.perf_counter() - started
    if answer.status_code != httpx.codes.NOT_MODIFIED:
        answer.raise_for_status()
    return took_s, answer


async def read_all(accepted: Sequence[Sent], headers: dict[str, str]) -> list[dict[str, Any]]:
    """Return every accepted submission as the service shows it now."""
    at_once = asyncio.Semaphore(4)
    async with httpx.AsyncClient(headers=headers, timeout=60.0, trust_env=False) as client:

        async def read(one: Sent) -> dict[str, Any]:
            async with at_once:
                document: dict[str, Any] = (await client.get(one.location)).raise_for_status().json()
                return document

        return await asyncio.gather(*(read(one) for one in accepted))


def report_uploads(console: Console, sent: Sequence[Sent], sending_s: float) -> None:
    """Print what became of the uploads and how long the answers took."""
    codes = Counter("repeated" if one.repeated else one.code for one in sent)
    console.print(f"{len(sent)} uploads in {sending_s:.0f} s: {dict(codes)}")
    console.print(f"upload: {milliseconds([one.took_s for one in sent if one.accepted])}")


def report_gradings(console: Console, gradings: Sequence[dict[str, Any]], bare: float) -> None:
    """Print how long gradings took and how many there were in a second."""
    received = [_instant(one, "received_at") for one in gradings]
    finished = [_instant(one, "finished_at") for one in gradings]
    waits = [end - begin for begin, end in zip(received, finished, strict=True)]
    console.print(f"time to grade: {milliseconds(waits)}")
    last = max(received)
    for since, until, when in (
        (min(received), max(finished), "in all"),
        (crowded_since(received, finished, _SLOTS), last, "while more came in and some waited"),
        (last, max(finished), "once nothing more came in"),
    ):
        done = sum(since < one <= until for one in finished)
        if done >= _ENOUGH:
            rate = done / (until - since)
            came = sum(since < one <= until for one in received) / (until - since)
            console.print(
                f"{rate:.1f} gradings/s {when} ({rate / bare:.2f} of the bare loops;"
                f" {came / bare:.2f} of them came in, and no more can be graded for long)"
            )


def report_looks(console: Console, busy: Sequence[float], quiet: Looks) -> None:
    """Print how long the dashboard took."""
    table = Table(title="dashboard")
    for heading in ("", "median ms", "slowest ms"):
        table.add_column(heading, justify="right")
    rows = {"after a change, while grading": busy, "after a change, at rest": quiet.cold}
    for name, times in (rows | {"asked again": quiet.warm, "304": quiet.same}).items():
        if times:
            table.add_row(name, f"{statistics.median(times) * 1e3:.0f}", f"{max(times) * 1e3:.0f}")
    console.print(table)


def verdict(
    console: Console,
    client: httpx.Client,
    accepted: Sequence[Sent],
    gradings: Sequence[dict[str, Any]],
    students: Sequence[str],
) -> int:
    """Print whether everything accepted was graded and the gradebook is right; return the exit code."""
    lost = sum(one["status"] != "graded" for one in gradings)
    took_s, answer = timed(client, "/api/v1/gradebook.csv")
    wanted = gradebook.expected(
        [one.upload for one in sorted(accepted, key=lambda each: each.order)], students
    )
    wrong = [pair for pair in zip(gradebook.read(answer.text), wanted, strict=True) if pair[0] != pair[1]]
    console.print(f"graded {len(gradings) - lost}, lost {lost}; gradebook in {took_s * 1e3:.0f} ms")
    for told, right in wrong[:5]:
        console.print(f"gradebook differs: {told}, must be {right}")
    console.print(f"gradebook {'differs' if wrong else 'equals the independent recomputation'}")
    return 1 if lost or wrong else 0


def milliseconds(times: Sequence[float]) -> str:
    """Return percentiles of times in seconds as text."""
    ordered = sorted(times)
    if not ordered:
        return "none"
    parts = [f"p{share} {ordered[(len(ordered) - 1) * share // 100] * 1e3:.0f}" for share in _PERCENTILES]
    return f"{', '.join(parts)}, max {ordered[-1] * 1e3:.0f} ms"


def _instant(document: dict[str, Any], name: str) -> float:
    return datetime.fromisoformat(document[name]).timestamp()


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.load", description=__doc__)
    parser.add_argument("profile", nargs="?", choices=("class", "deadline"), default="class")
    parser.add_argument("--students", type=int, default=300)
    parser.add_argument("--attempts", type=int, default=3)
    parser.add_argument("--uploads", type=int, help="only the first so many")
    parser.add_argument("--per-second", type=float, default=30.0, help="class: uploads in a second")
    parser.add_argument("--minutes", type=float, default=10.0, help="deadline: length of the evening")
    parser.add_argument("--speed-up", type=float, default=1.0, help="deadline: so many times faster")
    parser.add_argument("--apis", type=int, default=0, help="processes of `grader serve`")
    parser.add_argument("--workers", type=int, default=-1, help="processes of `grader worker`; 0: in the API")
    parser.add_argument(
        "--database",
        help="embedded (default of `class`), postgres (of `deadline`: a server of its own), or a URL",
    )
    parser.add_argument("--seed", type=int, default=7)
    parser.add_argument("--gradebook", type=Path, metavar="FILE", help="write the gradebook there")
    options = parser.parse_args()
    if options.database is None:
        options.database = "postgres" if options.profile == "deadline" else "embedded"
    scaled = options.database != "embedded"
    options.apis = options.apis or (2 if scaled else 1)
    options.workers = options.workers if options.workers >= 0 else (2 if scaled else 0)
    if options.profile == "deadline" and options.uploads is None:
        options.uploads = 2_000
    return options


if __name__ == "__main__":
    sys.exit(main())
