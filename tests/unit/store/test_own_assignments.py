"""Who may examine an upload, and what is kept of it."""

import pytest

from grader.contracts.errors import RefusedError
from grader.contracts.own_assignment import OwnState
from grader.store.audit import Signature
from grader.store.courses import Courses
from grader.store.database import Database
from grader.store.own_assignments import LEASE_S, NewOwnAssignment, OwnAssignments
from tests.fakes.clock import FakeClock


@pytest.fixture
def own(database: Database, clock: FakeClock) -> OwnAssignments:
    Courses(database, clock).create("ros", "ROS", "UTC", "test")
    return OwnAssignments(database, clock)


def add(own: OwnAssignments, clock: FakeClock, version: int = 1) -> None:
    new = NewOwnAssignment(assignment="walk", version=version, content=b"zip%d" % version, reading=b"{}")
    own.add(new, Signature(clock(), "ros", "wang"))


def states(own: OwnAssignments) -> list[tuple[int, OwnState]]:
    return [(one.version, one.state) for one in own.of("ros")]


def test_only_the_latest_claim_counts(own: OwnAssignments, clock: FakeClock) -> None:
    add(own, clock)
    first = own.claim()
    assert first is not None
    assert own.claim() is None
    clock.advance(LEASE_S - 1)
    assert own.renew(first)
    clock.advance(LEASE_S - 1)
    assert own.claim() is None
    clock.advance(2)
    second = own.claim()
    assert second is not None
    assert not own.renew(first)
    assert not own.finish(first, b"{}", ready=True)
    assert own.finish(second, b"{}", ready=True)
    assert states(own) == [(1, OwnState.READY)]
    assert not own.hand_back(second, "late", 0.0)


def test_a_clock_that_was_ahead_holds_no_upload_up(own: OwnAssignments, clock: FakeClock) -> None:
    clock.advance(86_400)
    add(own, clock)
    clock.advance(-86_400)
    claim = own.claim()
    assert claim is not None
    clock.advance(86_400)
    assert own.renew(claim)
    clock.advance(-86_400)
    assert own.claim() is not None


def test_a_newer_upload_takes_the_place_of_one_that_waits(own: OwnAssignments, clock: FakeClock) -> None:
    add(own, clock)
    claim = own.claim()
    assert claim is not None
    add(own, clock, 2)
    assert not own.finish(claim, b"{}", ready=True)
    newer = own.claim()
    assert newer is not None
    assert own.finish(newer, b"{}", ready=True)
    before = own.marks()
    clock.advance(1)
    add(own, clock, 3)
    assert own.marks() == before
    assert states(own) == [(2, OwnState.READY), (3, OwnState.WAITING)]
    assert own.content("ros", "walk") == b"zip3"
    assert own.in_use("ros") == {"walk": b"zip2"}
    own.remove("walk", Signature(clock(), "ros", "wang"))
    assert states(own) == []
    clock.advance(1)
    add(own, clock)
    again = own.claim()
    assert again is not None
    own.finish(again, b"{}", ready=True)
    assert own.marks() != before  # though it has the number of one that was removed


def test_the_claim_of_a_removed_upload_says_nothing_of_the_next_one(
    own: OwnAssignments, clock: FakeClock
) -> None:
    add(own, clock)
    late = own.claim()
    assert late is not None
    own.remove("walk", Signature(clock(), "ros", "wang"))
    clock.advance(1)
    add(own, clock)
    other = own.claim()
    assert other is not None
    assert (other.number, other.tries) == (late.number, late.tries)
    assert not own.renew(late)
    assert not own.finish(late, b"{}", ready=True)
    assert states(own) == [(1, OwnState.WAITING)]
    assert own.finish(other, b"{}", ready=True)


def test_a_course_has_so_many_at_most(
    own: OwnAssignments, clock: FakeClock, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("grader.store.own_assignments.MOST_OWN", 2)
    signed = Signature(clock(), "ros", "wang")

    def upload(name: str) -> None:
        own.add(NewOwnAssignment(assignment=name, version=1, content=b"zip", reading=b"{}"), signed)

    upload("walk")
    upload("run")
    upload("run")  # again
    with pytest.raises(RefusedError, match="too_many_assignments"):
        upload("swim")
    assert {one.assignment for one in own.of("ros")} == {"walk", "run"}
