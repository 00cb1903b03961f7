"""The composition root: from settings to the service with everything it works with, or to a worker alone."""

import logging
import sys
import threading
from collections.abc import Iterator
from contextlib import AbstractContextManager, ExitStack, closing, contextmanager, nullcontext

from grader.catalog import Catalog, set_root
from grader.catalog.cache import AssignmentMemory
from grader.catalog.refreshed import RefreshedAssignments
from grader.checks import problems
from grader.contracts.errors import SandboxError, SettingsError
from grader.contracts.grading import Preflight, SandboxState
from grader.grading.practice import PracticeRuns
from grader.grading.preflight import NoPreflight, SandboxPreflight
from grader.grading.slot import Slot, SlotConfig
from grader.live.cars import LiveCars, websockets_installed
from grader.operation.metrics import Metrics, exported
from grader.operation.settings import Settings, is_loopback
from grader.outside.signin import Providers, read_config
from grader.outside.signin.opening import opened
from grader.sandbox import script_sandbox, syntax_sandbox
from grader.service.worker import Uploads, Worker, WorkerConfig, WorkerParts
from grader.service.worker.beside import ServiceLink, WorkerProcess
from grader.service.worker.explainer import Explaining
from grader.store.clock import Clock, clock_of
from grader.store.courses import Courses
from grader.store.database import Database, checkpoints
from grader.store.explanations import Explanations
from grader.store.occupancy import Sole, check_room
from grader.store.own_assignments import OwnAssignments
from grader.store.queue import Queue, Retries
from grader.store.rules import StoredRules
from grader.store.schema import up_to_date
from grader.store.standings import Measures
from grader.store.tokens import Tokens
from grader.store.work import NEWS_CONNECTIONS, Doorbell
from grader.store.workers import Workers, presence
from grader.use_cases.callers import Callers, new_token
from grader.use_cases.course_assignments import CourseAssignments
from grader.use_cases.outbound import Sender
from grader.use_cases.pictures import PlotCache, draw_stored
from grader.use_cases.services import Services

_log = logging.getLogger(__name__)
_SYNTAX_CHECKS = 3  # side by side: one file that keeps the compiler busy does not hold up all uploads
GRADING_NICENESS = 10
"""Of what grades. At 3 an upload took three times as long (p95) while both slots of two cores graded."""
_BEHIND = SlotConfig(mode="strict", niceness=14)  # than gradings, and soon enough: examining, practice
_ISOLATION = SlotConfig(mode="strict", niceness=GRADING_NICENESS)  # no weaker mode


@contextmanager
def running(settings: Settings, preflight: Preflight | None = None) -> Iterator[Services]:
    """Open the store, bring it up to date, start the workers; put everything away at the end.

    `preflight` looks at uploads; by default a sandbox of its own.

    Raises:
        SettingsError: the database does not fit this version, the service would be open to the network, or what is
            said about sign-in is wrong.
        AssignmentError: a folder of assignments is not there.
        InfrastructureError: the database cannot be opened.
    """
    with ExitStack() as stack:
        others = connections_of_worker(settings.slots) if settings.slots else 0
        database = stack.enter_context(
            _store(settings, "grader serve", settings.database_connections, others)
        )
        clock = stack.enter_context(clock_of(database))
        courses = Courses(database, clock)
        _check_exposure(settings, courses)
        services = Services.over(
            database,
            settings,
            clock,
            retries=_retries(settings),
            assignments=assignments_of(settings, database, clock),
            preflight=preflight or stack.enter_context(_preflight()),
            plots=PlotCache(draw_stored, settings.plot_cache_entries),
            callers=Callers(courses, Tokens(database, clock), _token(settings, courses), clock),
            live=LiveCars(
                settings.live_cars if websockets_installed() else 0,
                may_begin=stack.enter_context(closing(Sole(database))).is_mine,
            ),
            practice=_practice(database, settings, clock),
            providers=_providers(settings, clock),
        )
        stack.enter_context(_at_work(settings, services))
        yield services


