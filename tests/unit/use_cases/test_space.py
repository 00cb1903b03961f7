"""What the courses take, counted behind the pages."""

import threading
from collections.abc import Callable, Mapping
from contextlib import closing

from grader.store.erasing import Space
from grader.use_cases import space
from grader.use_cases.space import SpaceCounter
from tests.fakes.clock import FakeClock
from tests.fakes.waiting import wait_until


def counter(count: Callable[[], Mapping[str, Space]], clock: FakeClock) -> SpaceCounter:
    return SpaceCounter(count, clock, lambda: clock().timestamp())


def test_a_page_does_not_wait_for_a_large_class() -> None:
    clock, go_on, counts = FakeClock(), threading.Event(), []

    def count() -> dict[str, Space]:
        counts.append(clock())
        go_on.wait()
        return {"ros": Space(submissions=len(counts))}

    with closing(counter(count, clock)) as counted:
        assert counted.latest() is None
        assert counted.latest() is None
        go_on.set()
        wait_until(lambda: counted.latest() is not None)
        first = counted.latest()
        assert first is not None
        assert (first.courses["ros"].submissions, first.at, len(counts)) == (1, counts[0], 1)
        clock.advance(space._FRESH_S)
        assert counted.latest() is first  # the next ones find a newer one
        wait_until(lambda: counted.latest() is not first)
        assert len(counts) == 2


def test_a_count_that_failed_is_made_again() -> None:
    clock, left = FakeClock(), [{"ros": Space()}, None]

    def count() -> dict[str, Space]:
        found = left.pop()
        if found is None:
            raise OSError("the database is away")
        return found

    with closing(counter(count, clock)) as counted:
        wait_until(counted.latest)
        assert left == []
