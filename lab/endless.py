"""Scripts that never end, on a host that is busy with other things: each must end as the student's CPU limit.

Beside busy processes a service grades a class, first alone, then while others hand in each of the loops of
`lab.hostile` several times, or the files named on the command line.

Exit code 1 if one of these does not end as ``cpu_limit`` in its first or second try (files: not as an attempt), if
a classmate's grading is wrong or fails, or if classmates wait longer than their share: of two slots one is left.
"""

from __future__ import annotations

import argparse
import asyncio
import multiprocessing
import os
import signal
import statistics
import sys
import tempfile
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from datetime import datetime
from pathlib import Path
from typing import Any, Final

import httpx
from rich.console import Console

from benchmarks.classroom import Script, Upload, graded_scripts, roster
from benchmarks.handing_in import HandingIn, Sent
from benchmarks.load import read_all
from benchmarks.processes import INSTRUCTOR, Service
from lab.hostile import LOOPS

MOST_TRIES: Final = 2
SHARE: Final = 2.5
"""So many times as long as alone may classmates wait: twice for the slot that is taken, and chance."""
_LOOK_S: Final = 5.0


def main() -> int:
    """Hand everything in, print what became of it, return the exit code."""
    options = _options()
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # so that all processes end with this one
    scripts = {path.stem: path.read_bytes() for path in options.file} or LOOPS
    known = graded_scripts()
    with ExitStack() as stack:
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="grader-endless-")))
        service = stack.enter_context(Service(folder))
        stack.enter_context(_busy(options.busy))
        return Test(service, options, known).run(scripts)


class Test:
    """One run against a service that has just been started."""

    def __init__(self, service: Service, options: argparse.Namespace, known: Sequence[Script]) -> None:
        self._options, self._known = options, known
        self._class = roster(options.classmates)
        self._service = service
        self._tell = Console().print

    def run(self, scripts: Mapping[str, bytes]) -> int:
        """Grade the class alone, then beside `scripts`; return the exit code."""
        tokens = self._service.enrol([*self._class, *scripts])
        self._handing_in = HandingIn(self._service.urls, tokens)
        self._headers = {"Authorization": f"Bearer {tokens[INSTRUCTOR]}"}
        alone_s, missed = self._judge_class(self._graded(self._uploads_of_class(0)))
        endless = [
            Upload(name, number, Script("square", f"{name}.py", source, right=False))
            for number in range(self._options.times)
            for name, source in scripts.items()
        ]
        gradings = self._graded([*((0.0, one) for one in endless), *self._uploads_of_class(1)])
        beside_s, more = self._judge_class([one for one in gradings if one[0].upload.student in self._class])
        missed += more
        if beside_s > SHARE * alone_s:
            missed.append(f"classmates waited {beside_s:.1f} s in the median, alone {alone_s:.1f} s")
        verdict = None if self._options.file else "cpu_limit"
        missed += self._judge_endless([one for one in gradings if one[0].upload.student in scripts], verdict)
        for bar in missed:
            self._tell(f"missed: {bar}", style="bold red")
        return 1 if missed else 0

    def _uploads_of_class(self, attempt: int) -> list[tuple[float, Upload]]:
        """Return what the class hands in, and when."""
        return [
            (number * self._options.every, Upload(student, attempt, self._known[number % len(self._known)]))
            for number, student in enumerate(self._class)
        ]

    def _graded(self, uploads: Sequence[tuple[float, Upload]]) -> list[tuple[Sent, dict[str, Any]]]:
        """Hand `uploads` in; return each with its document once none waits any more."""
        before = len(self._handing_in.sent)
        asyncio.run(self._handing_in.run([one for _, one in uploads], [at_s for at_s, _ in uploads]))
        sent = self._handing_in.sent[before:]
        deadline_s = time.monotonic() + self._options.patience
        ended: set[int] = set()
        while True:
            try:
                gradings = asyncio.run(read_all(sent, self._headers))
            except httpx.RemoteProtocolError:  # a connection that was kept was closed at this very moment
                continue
            ended = self._tell_progress(sent, gradings, ended)
            if all(one["finished_at"] for one in gradings) or time.monotonic() > deadline_s:
                return list(zip(sent, gradings, strict=True))
            time.sleep(_LOOK_S)

    def _tell_progress(
        self, sent: Sequence[Sent], gradings: Sequence[dict[str, Any]], known: set[int]
    ) -> set[int]:
        """Tell which scripts have ended beside those that are `known` to have; return all: it takes long."""
        ended = {number for number, told in enumerate(gradings) if told["finished_at"]}
        for number in sorted(ended - known):
            if (name := sent[number].upload.student) not in self._class:
                self._tell(f"{name} ended, {len(ended)} of {len(sent)} gradings are done")
        return ended

    def _judge_class(self, gradings: Sequence[tuple[Sent, dict[str, Any]]]) -> tuple[float, list[str]]:
        """Return the median wait, and what went wrong."""
        waits = [_waited_s(told) for _, told in gradings]
        turns = [_between_s(told, "received_at", "started_at") for _, told in gradings]
        self._tell(
            f"class: waited {statistics.median(waits):.1f} s in the median, {max(waits):.1f} s at most, "
            f"{statistics.median(turns):.1f} and {max(turns):.1f} s of it for a slot"
        )
        return statistics.median(waits), [
            f"{sent.upload.script.name}: {told['status']} {told['score']}"
            for sent, told in gradings
            if told["status"] != "graded" or abs(told["score"] - sent.upload.script.score) > 1e-9
        ]

    def _judge_endless(
        self, gradings: Sequence[tuple[Sent, dict[str, Any]]], verdict: str | None
    ) -> list[str]:
        missed = []
        for sent, told in sorted(gradings, key=lambda one: one[0].upload.student):
            name = sent.upload.student
            ended = told["verdict"] if told["status"] == "graded" else told["status"]
            self._tell(f"{name}: {ended} in try {told['tries']} after {_waited_s(told):.0f} s")
            if told["status"] != "graded" or ended not in (verdict or ended,) or told["tries"] > MOST_TRIES:
                missed.append(f"{name} ended as {ended} in try {told['tries']}")
        return missed