@contextmanager
def _at_work(settings: Settings, services: Services) -> Iterator[None]:
    """Run what works beside the answers to requests; end it, and what the services keep in memory."""
    with ExitStack() as stack:
        works = (services.plots, services.comparer, services.space, services.watching, services.practice)
        for one in works:
            stack.callback(one.close)
        stack.enter_context(Sender(services))
        if settings.metrics_port is not None:
            stack.enter_context(exported(services.metrics, settings.metrics_port, settings.host))
        if settings.slots:
            worker = WorkerProcess(settings, services.doorbell, services.metrics)
            worker.start()
            stack.callback(worker.stop)
        yield


def _practice(database: Database, settings: Settings, clock: Clock) -> PracticeRuns:
    queue = Queue(database, clock, _retries(settings))
    return PracticeRuns(settings.practice_runs, lambda: Slot(_BEHIND), queue.is_due)


@contextmanager
def running_worker(
    settings: Settings, service: int | None = None, stopped: threading.Event | None = None
) -> Iterator[Worker]:
    """Open the store, bring it up to date, and grade without serving; put everything away at the end.

    Args:
        settings: of which a worker needs few.
        service: descriptor of the link to the service that this worker belongs to; None: it works by itself.
        stopped: set when that service is gone.

    Raises:
        SettingsError, AssignmentError, InfrastructureError: as `running` does.
    """
    with ExitStack() as stack:
        doorbell = Doorbell()
        # before anything else: the service may stop while this worker starts
        link = None if service is None else ServiceLink(service, doorbell, stopped or threading.Event())
        pooled = min(settings.slots, settings.database_connections)
        database = stack.enter_context(
            _store(settings, "grader worker", pooled, connections_of_worker(settings.slots) - pooled)
        )
        clock = stack.enter_context(clock_of(database))
        parts = WorkerParts(
            queue=Queue(database, clock, _retries(settings)),
            workers=Workers(database, clock),
            assignments=assignments_of(settings, database, clock),
            make_grader=lambda: Slot(_ISOLATION),
            probe=_probe,
            doorbell=doorbell,
            clock=clock,
            metrics=link or stack.enter_context(_own_metrics(settings, database, clock)),
            uploads=Uploads(own=OwnAssignments(database, clock), make_grader=lambda: Slot(_BEHIND)),
            explaining=_explaining(database, clock),
        )
        stack.enter_context(_news(database, doorbell))
        yield stack.enter_context(_working(settings, parts))


@contextmanager
def _own_metrics(settings: Settings, database: Database, clock: Clock) -> Iterator[Metrics]:
    metrics = Metrics(Measures(database, Workers(database, clock), clock, settings.silent_s).state)
    port = settings.metrics_port
    with nullcontext() if port is None else exported(metrics, port, settings.host):
        yield metrics


def _explaining(database: Database, clock: Clock) -> Explaining:
    return Explaining(
        explanations=Explanations(database, clock),
        rules=StoredRules(database),
        make_grader=lambda: Slot(_BEHIND),
        clock=clock,
    )


def connections_of_worker(slots: int) -> int:
    """Return how many connections to PostgreSQL a worker has at most.

    One for each slot, which uses it only between two gradings and shares it with the heart and the examiner, and
    two to hear of uploads.
    """
    return slots + NEWS_CONNECTIONS


def _providers(settings: Settings, clock: Clock) -> Providers:
    if settings.signin is None:
        return Providers()
    return opened(read_config(settings.signin), lambda: clock().timestamp())


def assignments_of(settings: Settings, database: Database, clock: Clock) -> CourseAssignments:
    """Return the assignments that come with the grader, the operator's, and those of single courses."""
    folders = (None, *(set_root(str(one)) or one for one in settings.assignment_folders))
    shared = RefreshedAssignments([Catalog(one, AssignmentMemory()) for one in folders], problems)
    return CourseAssignments(shared, OwnAssignments(database, clock))


