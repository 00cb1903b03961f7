import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest

from grader.store.database import Database
from grader.store.queue import Queue, Retries
from tests.fakes.clock import FakeClock
from tests.fakes.submissions import Submissions

RETRIES = Retries(lease_s=15.0, max_tries=3, backoff_s=2.0)


@pytest.fixture
def clock() -> FakeClock:
    return FakeClock()


@pytest.fixture
def database(database_url: str) -> Iterator[Database]:
    opened = Database(database_url)
    yield opened
    opened.close()


@pytest.fixture
def sqlite_database(tmp_path: Path, migrated_file: Path) -> Iterator[Database]:
    shutil.copy(migrated_file, tmp_path / "grader.db")
    opened = Database(f"sqlite:///{tmp_path / 'grader.db'}")
    yield opened
    opened.close()


@pytest.fixture
def postgres_database(postgres_url: str) -> Iterator[Database]:
    opened = Database(postgres_url)
    yield opened
    opened.close()


@pytest.fixture
def queue(database: Database, clock: FakeClock) -> Queue:
    return Queue(database, clock, RETRIES)


@pytest.fixture
def submissions(database: Database, clock: FakeClock) -> Submissions:
    return Submissions(database, clock)
