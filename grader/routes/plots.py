"""Plots of trajectories, drawn off the event loop, one at a time, and remembered."""

import asyncio
from collections import OrderedDict
from concurrent.futures import ThreadPoolExecutor
from typing import Protocol

from grader.contracts.assignment import Assignment
from grader.contracts.submission import StoredReport
from grader.contracts.text import Language


class Plotter(Protocol):
    """Draws one graded run."""

    def __call__(
        self, assignment: Assignment, report: StoredReport, trajectory: bytes, language: Language
    ) -> bytes:
        """Return a PNG. `trajectory` is the JSON of the report's first run."""


class PlotCache:
    """The last plots drawn, by digest of the report and language.

    A report's digest covers the digests of its trajectories, so equal keys mean equal plots. One thread of
    its own draws: a class that looks at its plots must not take the threads that uploads need, and
    matplotlib wants one drawing at a time anyway.
    """

    def __init__(self, plotter: Plotter, entries: int) -> None:
        self._plotter = plotter
        self._entries = entries
        self._plots: OrderedDict[tuple[str, int, Language], bytes] = OrderedDict()
        self._thread = ThreadPoolExecutor(max_workers=1, thread_name_prefix="grader-plot")

    async def get(
        self, assignment: Assignment, report: StoredReport, trajectory: bytes, language: Language
    ) -> bytes:
        """Return the PNG, drawn now or before."""
        future = self._thread.submit(self._get, assignment, report, trajectory, language)
        return await asyncio.wrap_future(future)

    def close(self) -> None:
        """Draw nothing more."""
        self._thread.shutdown(wait=True, cancel_futures=True)

    def _get(
        self, assignment: Assignment, report: StoredReport, trajectory: bytes, language: Language
    ) -> bytes:
        key = (report.sha256, assignment.version, language)
        png = self._plots.pop(key, None)
        if png is None:
            png = self._plotter(assignment, report, trajectory, language)
        self._plots[key] = png
        while len(self._plots) > self._entries:
            self._plots.popitem(last=False)
        return png