@contextmanager
def _busy(count: int) -> Iterator[None]:
    """Keep the host busy with `count` processes."""
    processes = [multiprocessing.Process(target=_compute, daemon=True) for _ in range(count)]
    for process in processes:
        process.start()
    try:
        yield
    finally:
        for process in processes:
            process.kill()
            process.join()


def _compute() -> None:
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    os.setsid()  # another program's: where the kernel groups processes by session, it has a share of its own
    while True:
        pass


def _waited_s(told: Mapping[str, Any]) -> float:
    """Return how long a submission has waited for its report; for ever, if it has none."""
    return _between_s(told, "received_at", "finished_at")


def _between_s(told: Mapping[str, Any], first: str, then: str) -> float:
    """Return the time between two events of a submission's life; for ever, if the second has not come."""
    if told[then] is None:
        return float("inf")
    begun, ended = (datetime.fromisoformat(told[name]) for name in (first, then))
    return (ended - begun).total_seconds()


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m lab.endless", description=__doc__)
    parser.add_argument("file", nargs="*", type=Path, help="handed in instead of the loops")
    parser.add_argument("--busy", type=int, default=8, help="processes beside the service")
    parser.add_argument("--times", type=int, default=3, help="how often each script is handed in")
    parser.add_argument("--classmates", type=int, default=10)
    parser.add_argument("--every", type=float, default=20.0, help="seconds between two uploads of the class")
    parser.add_argument("--patience", type=float, default=3_600.0, help="seconds to wait for the last one")
    return parser.parse_args()


if __name__ == "__main__":
    sys.exit(main())
