"""How many workers a deadline evening needs: a simulation of the queue from measured grading times.

Submissions come as on the evening of a deadline, ever denser towards it (`benchmarks.handing_in.evening`), wait in
order of arrival, and are graded by so many slots; how long one takes is drawn from a sample that `--measure` takes
on this machine and keeps in ``benchmarks/service_times.json``. All chance is seeded.

Writes the table of docs/capacity.md and draws ``docs/images/capacity.png``. `--validate` says what
the simulation expects of a run of ``benchmarks.load deadline``, to be compared with what that printed.
"""

from __future__ import annotations

import argparse
import heapq
import json
import math
import os
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table

from benchmarks import classroom, listeners
from benchmarks.handing_in import evening
from benchmarks.processes import tree
from grader.grading.slot import Slot, SlotConfig

ROOT = Path(__file__).resolve().parent.parent
TIMES = Path(__file__).with_name("service_times.json")
PAGE = ROOT / "docs" / "capacity.md"
PICTURE = ROOT / "docs" / "images" / "capacity.png"
EVENING_S = 6 * 3_600.0
SIZES = (2_000, 20_000, 50_000, 100_000, 300_000, 1_000_000)
WAITS_S = (10.0, 60.0, 600.0)
CURVES = (300_000, 1_000_000)
BYTES_PER_SUBMISSION = 19_300
"""Measured: a database of `benchmarks.seeded_class` divided by its submissions."""

_BEGIN, _END = "<!-- made by benchmarks.capacity -->", "<!-- end -->"
_SHARES = (0.4, 0.6, 0.8, 1.0, 1.2)  # of the slots that the busiest two minutes keep busy
_SAMPLE = 400
LISTENERS = "listeners"
"""Where the file of times has the class whose scripts all steer by the pose."""
_KEPT_QUANTILES = 201
_SEED = 7

Seconds = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Waits:
    """What an evening was like: seconds from arrival to the report, by submission in order of arrival."""

    arrived: Seconds
    took: Seconds

    def percentile(self, share: float) -> float:
        """Return the time within which `share` per cent were graded."""
        return float(np.percentile(self.took, share))


def arrivals(count: int, seconds: float = EVENING_S, seed: int = _SEED) -> Seconds:
    """Return `count` instants of a deadline evening."""
    return np.array(evening(count, seconds, seed))


def service_times(count: int, quantiles: Sequence[float], seed: int = _SEED) -> Seconds:
    """Draw `count` grading times from a distribution given by its quantiles, evenly spaced."""
    chance = np.random.default_rng(seed)
    places = np.linspace(0.0, 1.0, len(quantiles))
    return np.interp(chance.random(count), places, quantiles)


def simulate(arrived: Seconds, service: Seconds, slots: int) -> Waits:
    """Serve in order of arrival: each takes the slot that is free first."""
    free = [0.0] * slots
    done = np.empty_like(arrived)
    for number, (instant, needed) in enumerate(zip(arrived.tolist(), service.tolist(), strict=True)):
        end = max(instant, free[0]) + needed
        heapq.heapreplace(free, end)
        done[number] = end
    return Waits(arrived, done - arrived)


