"""Measurements for Prometheus: counted in this process, or read from the rows when somebody asks.

Every label has few values: no student, no submission and no address as it was sent is ever one.
"""

import logging
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from importlib.metadata import version

from prometheus_client import (
    CollectorRegistry,
    Counter,
    Gauge,
    Histogram,
    Info,
    ProcessCollector,
    generate_latest,
    start_http_server,
)
from prometheus_client.core import GaugeMetricFamily, Metric
from prometheus_client.registry import Collector

from grader import __version__
from grader.contracts.errors import InfrastructureError, SettingsError
from grader.contracts.report import GradeStatus
from grader.contracts.submission import WorkerState
from grader.contracts.telemetry import ServiceState

_log = logging.getLogger(__name__)

MEDIA_TYPE = "text/plain; version=0.0.4; charset=utf-8"
_GRADING_S = (0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 60)
_WAITED_S = (0.5, 1, 2, 5, 10, 30, 60, 300, 900, 3600)
_REQUEST_S = (0.005, 0.02, 0.05, 0.1, 0.25, 1, 5)


class Metrics:
    """The measurements of one process, in a registry of its own.

    Args:
        state: reads the rows; called once per scrape. None: only what this process counts.
    """

    def __init__(self, state: Callable[[], ServiceState] | None = None) -> None:
        self.registry = registry = CollectorRegistry()
        ProcessCollector(registry=registry)
        if state is not None:
            registry.register(_RowCollector(state))
        build = Info("grader_build", "What runs here.", registry=registry)
        build.info({"version": __version__, "simulator": f"pybullet {version('pybullet')}"})
        self._count_gradings(registry)
        self._count_requests(registry)

    def _count_gradings(self, registry: CollectorRegistry) -> None:
        self._gradings = Counter(
            "grader_gradings", "Gradings stored by this process.", ["verdict"], registry=registry
        )
        self._grading_s = Histogram(
            "grader_grading_seconds",
            "From a claim until its grading was stored.",
            buckets=_GRADING_S,
            registry=registry,
        )
        self._waited_s = Histogram(
            "grader_time_to_grade_seconds",
            "From the queueing of a submission until its grading was stored.",
            buckets=_WAITED_S,
            registry=registry,
        )
        self._retries = Counter(
            "grader_retries", "Tries that failed through the grader's own fault.", registry=registry
        )
        self._lost = Counter(
            "grader_given_up", "Submissions whose last try failed: no grade.", registry=registry
        )

    def _count_requests(self, registry: CollectorRegistry) -> None:
        self._uploads = Counter(
            "grader_uploads",
            "Uploads by what they were answered: accepted, repeated, or the problem's code.",
            ["code"],
            registry=registry,
        )
        self._request_s = Histogram(
            "grader_http_request_seconds",
            "Requests by the template of their route; streams of events count until they end.",
            ["method", "route", "status"],
            buckets=_REQUEST_S,
            registry=registry,
        )
        self._streams = Gauge("grader_event_streams", "Streams of events that are open.", registry=registry)

    def graded(self, verdict: GradeStatus, grading_s: float, waited_s: float) -> None:
        """Count a grading that was stored, `grading_s` after its claim and `waited_s` after it was queued."""
        self._gradings.labels(verdict.value).inc()
        self._grading_s.observe(grading_s)
        self._waited_s.observe(waited_s)

    def retried(self, tries: int = 1) -> None:
        """Count tries that failed and are made again."""
        self._retries.inc(tries)

    def given_up(self, submissions: int = 1) -> None:
        """Count submissions that end without a grade."""
        self._lost.inc(submissions)

    def uploaded(self, code: str) -> None:
        """Count an upload. `code` is ``accepted``, ``repeated`` or the code of a problem."""
        self._uploads.labels(code).inc()

    def requested(self, method: str, route: str, status: int, duration_s: float) -> None:
        """Count a request. `route` is a template such as ``/api/v1/submissions/{submission_id}``."""
        self._request_s.labels(method, route, str(status)).observe(duration_s)

    def measure_streams(self, streams: Callable[[], float]) -> None:
        """Ask `streams` at each scrape how many streams of events are open."""
        self._streams.set_function(streams)

    def exposition(self) -> bytes:
        """Return everything in Prometheus' text format (`MEDIA_TYPE`)."""
        return generate_latest(self.registry)


@contextmanager
def exported(metrics: Metrics, port: int, host: str = "127.0.0.1") -> Iterator[int]:
    """Answer GET /metrics on a port of its own while the context lasts; for processes that serve no HTTP.

    Nobody is asked who they are: `host` must not be reachable by those who should not see it.

    Yields:
        The port; `port` 0 takes a free one.

    Raises:
        SettingsError: the port is taken or not allowed.
    """
    try:
        server, thread = start_http_server(port, host, metrics.registry)
    except OSError as error:
        raise SettingsError(
            f"metrics_port: cannot listen on {host}:{port}: {error.strerror}",
            f"metrics_port：无法监听 {host}:{port}：{error.strerror}",
        ) from error
    try:
        yield server.server_port
    finally:
        server.shutdown()
        server.server_close()
        thread.join()


# -------------------------------------------------------------------- what is read from the rows at each scrape


class _RowCollector(Collector):
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
        if state.free_bytes is not None:
            yield GaugeMetricFamily(
                "grader_disk_free_bytes", "Room on the database's disk.", value=state.free_bytes
            )


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
        "grader_oldest_queued_seconds",
        "How long the first fresh submission has waited.",
        value=age_s,
    )


def _workers(workers: tuple[WorkerState, ...]) -> Iterable[Metric]:
    ready = [worker for worker in workers if worker.sandbox_ready and worker.slots > 0]
    yield GaugeMetricFamily("grader_workers_alive", "Workers heard of lately.", value=len(workers))
    yield GaugeMetricFamily(
        "grader_sandbox_ready", "1 while some worker has a working sandbox.", value=int(bool(ready))
    )
    yield GaugeMetricFamily(
        "grader_slots", "Gradings that can run at once.", value=sum(worker.slots for worker in ready)
    )
    yield GaugeMetricFamily(
        "grader_slots_busy", "Gradings that run.", value=sum(worker.busy for worker in workers)
    )
