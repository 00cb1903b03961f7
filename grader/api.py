"""The HTTP service: a factory, and `grader.api:app` for servers that want a name.

Importing this module opens nothing. The store, the workers and the sandbox come to life when the server
starts the application, and are put away in good order when it stops.
"""

import gc
import logging
import threading
from collections.abc import AsyncIterator, Callable
from contextlib import AbstractContextManager, asynccontextmanager

from fastapi import FastAPI
from fastapi.concurrency import contextmanager_in_threadpool
from starlette.types import ASGIApp

from grader import __version__
from grader.service.requests.middleware import (
    BoundedBodies,
    HeadAsGet,
    HeldToTheEnd,
    KnownPeer,
    Observed,
    SafeHeaders,
    Unchanged,
)
from grader.service.routes import (
    appeals,
    assignments,
    comments,
    course,
    dashboard,
    documentation,
    events,
    gradebook,
    health,
    judgements,
    live,
    metrics,
    notices,
    own_assignments,
    people,
    pinned,
    platforms,
    practice,
    problems,
    recordings,
    regrades,
    rules,
    similar,
    submissions,
    teams,
)
from grader.service.routes.events import told_to_stop
from grader.service.web import routing as pages
from grader.service.web.pages import compile_all
from grader.use_cases.services import Services

_log = logging.getLogger(__name__)
ServicesOpener = Callable[[], AbstractContextManager[Services]]

_ROUTERS = (
    submissions.uploads,
    submissions.router,
    events.submission,
    recordings.router,
    assignments.router,
    similar.router,
    rules.router,
    regrades.router,
    regrades.of_submission,
    judgements.router,
    judgements.of_submission,
    appeals.router,
    appeals.of_submission,
    comments.router,
    teams.router,
    pinned.router,
    dashboard.router,
    dashboard.of_assignment,
    events.dashboard,
    gradebook.router,
    gradebook.exports,
    people.router,
    course.router,
    own_assignments.router,
    notices.router,
    platforms.router,
    problems.router,
    live.router,
    practice.router,
    health.router,
    metrics.router,
)


def behind_proxies(app: FastAPI) -> ASGIApp:
    """Return `app` for a server that does not look at proxies' headers itself."""
    return KnownPeer(app)


def create_app(open_services: ServicesOpener | None = None) -> FastAPI:
    """Return the application.

    Args:
        open_services: opens what the routes work with when the application starts, and closes it when it
            stops; by default everything as the environment's settings say.
    """
    opener = _from_environment if open_services is None else open_services

    @asynccontextmanager
    async def lifespan(app: FastAPI) -> AsyncIterator[None]:
        async with contextmanager_in_threadpool(opener()) as services:
            app.state.services = services
            app.state.default_language = services.settings.default_language
            with told_to_stop(lambda: _let_go(services)):
                yield
            services.live.stop()

    # FastAPI's documentation pages load scripts from other hosts; /openapi.json is for tools
    app = FastAPI(
        title=documentation.TITLE, version=__version__, docs_url=None, redoc_url=None, lifespan=lifespan
    )
    app.add_middleware(BoundedBodies)
    app.add_middleware(Unchanged)
    app.add_middleware(HeldToTheEnd)
    app.add_middleware(SafeHeaders)
    app.add_middleware(Observed)
    app.add_middleware(HeadAsGet)  # added last, so around everything else
    problems.install(app)
    events.install(app)
    live.install(app)
    for router in _ROUTERS:
        # like `include_router`, which would build each route a second time and make the first request wait
        app.router.routes.extend(router.routes)
    pages.install(app)
    documentation.install(app)
    return app


def warm_up(services: Services) -> threading.Thread:
    """Make, in the thread that is returned, what the first visitor of each page would wait for.

    That is the templates, and what is counted of each class that is taught.
    """

    def work() -> None:
        try:
            compile_all()
            for course in services.courses.all():
                if course.archived_at is None:
                    services.dashboard.state(course.id)
            gc.freeze()  # all of this stays: no later look for garbage goes through it in the middle of a page
        except Exception as error:  # then the first visitor waits
            _log.warning("pages were not prepared: %s", error)

    thread = threading.Thread(target=work, name="grader-warm-up", daemon=True)
    thread.start()
    return thread


def _let_go(services: Services) -> None:
    """End what lives as long as its clients, for a service that stops."""
    services.watching.end()
    services.live.stop()
    services.practice.stop()


def _from_environment() -> AbstractContextManager[Services]:
    from grader.operation.settings import load
    from grader.service.composition import running

    return running(load())


app = create_app()