def slots_needed(arrived: Seconds, service: Seconds, within_s: float) -> int:
    """Return the fewest slots with which 95 of 100 are graded within `within_s`."""
    slots = 1
    while np.percentile(_as_one_quick_slot(arrived, service / slots), 95) > within_s:
        slots += max(1, slots // 50)
    while simulate(arrived, service, slots).percentile(95) > within_s:
        slots += 1
    while slots > 1 and simulate(arrived, service, slots - 1).percentile(95) <= within_s:
        slots -= 1
    return slots


def _as_one_quick_slot(arrived: Seconds, service: Seconds) -> Seconds:
    """Return how long each takes with one slot: close to many slots that are each as many times slower.

    D. V. Lindley's recursion for the time of departure, unrolled so that numpy does it.
    """
    worked = np.cumsum(service)
    idle = np.maximum.accumulate(arrived - (worked - service))
    took: NDArray[np.float64] = worked + idle - arrived
    return took


def measured() -> dict[str, object]:
    """Grade samples of what two classes hand in; return what each grading cost and where that is from."""
    return {
        "measured_at": datetime.now(UTC).date().isoformat(),
        "machine": _processor(),
        **_sample(list(classroom.scripts())),
        LISTENERS: _sample(list(listeners.scripts())),
    }


def _sample(scripts: Sequence[classroom.Script]) -> dict[str, object]:
    """Grade a sample of what a class with these scripts hands in.

    Processor time, because a grading computes from beginning to end: on a core of its own, that is how long
    it takes, and others on the machine change it little.
    """
    plan = classroom.plan(scripts, classroom.roster(100), 3, _SEED)
    jobs = [classroom.job(one.script) for one in plan if one.kind == "fresh"][:: max(1, len(plan) // _SAMPLE)]
    times = []
    with Slot(SlotConfig()) as slot:
        slot.grade(jobs[0])
        before_s = _descendants_s()
        for one in jobs:
            jail_s = slot.grade(one).measurements.jail_cpu_s
            after_s = _descendants_s()
            times.append(after_s - before_s + jail_s)
            before_s = after_s
    quantiles = np.quantile(times, np.linspace(0.0, 1.0, _KEPT_QUANTILES))
    return {"gradings": len(times), "quantiles_s": [round(float(one), 5) for one in quantiles]}


def _descendants_s() -> float:
    """Return the processor time of this process's descendants: grading process and zygote."""
    _, *below = tree(os.getpid())
    spent_ns = 0
    for pid in below:
        for file in Path(f"/proc/{pid}/task").glob("*/schedstat"):
            with suppress(OSError):  # a student's process, which is accounted for otherwise, may be gone
                spent_ns += int(file.read_text(encoding="ascii").split()[0])
    return spent_ns / 1e9


def _processor() -> str:
    lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    return next((line.partition(":")[2].strip() for line in lines if line.startswith("model name")), "?")


def table(quantiles: Sequence[float]) -> list[tuple[str, ...]]:
    """Return, under a line of headings, the slots needed by size of the evening and acceptable wait."""
    heading = ("submissions", "in the busiest minute", *(f"within {wait:g} s" for wait in WAITS_S), "storage")
    lines: list[tuple[str, ...]] = [heading]
    for count in SIZES:
        arrived = arrivals(count)
        service = service_times(count, quantiles)
        busiest = int(np.histogram(arrived, bins=int(EVENING_S / 60))[0].max())
        needed = [slots_needed(arrived, service, wait) for wait in WAITS_S]
        size = f"{count * BYTES_PER_SUBMISSION / 1e9:.2f} GB"
        lines.append((f"{count:,}", f"{busiest:,}", *map(str, needed), size))
    return lines


def classes(told: Mapping[str, Any]) -> list[tuple[str, ...]]:
    """Return, under a line of headings, what a grading costs in each class."""
    heading = ("class", "gradings", "mean", "median", "95 of 100 within", "a second on one core")
    lines: list[tuple[str, ...]] = [heading]
    for name, sample in (("the lesson's scripts", told), ("all listen to the pose", told.get(LISTENERS))):
        if sample is not None:
            took_ms = service_times(100_000, sample["quantiles_s"]) * 1e3
            mean, median, most = np.mean(took_ms), np.median(took_ms), np.quantile(took_ms, 0.95)
            times = (f"{value:.0f} ms" for value in (mean, median, most))
            lines.append((name, str(sample["gradings"]), *times, f"{1e3 / mean:.1f}"))
    return lines


def publish(told: Mapping[str, Any], lines: Sequence[Sequence[str]], page: Path) -> None:
    """Put both tables and where their times are from between the marks of `page`."""
    source = f"Processor time of a grading on {told['machine']}, {told['measured_at']}:"
    by_class = "Slots and storage for the first class:"
    before, _, rest = page.read_text(encoding="utf-8").partition(_BEGIN)
    _, end, after = rest.partition(_END)
    text = "\n".join((source, "", *_rows(classes(told)), "", by_class, "", *_rows(lines)))
    page.write_text(f"{before}{_BEGIN}\n{text}\n{end}{after}", encoding="utf-8")


def _rows(lines: Sequence[Sequence[str]]) -> list[str]:
    """Return `lines` as a table in Markdown."""
    rows = ["| " + " | ".join(line) + " |" for line in lines]
    return [rows[0], "|" + "--:|" * len(lines[0]), *rows[1:]]


def draw(quantiles: Sequence[float], path: Path) -> None:
    """Draw how long a submission takes to be graded, by when it comes in and how many slots there are."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(10, 4.2), layout="constrained")
    for axes, count in zip(figure.subplots(1, len(CURVES)), CURVES, strict=True):
        arrived = arrivals(count)
        service = service_times(count, quantiles)
        edges = np.linspace(0.0, EVENING_S, 181)
        bins = np.digitize(arrived, edges)
        peak = float(np.mean(service)) * np.histogram(arrived, edges)[0].max() / (edges[1] - edges[0])
        for slots in sorted({math.ceil(share * peak) for share in _SHARES}):
            took = simulate(arrived, service, slots).took
            longest = [np.percentile(took[bins == number], 95) for number in range(1, len(edges))]
            axes.plot(edges[1:] / 3_600 - 6, longest, label=f"{slots} slot{'s' if slots > 1 else ''}")
        axes.set_yscale("log")
        axes.set_title(f"{count:,} submissions in an evening")
        axes.set_xlabel("hours to the deadline")
        axes.set_ylabel("time to the report in s (95th percentile)")
        axes.grid(visible=True, which="both", alpha=0.25)
        axes.legend(loc="upper left")
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=110, metadata={"Software": None})


def main() -> None:
    """Measure if asked to; then print the table and draw the picture, or check a measured run."""
    options = _options()
    console = Console()
    if options.measure or not TIMES.exists():
        TIMES.write_text(json.dumps(measured(), indent=1) + "\n", encoding="utf-8")
    told = json.loads(TIMES.read_text(encoding="utf-8"))
    quantiles = told["quantiles_s"]
    console.print(f"grading times of {told['measured_at']}: {told['gradings']} on {told['machine']}")
    if options.validate:
        _validate(console, quantiles, options)
        return
    lines = table(quantiles)
    publish(told, lines, PAGE)
    draw(quantiles, PICTURE)
    for rows in (classes(told), lines):
        shown = Table(*rows[0])
        for line in rows[1:]:
            shown.add_row(*line)
        console.print(shown)


def _validate(console: Console, quantiles: Sequence[float], options: argparse.Namespace) -> None:
    """Print what the simulation says about a run of `benchmarks.load deadline`."""
    arrived = arrivals(options.uploads, options.minutes * 60.0, options.seed)
    service = service_times(options.uploads, quantiles)
    if options.rate:
        service *= options.slots / options.rate / float(np.mean(service))
    waits = _slower_at_first(arrived, service, options.slots, options.share)
    shares = ", ".join(f"p{share} {waits.percentile(share):.2f}" for share in (50, 95, 99))
    console.print(f"time to grade: {shares}, max {waits.took.max():.2f} s")


def _slower_at_first(arrived: Seconds, service: Seconds, slots: int, share: float) -> Waits:
    """Do what `simulate` does where gradings have only a `share` of the processors until the last arrival.

    On a clock that runs `share` times as fast until then, every grading takes what it needs.
    """
    last = arrived[-1]
    done = arrived * share + simulate(arrived * share, service, slots).took
    done = np.where(done <= last * share, done / share, last + done - last * share)
    return Waits(arrived, done - arrived)


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.capacity", description=__doc__)
    parser.add_argument(
        "--measure", action="store_true", help="take the grading times anew (a quiet machine)"
    )
    parser.add_argument("--validate", action="store_true", help="only say what a deadline run must look like")
    parser.add_argument("--uploads", type=int, default=2_000, help="validate: gradings of the run")
    parser.add_argument("--minutes", type=float, default=10.0, help="validate: its length, after speed-up")
    parser.add_argument("--slots", type=int, default=2, help="validate: gradings at once")
    parser.add_argument("--rate", type=float, help="validate: gradings a second once nothing more comes in")
    parser.add_argument("--share", type=float, default=1.0, help="validate: how much of that before")
    parser.add_argument("--seed", type=int, default=_SEED)
    return parser.parse_args()


if __name__ == "__main__":
    main()
