"""What is measured of queue and workers: read from the rows at each scrape, the same from every process."""

import logging
from collections.abc import Callable, Iterable

from prometheus_client.core import GaugeMetricFamily, Metric
from prometheus_client.registry import Collector

from grader.contracts.errors import InfrastructureError
from grader.contracts.submission import WorkerState
from grader.contracts.telemetry import ServiceState

_log = logging.getLogger(__name__)


class RowCollector(Collector):
    """Reads the rows once per scrape; says ``grader_database_up 0`` and nothing else when they cannot be read."""

    def __init__(self, state: Callable[[], ServiceState]) -> None:
        self._state = state

    def describe(self) -> Iterable[Metric]:
        """Return nothing: the registry then need not read the database to learn the names."""
        return ()

    def collect(self) -> Iterable[Metric]:
        """Yield the gauges."""
        up = GaugeMetricFamily("grader_database_up", "Whether the database answers.")
        try:
            state = self._state()
        except InfrastructureError as error:
            _log.error("nothing of the database can be measured: %s", error)
            up.add_metric([], 0)
            yield up
            return
        up.add_metric([], 1)
        yield up
        yield from _queue(state)
        yield from _workers(state.workers)


def _queue(state: ServiceState) -> Iterable[Metric]:
    depth = GaugeMetricFamily(
        "grader_submissions", "Submissions by state; priority 0 is fresh.", labels=["state", "priority"]
    )
    for one in state.depths:
        depth.add_metric([one.state, str(one.priority)], one.count)
    yield depth
    oldest = state.oldest_queued_at
    age_s = 0.0 if oldest is None else max((state.at - oldest).total_seconds(), 0.0)
    yield GaugeMetricFamily(
        "grader_oldest_queued_seconds", "How long the first submission has been waiting.", value=age_s
    )


def _workers(workers: tuple[WorkerState, ...]) -> Iterable[Metric]:
    ready = [one for one in workers if one.sandbox_ready and one.slots > 0]
    yield GaugeMetricFamily("grader_workers_alive", "Workers heard of lately.", value=len(workers))
    yield GaugeMetricFamily(
        "grader_sandbox_ready", "1 while some worker has a working sandbox.", value=int(bool(ready))
    )
    yield GaugeMetricFamily(
        "grader_slots", "Gradings that can run at once.", value=sum(one.slots for one in ready)
    )
    yield GaugeMetricFamily("grader_slots_busy", "Gradings that run.", value=sum(one.busy for one in workers))
