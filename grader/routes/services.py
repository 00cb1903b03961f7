"""What the routes work with, handed to them by the composition root."""

from dataclasses import dataclass
from typing import Annotated, Self

from fastapi import Depends, Request

from grader.contracts.grading import AssignmentSource, Preflight
from grader.routes.access import InstructorGate
from grader.routes.estimates import Estimates
from grader.routes.limits import RateLimit
from grader.routes.plots import PlotCache
from grader.routes.watching import Watching, WatchLimits
from grader.settings import Settings
from grader.store.audit import AuditLog
from grader.store.columns import Clock
from grader.store.courses import Courses
from grader.store.dashboard import Dashboard
from grader.store.database import Database
from grader.store.doorbell import Doorbell
from grader.store.judgements import Judgements
from grader.store.measures import Measures
from grader.store.past_gradings import PastGradings
from grader.store.queue import Queue, RetryPolicy
from grader.store.regrades import Regrades
from grader.store.rules import StoredRules
from grader.store.standings import Standings
from grader.store.submissions import Submissions
from grader.store.tokens import Tokens
from grader.store.workers import Workers
from grader.telemetry.metrics import Metrics


@dataclass(frozen=True, slots=True, kw_only=True)
class Services:
    """Everything an endpoint may use.

    Attributes:
        gate: recognises the instructor of a service without courses.
        request_limit: of each student's requests. upload_limit: of each student's uploads.
    """

    settings: Settings
    clock: Clock
    assignments: AssignmentSource
    preflight: Preflight

    # who asks, and how often
    gate: InstructorGate
    request_limit: RateLimit
    upload_limit: RateLimit

    # the rows, by what they are about
    submissions: Submissions
    queue: Queue
    workers: Workers
    past_gradings: PastGradings
    regrades: Regrades
    judgements: Judgements
    dashboard: Dashboard
    rules: StoredRules
    courses: Courses
    tokens: Tokens
    audit: AuditLog

    # what is kept in this process: drawn, guessed, followed, measured
    plots: PlotCache
    estimates: Estimates
    doorbell: Doorbell
    watching: Watching
    metrics: Metrics

    @classmethod
    def over(  # noqa: PLR0913
        cls,
        database: Database,
        settings: Settings,
        clock: Clock,
        *,
        policy: RetryPolicy,
        assignments: AssignmentSource,
        preflight: Preflight,
        plots: PlotCache,
        gate: InstructorGate,
    ) -> Self:
        """Return the services over one database that is up to date."""
        queue, workers = Queue(database, clock, policy), Workers(database, clock)
        watching = _watching(database, settings, Estimates(queue, workers, clock, settings.silent_s))
        return cls(
            settings=settings,
            clock=clock,
            assignments=assignments,
            preflight=preflight,
            gate=gate,
            request_limit=RateLimit(settings.requests_per_minute, clock),
            upload_limit=RateLimit(settings.uploads_per_minute, clock),
            submissions=Submissions(database, clock),
            queue=queue,
            workers=workers,
            past_gradings=PastGradings(database),
            regrades=Regrades(database),
            judgements=Judgements(database),
            dashboard=Dashboard(database),
            rules=StoredRules(database),
            courses=Courses(database, clock),
            tokens=Tokens(database, clock),
            audit=AuditLog(database),
            plots=plots,
            estimates=watching.estimates,
            doorbell=watching.doorbell,
            watching=watching,
            metrics=_metrics(Measures(database, workers, clock, settings.silent_s), watching),
        )


def _watching(database: Database, settings: Settings, estimates: Estimates) -> Watching:
    limits = WatchLimits(
        most=settings.max_streams, most_each=settings.streams_per_person, poll_s=settings.poll_s
    )
    return Watching(Standings(database), estimates, Doorbell(), limits)


def _metrics(measures: Measures, watching: Watching) -> Metrics:
    metrics = Metrics(measures.state)
    metrics.measure_streams(lambda: watching.streams)
    return metrics


async def _services(request: Request) -> Services:
    # a coroutine runs on the event loop; any other dependency would wait for a thread
    services: Services = request.app.state.services
    return services


ServicesDep = Annotated[Services, Depends(_services)]
