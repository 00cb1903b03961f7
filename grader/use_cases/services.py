"""What use cases work with, made by the composition root."""

from collections.abc import Callable
from contextlib import AbstractContextManager
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

from grader.contracts.grading import Preflight
from grader.contracts.identity import Caller
from grader.contracts.python import Self
from grader.contracts.submission import QueueState, WorkerState
from grader.grading.practice import PracticeRuns
from grader.live.cars import LiveCars
from grader.operation.metrics import Metrics
from grader.operation.settings import Settings
from grader.outside.lti import Launches
from grader.outside.lti.scores import PlatformChannel, Signer, new_key
from grader.outside.notices.bots import BotChannel
from grader.outside.notices.mail import MailChannel
from grader.outside.signin import Providers
from grader.store.appeals import Appeals
from grader.store.audit import AuditLog, Signature
from grader.store.clock import Clock
from grader.store.comments import Comments
from grader.store.costs import Costs
from grader.store.course_life import CourseLife
from grader.store.courses import Courses
from grader.store.dashboard import Dashboard
from grader.store.database import Database
from grader.store.drafts import Drafts
from grader.store.explanations import Explanations
from grader.store.identities import Identities
from grader.store.intake import Intake
from grader.store.judgements import Judgements
from grader.store.notices import Notices
from grader.store.own_assignments import OwnAssignments
from grader.store.phrases import Phrases
from grader.store.pinned import Pinned
from grader.store.platform_scores import PlatformScores
from grader.store.platforms import Platforms
from grader.store.queue import Queue, Retries
from grader.store.receipts import Receipts
from grader.store.refused import RefusedUploads
from grader.store.regrades import Regrades
from grader.store.rules import StoredRules
from grader.store.scripts import Scripts
from grader.store.standings import Measures, Standings
from grader.store.submissions import Submissions
from grader.store.teams import Teams
from grader.store.tokens import Tokens
from grader.store.work import Doorbell
from grader.store.workers import Workers
from grader.use_cases.callers import Allowances, Callers
from grader.use_cases.comparing import Comparer
from grader.use_cases.course_assignments import CourseAssignments
from grader.use_cases.following import Estimates, Watching, WatchLimits
from grader.use_cases.pictures import PlotCache
from grader.use_cases.space import SpaceCounter

_LEAST_FREE_BYTES = 64 << 20  # a minute of uploads, and room for the log of a checkpoint


@dataclass(frozen=True, slots=True, kw_only=True)
class ServiceHealth:
    """Whether the service does its work: what waits, and the workers that were heard of lately."""

    queue: QueueState
    workers: tuple[WorkerState, ...]
    free_bytes: int | None

    @property
    def disk_is_full(self) -> bool:
        """Whether uploads are refused, or soon will be, because the database's disk has no room."""
        return self.free_bytes is not None and self.free_bytes < _LEAST_FREE_BYTES

    @property
    def ready(self) -> tuple[WorkerState, ...]:
        """Return the workers that grade; while there are none, uploads are only kept."""
        return tuple(worker for worker in self.workers if worker.sandbox_ready and worker.slots > 0)


