"""A hostile evening: honest students hand in while a few do everything at once that costs others something.

A service with its own limits, bounded like a container (512 processes, 3 GiB), takes two uploads a second of 60
students whose scores are known. Three others hand in attacks and endless scripts, upload what takes long to check,
ask for plots and reports all the time, open connections and read nothing (`lab.hostile`).

Exit code 1 if an honest grading is wrong, fails or is refused, if the honest ones wait longer than they may, if
the service grows, or if an attack is not counted as an attempt.
"""

from __future__ import annotations

import argparse
import asyncio
import random
import signal
import statistics
import sys
import tempfile
import threading
import time
from collections import Counter
from collections.abc import Sequence
from contextlib import ExitStack, suppress
from datetime import datetime
from pathlib import Path
from typing import Any, Final

import httpx
from rich.console import Console

from benchmarks.classroom import Script, Upload, graded_scripts, roster
from benchmarks.handing_in import HandingIn, Sent, steady
from benchmarks.load import milliseconds, read_all, timed
from benchmarks.processes import INSTRUCTOR, Service, proportional_mib
from lab.bounded import Bounds, bounded, hand_over
from lab.hostile import Hostile, attempts_of

WAIT_P95_S: Final = 10.0
GROWTH_MIB: Final = 64.0
_LOOK_S: Final = 2.0
_DRAIN_S: Final = 180.0
_LIMITS: Final = {"UPLOADS_PER_MINUTE": "60", "REQUESTS_PER_MINUTE": "600", "MAX_OPEN_SUBMISSIONS": "50"}
"""As they are by default: the service under test lifts them otherwise."""


class Watch(threading.Thread):
    """Looks at the memory of the service's own process, and for an honest student at a plot, all the time.

    Attributes:
        stopped: set it to have it look no more.
    """

    def __init__(self, pid: int, client: httpx.Client, sent: Sequence[Sent]) -> None:
        super().__init__(daemon=True)
        self._pid = pid
        self._client = client
        self._sent = sent
        self.stopped = threading.Event()
        self.memory_mib: list[float] = []
        self.plots_s: list[float] = []

    def run(self) -> None:
        """Look until told to stop."""
        while not self.stopped.wait(_LOOK_S):
            self.memory_mib.append(proportional_mib(self._pid))
            graded = [one for one in list(self._sent)[:-20] if one.accepted]
            if not graded:
                continue
            with suppress(httpx.HTTPStatusError):
                took_s, _ = timed(self._client, f"{graded[-1].location}/plot.png")
                self.plots_s.append(took_s)


def main() -> int:
    """Run the evening, print what was seen, return the exit code."""
    options = _options()
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # so that the service ends with this process
    console = Console()
    scripts = graded_scripts()
    with ExitStack() as stack:
        bounds = stack.enter_context(
            bounded(options.pids, options.memory_mib, options.user, namespaces=not options.no_namespaces)
        )
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="grader-abuse-")))
        hand_over(folder, bounds)
        service = stack.enter_context(Service(folder, settings=_LIMITS, enter=bounds.enter))
        console.print(f"{bounds.told()}; {options.seconds:.0f} s, seed {options.seed}")
        return Evening(service, options, console).run(scripts, bounds)


