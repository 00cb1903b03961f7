from collections.abc import Iterator
from pathlib import Path

import pytest

from grader.store.database import Database
from grader.store.queue import Queue, RetryPolicy
from grader.store.schema import migrate
from grader.store.submissions import Submissions
from tests.fakes.clock import FakeClock

POLICY = RetryPolicy(lease_s=15.0, max_tries=3, backoff_s=2.0)


@pytest.fixture
def clock() -> FakeClock:
    return FakeClock()


@pytest.fixture
def database(tmp_path: Path) -> Iterator[Database]:
    opened = Database(f"sqlite:///{tmp_path / 'grader.db'}")
    migrate(opened)
    yield opened
    opened.close()


@pytest.fixture
def queue(database: Database, clock: FakeClock) -> Queue:
    return Queue(database, clock, POLICY)


@pytest.fixture
def submissions(database: Database, clock: FakeClock) -> Submissions:
    return Submissions(database, clock)