@dataclass(frozen=True, slots=True, kw_only=True)
class Services:
    """Everything a use case may work with.

    Attributes:
        callers: recognises who asks, by token.
        providers: who else recognises people. launches: reads what learning platforms say of people.
        platform_channel: tells them what people reached.
        bots: speak in group chats. mail: sends e-mail; None: the operator has set up none.
        allowances: how much each of them may ask for.
    """

    settings: Settings
    clock: Clock
    assignments: CourseAssignments
    preflight: Preflight

    # who asks, and how often
    callers: Callers
    allowances: Allowances
    providers: Providers
    launches: Launches
    platform_channel: PlatformChannel
    bots: BotChannel
    mail: MailChannel | None

    # the database: one snapshot for what one thread reads within the context; and by subject
    snapshot: Callable[[], AbstractContextManager[object]]
    intake: Intake
    submissions: Submissions
    explanations: Explanations
    queue: Queue
    workers: Workers
    regrades: Regrades
    judgements: Judgements
    comments: Comments
    phrases: Phrases
    pinned: Pinned
    drafts: Drafts
    teams: Teams
    appeals: Appeals
    dashboard: Dashboard
    costs: Costs
    refused: RefusedUploads
    receipts: Receipts
    rules: StoredRules
    own_assignments: OwnAssignments
    courses: Courses
    course_life: CourseLife
    tokens: Tokens
    identities: Identities
    platforms: Platforms
    platform_scores: PlatformScores
    notices: Notices
    audit: AuditLog

    # kept in this process: what wakes those who wait for work or news, drawn plots, compared scripts, counted
    # room, streams of events with their estimates, measurements, live cars (of its event loop), practice runs
    doorbell: Doorbell
    plots: PlotCache
    comparer: Comparer
    space: SpaceCounter
    watching: Watching
    metrics: Metrics
    live: LiveCars
    practice: PracticeRuns

    def signature(self, caller: Caller) -> Signature:
        """Return when and by whom a change is made, for the audit log: now, by `caller`."""
        return Signature(self.clock(), caller.course, caller.signature)

    def health(self) -> ServiceHealth:
        """Return the state of the queue and of all workers that are alive."""
        return ServiceHealth(
            queue=self.queue.state(),
            workers=self.workers.alive(self.settings.silent_s),
            free_bytes=self.queue.free_bytes(),
        )

    @classmethod
    def over(  # noqa: PLR0913
        cls,
        database: Database,
        settings: Settings,
        clock: Clock,
        *,
        retries: Retries,
        assignments: CourseAssignments,
        preflight: Preflight,
        plots: PlotCache,
        callers: Callers,
        live: LiveCars,
        practice: PracticeRuns,
        providers: Providers = Providers(),  # noqa: B008 - frozen
    ) -> Self:
        """Return the services that work on `database`, whose tables are up to date."""
        queue, workers = Queue(database, clock, retries), Workers(database, clock)
        doorbell, estimates = Doorbell(), Estimates(queue, workers, clock, settings.silent_s)
        watching = Watching(Standings(database), estimates, doorbell, _watch_limits(settings))
        return cls(
            settings=settings,
            clock=clock,
            assignments=assignments,
            preflight=preflight,
            callers=callers,
            providers=providers,
            **outside_channels(settings, clock, providers, Platforms(database, clock)),
            allowances=Allowances.of(settings, clock),
            queue=queue,
            workers=workers,
            **_stores(database, clock),
            doorbell=doorbell,
            plots=plots,
            comparer=Comparer(Scripts(database)),
            space=SpaceCounter(CourseLife(database, clock).space, clock),
            watching=watching,
            live=live,
            practice=practice,
            metrics=_metrics(Measures(database, workers, clock, settings.silent_s), watching),
        )


def _stores(database: Database, clock: Clock) -> dict[str, Any]:
    return {
        "snapshot": database.reading,
        "intake": Intake(database),
        "submissions": Submissions(database),
        "explanations": Explanations(database, clock),
        "regrades": Regrades(database),
        "judgements": Judgements(database),
        "comments": Comments(database),
        "phrases": Phrases(database),
        "pinned": Pinned(database),
        "drafts": Drafts(database),
        "teams": Teams(database),
        "appeals": Appeals(database),
        "dashboard": Dashboard(database, clock),
        "rules": StoredRules(database),
        "audit": AuditLog(database),
        "costs": Costs(database, clock),
        "refused": RefusedUploads(database, clock),
        "receipts": Receipts(database),
        "own_assignments": OwnAssignments(database, clock),
        "courses": Courses(database, clock),
        "course_life": CourseLife(database, clock),
        "tokens": Tokens(database, clock),
        "identities": Identities(database, clock),
        "platforms": Platforms(database, clock),
        "platform_scores": PlatformScores(database, clock),
        "notices": Notices(database, clock),
    }


def outside_channels(
    settings: Settings, clock: Clock, providers: Providers, platforms: Platforms
) -> dict[str, Any]:
    """Return what speaks to other servers, by the names of `Services`."""

    def clock_s() -> float:
        return clock().timestamp()

    signer_of = lru_cache(1)(Signer)  # reading a key takes forty milliseconds

    def signer() -> Signer:
        return signer_of(platforms.keys(new_key))  # another process may have made a new one

    private = providers.private_platforms
    return {
        "launches": Launches(clock_s, private=private),
        "platform_channel": PlatformChannel(signer, clock_s, private=private),
        "bots": BotChannel(clock_s, private=private),
        "mail": MailChannel.of(settings),
    }


def _watch_limits(settings: Settings) -> WatchLimits:
    return WatchLimits(
        most=settings.max_streams, most_each=settings.streams_per_person, poll_s=settings.poll_s
    )


def _metrics(measures: Measures, watching: Watching) -> Metrics:
    metrics = Metrics(measures.state)
    metrics.measure_streams(lambda: watching.streams)
    return metrics
