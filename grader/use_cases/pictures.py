"""Plots of recorded runs: one thread draws them from stored gradings, and the latest ones are cached."""

import asyncio
from collections import OrderedDict
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Protocol

from grader.checks import sketch
from grader.contracts.assignment import Assignment
from grader.contracts.figure import PictureForm
from grader.contracts.report import GradeReport, report_from
from grader.contracts.scoring import Run
from grader.contracts.submission import StoredReport
from grader.contracts.text import Language
from grader.contracts.trajectory import decode_trajectory


@dataclass(frozen=True, slots=True, kw_only=True)
class PlotSpec:
    """Which run of a grading is to be drawn, in which language and file format."""

    case: str
    language: Language
    form: PictureForm = "png"


class Plotter(Protocol):
    """Draws one graded run."""

    def __call__(
        self, assignment: Assignment, report: StoredReport, trajectory: bytes, spec: PlotSpec
    ) -> bytes:
        """Return the picture. `trajectory` is the JSON of the run that `spec` names."""


class PlotCache:
    """The plots drawn last, by digest of the report and by `PlotSpec`.

    A report's digest covers the digests of its trajectories, so equal keys mean equal plots. A thread of its own
    draws: a class that looks at its plots must not take the threads that uploads need, and matplotlib draws one
    plot at a time anyway.
    """

    def __init__(self, plotter: Plotter, entries: int) -> None:
        self._plotter = plotter
        self._entries = entries
        self._plots: OrderedDict[tuple[str, int, PlotSpec], bytes] = OrderedDict()
        self._thread = ThreadPoolExecutor(max_workers=1, thread_name_prefix="grader-plot")

    async def get(
        self, assignment: Assignment, report: StoredReport, trajectory: bytes, spec: PlotSpec
    ) -> bytes:
        """Return the picture, from the cache or drawn now."""
        future = self._thread.submit(self._get, assignment, report, trajectory, spec)
        return await asyncio.wrap_future(future)

    def close(self) -> None:
        """Draw nothing more."""
        self._thread.shutdown(wait=True, cancel_futures=True)

    def _get(self, assignment: Assignment, report: StoredReport, trajectory: bytes, spec: PlotSpec) -> bytes:
        key = (report.sha256, assignment.version, spec)
        picture = self._plots.pop(key, None)
        if picture is None:
            picture = self._plotter(assignment, report, trajectory, spec)
        self._plots[key] = picture
        while len(self._plots) > self._entries:
            self._plots.popitem(last=False)
        return picture


def draw_stored(assignment: Assignment, report: StoredReport, trajectory: bytes, spec: PlotSpec) -> bytes:
    """Draw one graded run with matplotlib, as a `Plotter`."""
    graded = report_from(report.content)
    return draw(assignment, graded, trajectory, spec.language, spec.form, case=spec.case)


def draw(  # noqa: PLR0913
    assignment: Assignment,
    report: GradeReport,
    trajectory: bytes,
    language: Language,
    form: PictureForm = "png",
    *,
    case: str | None = None,
) -> bytes:
    """Return the plot of one of the report's runs, without a `case` the first; the figure is measured again.

    `assignment`: the version that was graded. `trajectory`: of that run, as `grader.contracts.encode_trajectory`
    wrote it.
    """
    from grader.render.plot import plot  # matplotlib takes a second to import

    motion = decode_trajectory(trajectory)
    run = report.run_of(case)
    assert run is not None  # the trajectory is of this run
    figure = sketch(assignment, Run(trajectory=motion, outcome=run.outcome, case=run.case))
    return plot(assignment, report, motion, figure, language, form=form, case=run.case)
