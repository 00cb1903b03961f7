"""Settings of all tests, and the databases that tests of the store run on."""

import compileall
import gc
import os
import shutil
import sys
import tempfile
from collections import defaultdict
from collections.abc import Callable, Generator, Iterator
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

os.environ["HYPOTHESIS_NO_PLUGINS"] = (
    "1"  # the only one is trio's, which takes longer to import than hypothesis
)
import tests.examples  # noqa: F401 - before any test draws one
from tests.fakes import postgres

if TYPE_CHECKING:  # imported by the fixtures: the process that only hands out the tests does without
    from sqlalchemy import URL, Engine

    from grader.contracts.grading import Grader
    from grader.grading.slot import Slot

gc.disable()  # until all is imported: other conftest.py of a run's folders may be next
_ROOT = Path(__file__).parents[1]
_ALIVE = pytest.StashKey[int]()
_GARBAGE = (5_000, 20, 50)
"""How much is allocated between looks for garbage: with Python's usual numbers they take 5 % of a run's time."""
_BROWSER = ("accessible_pages", "browser", "browser_course", "browser_practice")
_PREPARED = ("command_line", "practice_beside_workers", "scale_out", "serve", "service", "shutdown")
_TOGETHER = {f"tests/e2e/test_{one}.py": files[0] for files in (_BROWSER, _PREPARED) for one in files}
"""Files of tests by what they share for as long as a process runs: a browser's window, or `prepared`."""
_HAS_SERVICE = find_spec("sqlmodel") is not None
_TO_TESTS = ("GRADER_REQUIRE_", "GRADER_TEST_", "GRADER_OPENAPI_", "GRADER_IMAGE")
_USER_VARIABLES = {"DATABASE_URL", "FORCE_COLOR", "NO_COLOR", "COLUMNS"}
_PROXIES = {"HTTP_PROXY", "HTTPS_PROXY", "ALL_PROXY"}


@pytest.hookimpl(optionalhook=True)  # of a plugin that may be switched off
def pytest_xdist_auto_num_workers(config: pytest.Config) -> int:
    """One process more than processors: many tests wait for servers, browsers and scripts that they started."""
    return len(os.sched_getaffinity(0)) + 1


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> Any:
    """Hand out the files one by one, but those that stand together in `_TOGETHER` to one process."""
    from xdist.scheduler import LoadFileScheduling

    class Scheduling(LoadFileScheduling):
        def _split_scope(self, nodeid: str) -> str:
            file = super()._split_scope(nodeid)
            return _TOGETHER.get(file, file)

    return Scheduling(config, log) if config.getvalue("dist") == "loadfile" else None


def pytest_configure(config: pytest.Config) -> None:
    _forget_settings()
    if not hasattr(config, "workerinput"):
        config.stash[_ALIVE] = postgres.begin_run()
        _compile()


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Generator[None, object, object]:
    """Collect no garbage while modules are imported, nor look again and again through what they hold."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.freeze()
        gc.set_threshold(*_GARBAGE)
        gc.enable()


def _forget_settings() -> None:
    """Let tests not meet what the environment tells the grader and its libraries."""
    # those of the image download a package, which may take a proxy
    unwanted = _USER_VARIABLES if "GRADER_IMAGE" in os.environ else _USER_VARIABLES | _PROXIES
    for name in list(os.environ):
        for_the_grader = name.startswith("GRADER_") and not name.startswith(_TO_TESTS)
        if for_the_grader or name.upper() in unwanted:
            del os.environ[name]


def _compile() -> None:
    """Compile the grader once: the tests start hundreds of interpreters, which would each do it anew."""
    os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
    sys.dont_write_bytecode = False
    compileall.compile_dir(_ROOT / "grader", quiet=2, workers=len(os.sched_getaffinity(0)))


def pytest_unconfigure(config: pytest.Config) -> None:
    if _ALIVE in config.stash:
        postgres.end_run(config.stash[_ALIVE])


@pytest.hookimpl(wrapper=True)
def pytest_make_collect_report(
    collector: pytest.Collector,
) -> Generator[None, pytest.CollectReport, pytest.CollectReport]:
    """Skip the tests of what is not installed; the suite's own set-up installs everything."""
    report = yield
    if report.outcome == "failed" and not _HAS_SERVICE and "ModuleNotFoundError" in str(report.longrepr):
        report.outcome = "skipped"
        report.longrepr = (str(collector.path), 0, "Skipped: of an extra that is not installed")
    return report


@pytest.fixture(scope="session", autouse=True)
def durably() -> Iterator[dict[str, Callable[..., None]]]:
    """SQLite does not wait for the disk in this process: the files are thrown away. How it would is the value."""
    if not _HAS_SERVICE:
        yield {}
        return
    from grader.store import database as store_database

    real = store_database._configure_sqlite
    as_in_service = {"_configure_sqlite": real, "_Disk._write": store_database._Disk._write}

    def configure(connection: Any, record: Any) -> None:
        real(connection, record)
        connection.execute("PRAGMA synchronous=OFF")

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(store_database, "_configure_sqlite", configure)
        patch.setattr(store_database._Disk, "_write", lambda self: None)
        yield as_in_service