class Evening:
    """One run against a service that has just been started."""

    def __init__(self, service: Service, options: argparse.Namespace, console: Console) -> None:
        self._options = options
        self._console = console
        self._honest = roster(options.honest)
        hostile = [f"hostile{number}" for number in range(options.hostile)]
        tokens = service.enrol([*self._honest, *hostile])
        self._handing_in = HandingIn(service.urls, tokens)
        self._hostile = [
            Hostile(student, tokens[student], service.urls[0], options.seed + number)
            for number, student in enumerate(hostile)
        ]
        self._headers = {"Authorization": f"Bearer {tokens[INSTRUCTOR]}"}
        self._client = httpx.Client(
            base_url=service.urls[0], headers=self._headers, timeout=120.0, trust_env=False
        )
        pid = service.running["api0"].pid
        own = httpx.Client(base_url=service.urls[0], headers=self._headers, timeout=120.0, trust_env=False)
        self._watch = Watch(pid, own, self._handing_in.sent)

    def run(self, scripts: Sequence[Script], bounds: Bounds) -> int:
        """Let everybody hand in, then look at what became of it; return the exit code."""
        uploads = self._plan(scripts)
        at_s = steady(len(uploads), self._options.rate, self._options.seed)
        self._watch.start()
        asyncio.run(self._all_at_once(uploads, at_s))
        accepted = [one for one in self._handing_in.sent if one.accepted]
        gradings = self._graded(accepted)
        self._watch.stopped.set()
        self._watch.join()
        missed = [*self._judge_honest(accepted, gradings), *self._judge_service(), *self._judge_hostile()]
        self._console.print(bounds.most_used())
        for bar in missed:
            self._console.print(f"missed: {bar}", style="bold red")
        return 1 if missed else 0

    def _plan(self, scripts: Sequence[Script]) -> list[Upload]:
        chance = random.Random(self._options.seed)  # noqa: S311
        count = int(self._options.rate * self._options.seconds)
        return [
            Upload(self._honest[number % len(self._honest)], number, chance.choice(scripts))
            for number in range(count)
        ]

    async def _all_at_once(self, uploads: Sequence[Upload], at_s: Sequence[float]) -> None:
        attacks = [asyncio.create_task(one.run()) for one in self._hostile]
        await self._handing_in.run(uploads, at_s)
        for attack in attacks:
            attack.cancel()
        for ended in await asyncio.gather(*attacks, return_exceptions=True):
            if not isinstance(ended, asyncio.CancelledError):
                raise RuntimeError("an attack ended by itself") from ended

    def _graded(self, accepted: Sequence[Sent]) -> list[dict[str, Any]]:
        """Return the honest submissions once none waits any more; the hostile ones need not be waited for."""
        deadline_s = time.monotonic() + _DRAIN_S
        while True:
            gradings = asyncio.run(read_all(accepted, self._headers))
            is_open = any(one["status"] in ("queued", "running") for one in gradings)
            if not is_open or time.monotonic() > deadline_s:
                return gradings
            time.sleep(_LOOK_S)

    def _judge_honest(self, accepted: Sequence[Sent], gradings: Sequence[dict[str, Any]]) -> list[str]:
        codes = Counter(one.code for one in self._handing_in.sent)
        states = Counter(one["status"] for one in gradings)
        wrong = [
            (sent.upload.script.name, told["score"])
            for sent, told in zip(accepted, gradings, strict=True)
            if told["status"] == "graded" and abs(told["score"] - sent.upload.script.score) > 1e-9
        ]
        done = [one for one in gradings if one["finished_at"]]
        waits = sorted(_instant(one, "finished_at") - _instant(one, "received_at") for one in done)
        tell = self._console.print
        tell(
            f"honest: {len(self._handing_in.sent)} uploads {dict(codes)}; {dict(states)}; {len(wrong)} wrong"
        )
        tell(f"honest upload answered: {milliseconds([one.took_s for one in accepted])}")
        tell(f"honest plot drawn: {milliseconds(self._watch.plots_s)}")
        tell(f"honest wait until graded: {milliseconds(waits)}")
        tries = Counter(one["tries"] for one in gradings)
        tell(f"tries of honest gradings: {dict(sorted(tries.items()))}")
        late = bool(waits) and waits[(len(waits) - 1) * 95 // 100] > WAIT_P95_S
        bars = {
            f"{len(accepted)} of {len(self._handing_in.sent)} honest uploads were accepted": set(codes)
            != {"202"},
            f"honest submissions ended as {dict(states)}": set(states) != {"graded"},
            f"honest gradings are wrong: {wrong[:5]}": bool(wrong),
            f"95 % of the honest ones must wait at most {WAIT_P95_S:g} s": late,
        }
        return [bar for bar, is_missed in bars.items() if is_missed]

    def _judge_service(self) -> list[str]:
        seen = self._watch.memory_mib
        fifth = max(len(seen) // 5, 1)
        means = [
            statistics.fmean(part) for at in range(0, len(seen), fifth) if (part := seen[at : at + fifth])
        ]
        self._console.print(f"service's own memory, MiB: {', '.join(f'{one:.0f}' for one in means)}")
        if len(means) < 3 or means[-1] - means[1] <= GROWTH_MIB:
            return []
        return [f"the service grew by {means[-1] - means[1]:.0f} MiB"]

    def _judge_hostile(self) -> list[str]:
        missed = []
        for one in self._hostile:
            found = attempts_of(self._client, one.sent)
            self._console.print(f"{one.student}: answers {dict(one.answers)}; uploads {dict(found)}")
            if found["waived"]:
                missed.append(f"{found['waived']} uploads of {one.student} used no attempt")
        costs = self._client.get("/api/v1/dashboard/costs").raise_for_status().json()["students"]
        shares = ", ".join(f"{one['student']} {one['slot_s']:.0f} s" for one in costs[:5])
        self._console.print(f"held slots longest: {shares}")
        return missed


def _instant(document: dict[str, Any], name: str) -> float:
    return datetime.fromisoformat(document[name]).timestamp()


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m lab.abuse", description=__doc__)
    parser.add_argument("--seconds", type=float, default=600.0, help="how long uploads come")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--honest", type=int, default=60)
    parser.add_argument("--hostile", type=int, default=3)
    parser.add_argument("--rate", type=float, default=2.0, help="honest uploads in a second")
    parser.add_argument("--pids", type=int, default=512)
    parser.add_argument("--memory-mib", type=int, default=3_072)
    parser.add_argument("--user", type=int, help="run the service as this user id (default: as you are)")
    parser.add_argument(
        "--no-namespaces", action="store_true", help="refuse namespaces, as container engines do"
    )
    return parser.parse_args()


if __name__ == "__main__":
    sys.exit(main())