@contextmanager
def _store(settings: Settings, who: str, connections: int, others: int) -> Iterator[Database]:
    """Open the database and bring it up to date; nobody replaces it meanwhile.

    `connections`: most of its own; `others`: that will be opened besides.
    """
    with (
        closing(Database(settings.database_url, connections)) as database,
        up_to_date(database, who, wait=True),
        checkpoints(database),
    ):
        check_room(database, connections + others)
        yield database


@contextmanager
def _working(settings: Settings, parts: WorkerParts) -> Iterator[Worker]:
    """Run a worker in threads of this process."""
    config = WorkerConfig(
        slots=settings.slots,
        heartbeat_s=settings.heartbeat_s,
        poll_s=settings.poll_s,
        drain_s=settings.drain_s,
    )
    with presence(settings.database_url, lambda: _take_over(parts.queue)):
        worker = Worker(parts, config)
        worker.start()
        try:
            yield worker
        finally:
            worker.stop()


def _news(database: Database, doorbell: Doorbell) -> AbstractContextManager[None]:
    if database.is_sqlite:
        return nullcontext()
    from grader.store.jobs.news import heard  # the embedded default does without Procrastinate

    return heard(database, doorbell)


@contextmanager
def _preflight() -> Iterator[Preflight]:
    """Check syntax in sandboxes of its own; without one, leave it to grading, which then waits, too."""
    with ExitStack() as stack:
        try:
            sandboxes = [stack.enter_context(syntax_sandbox(_ISOLATION.mode)) for _ in range(_SYNTAX_CHECKS)]
            checker: Preflight = stack.enter_context(SandboxPreflight(*sandboxes))
        except SandboxError as error:
            _log.error("uploads are accepted without a look at their syntax: %s", error)
            checker = NoPreflight()
        yield checker


def _take_over(queue: Queue) -> None:
    left = queue.reconcile(all_running=True)
    if left.requeued or left.given_up:
        _log.warning("after a crash: %d gradings queued again, %d given up", left.requeued, left.given_up)


def _retries(settings: Settings) -> Retries:
    return Retries(lease_s=settings.lease_s, max_tries=settings.max_tries, backoff_s=settings.retry_backoff_s)


def _check_exposure(settings: Settings, courses: Courses) -> None:
    """Refuse to be reached from other machines while nobody is asked who they are.

    Raises SettingsError: the address is not of this machine only, there is no course, and nobody consented.
    """
    if is_loopback(settings.host) or settings.allow_anonymous_network or courses.exist():
        return
    raise SettingsError(
        f"host {settings.host} is reachable from other machines, and without a course nobody is asked who they "
        "are: create one with `grader course create`, use 127.0.0.1, or set "
        "GRADER_ALLOW_ANONYMOUS_NETWORK=true if a proxy in front authenticates",
        f"地址 {settings.host} 能被别的机器访问，而没有课程时不核对身份：请先用 `grader course create` 创建课程，"
        "或改用 127.0.0.1；如果前面的代理负责登录，可以设 GRADER_ALLOW_ANONYMOUS_NETWORK=true",
    )


def _token(settings: Settings, courses: Courses) -> str:
    if settings.instructor_token is not None:
        return settings.instructor_token.get_secret_value()
    token = new_token()
    if not courses.exist():  # with courses it would open nothing
        sys.stderr.write(f"instructor token / 教师令牌: {token}\n")
        sys.stderr.flush()
    return token


def _probe() -> SandboxState:
    with script_sandbox(_ISOLATION.mode) as sandbox:
        breaches = sandbox.prove().breaches
        return SandboxState(
            ready=not breaches,
            isolation=sandbox.isolation,
            missing_layers=sandbox.missing_layers,
            detail="; ".join(breaches),
        )