@pytest.fixture(scope="session", autouse=True)
def compiled_once() -> Iterator[dict[str, dict[Any, Any]]]:
    """Statements become SQL once for all databases of a kind: each test has its own, with the same statements."""
    if not _HAS_SERVICE:
        yield {}
        return
    from sqlalchemy.engine.default import DefaultDialect

    from grader.store import database as store_database

    real, caches = store_database.create_engine, defaultdict[str, dict[Any, Any]](dict)

    def create_engine(url: "URL", **options: Any) -> "Engine":
        shared = {"compiled_cache": caches[url.drivername]}
        return real(url, **options, execution_options=shared)

    with pytest.MonkeyPatch.context() as patch:
        # what was compiled is found by the statement and the dialect, of which each engine has its own
        patch.setattr(DefaultDialect, "__eq__", lambda one, other: type(one) is type(other))
        patch.setattr(DefaultDialect, "__hash__", lambda one: hash(one.name))
        patch.setattr(store_database, "create_engine", create_engine)
        yield caches


@pytest.fixture
def compiled_anew(compiled_once: dict[str, dict[Any, Any]]) -> Iterator[None]:
    """For tests that change the tables: what was compiled remembers the types of its columns."""
    caches = compiled_once.values()
    for cache in caches:
        cache.clear()
    yield
    for cache in caches:
        cache.clear()


@pytest.fixture
def durable(durably: dict[str, Callable[..., None]], monkeypatch: pytest.MonkeyPatch) -> None:
    """SQLite as the service has it, for databases that are opened after this."""
    for name, function in durably.items():
        monkeypatch.setattr(f"grader.store.database.{name}", function)


@pytest.fixture
def open_path() -> Iterator[Path]:
    """A folder that other users may enter, unlike pytest's own `tmp_path`."""
    path = Path(tempfile.mkdtemp(prefix="grader-test-"))
    path.chmod(0o755)
    yield path
    shutil.rmtree(path)


@pytest.fixture(scope="session")
def migrated_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A migrated SQLite database to copy: migrating anew for each test would take most of the time."""
    from grader.store.database import Database
    from grader.store.schema import migrate

    path = tmp_path_factory.mktemp("migrated") / "grader.db"
    database = Database(f"sqlite:///{path}")
    migrate(database)
    database.close()
    return path


@pytest.fixture(scope="session")
def slot() -> Iterator["Slot"]:
    """One grading process for all tests that only need its answers: starting one takes as long as ten gradings."""
    from grader.grading.slot import Slot, SlotConfig

    with Slot(SlotConfig()) as made:
        yield made


@pytest.fixture(scope="session")
def grader(slot: "Slot") -> "Grader":
    """The same, for tests that need no more of it than that it grades."""
    return slot


@pytest.fixture(scope="session")
def postgres_server() -> Iterator[postgres.PostgresServer]:
    """The PostgreSQL server of this run. Started by the first test that wants it."""
    try:
        server = postgres.PostgresServer()
    except Exception as error:
        if os.environ.get("GRADER_REQUIRE_POSTGRES"):
            raise
        pytest.skip(f"no PostgreSQL server can be started here: {error}")
    yield server
    server.close()


@pytest.fixture
def postgres_url(postgres_server: postgres.PostgresServer) -> str:
    """The address of a PostgreSQL database, migrated and empty."""
    return postgres_server.washed()


@pytest.fixture
def sqlite_url(tmp_path: Path, migrated_file: Path) -> str:
    """The address of a SQLite database, migrated and empty."""
    shutil.copy(migrated_file, tmp_path / "grader.db")
    return f"sqlite:///{tmp_path / 'grader.db'}"


@pytest.fixture(params=["sqlite_url", "postgres_url"], ids=["sqlite", "postgresql"])
def database_url(request: pytest.FixtureRequest) -> str:
    """The address of a database, migrated and empty; each test runs on both kinds."""
    url: str = request.getfixturevalue(request.param)
    return url


# for tests with `database_url` whose subject is SQLite's file, or has nothing to do with the database
on_sqlite = pytest.mark.parametrize("database_url", ["sqlite_url"], indirect=True, ids=["sqlite"])
# for tests of processes, which take seconds on either kind and differ by what the contract's tests try on both
first_on_sqlite = pytest.mark.parametrize(
    "database_url",
    ["sqlite_url", pytest.param("postgres_url", marks=pytest.mark.slow)],
    indirect=True,
    ids=["sqlite", "postgresql"],
)


@pytest.fixture(params=["sqlite", "postgresql"])
def blank_url(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[str]:
    """The address of a database without tables, of both kinds."""
    if request.param == "sqlite":
        yield f"sqlite:///{tmp_path / 'blank.db'}"
        return
    server: postgres.PostgresServer = request.getfixturevalue("postgres_server")
    name = f"blank_{os.getpid()}"
    yield server.create(name, empty=True)
    server.drop(name)
