"""How many connections the processes of a service have to a PostgreSQL server."""

import logging
import threading
import time
from typing import Any

import pytest
from sqlalchemy import text

from grader.contracts.errors import SettingsError
from grader.contracts.grading import SandboxState
from grader.contracts.submission import NewSubmission, SubmissionState
from grader.operation.settings import Settings
from grader.service import composition
from grader.store.clock import utc_now
from grader.store.database import Database
from grader.store.occupancy import check_room, room
from tests.fakes.grading import FakeAssignments, FakeGrader
from tests.fakes.submissions import Submissions
from tests.fakes.waiting import wait_until

_OF_WORKER = text(
    "SELECT application_name FROM pg_stat_activity WHERE datname = current_database()"
    " AND (application_name LIKE 'grader worker%' OR application_name LIKE 'grader news%')"
)


class SlowGrader(FakeGrader):
    """Takes its time, in which nothing holds a connection."""

    def grade(self, *arguments: Any) -> Any:
        """Grade."""
        time.sleep(0.03)
        return super().grade(*arguments)


@pytest.mark.parametrize("slots", [1, 3])
def test_a_worker_has_few_connections_whatever_it_does(
    postgres_url: str, monkeypatch: pytest.MonkeyPatch, slots: int
) -> None:
    monkeypatch.setattr(composition, "Slot", lambda _config: SlowGrader())
    monkeypatch.setattr(composition, "_probe", lambda: SandboxState(ready=True, isolation="fake"))
    monkeypatch.setattr(composition, "assignments_of", lambda *_: FakeAssignments())
    settings = Settings(database_url=postgres_url, slots=slots, heartbeat_s=0.05, lease_s=1, poll_s=0.05)
    database, counts, done = Database(postgres_url, connections=2), [], threading.Event()
    submissions = Submissions(database, utc_now)

    def count() -> None:
        while not done.wait(0.01):
            with database.reading() as session:
                counts.append(sorted(session.execute(_OF_WORKER).scalars()))

    counting = threading.Thread(target=count)
    with composition.running_worker(settings):
        new = [
            submissions.add(
                NewSubmission(
                    course=None,
                    student=f"s{number}",
                    assignment="square",
                    file_name="a.py",
                    source=b"good # %d" % number,
                )
            )
            for number in range(20)
        ]
        counting.start()
        wait_until(lambda: all(submissions.get(one.id).state is SubmissionState.GRADED for one in new))
        done.set()
        counting.join()
    database.close()
    assert len(counts) > 1
    assert max(map(len, counts)) <= composition.connections_of_worker(slots) == slots + 2


def test_a_server_with_too_few_connections_is_named_at_the_start(
    postgres_url: str, caplog: pytest.LogCaptureFixture
) -> None:
    database = Database(postgres_url)
    there = room(database)
    assert there is not None
    assert there.most > there.taken > 0
    with pytest.raises(SettingsError, match=f"takes {there.most} connections, this process needs 5000"):
        check_room(database, 5_000)
    with caplog.at_level(logging.WARNING):
        check_room(database, 1)
        assert not caplog.records
        check_room(database, there.most)
    assert "raise max_connections" in caplog.text
    database.close()


def test_a_file_has_no_such_bound(sqlite_url: str) -> None:
    database = Database(sqlite_url)
    assert room(database) is None
    check_room(database, 5_000)
    database.close()
