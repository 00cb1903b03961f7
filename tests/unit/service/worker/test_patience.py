"""After which beats a worker judges the leases of others."""

from grader.service.worker.heart import Patience
from tests.fakes.clock import FakeClock

LEASE_S, BEAT_S = 15.0, 3.0
IN_A_LEASE = 5


class Beats:
    """A heart reduced to what patience sees of it."""

    def __init__(self) -> None:
        self.clock = FakeClock()
        self.patience = Patience(LEASE_S, BEAT_S)

    def good(self, count: int = 1) -> list[bool]:
        return [self._one() for _ in range(count)]

    def _one(self) -> bool:
        self.clock.advance(BEAT_S)
        return self.patience.count_beat(self.clock())


PATIENT = [False] * IN_A_LEASE


def test_one_that_starts_waits_a_lease() -> None:
    assert Beats().good(IN_A_LEASE + 2) == [*PATIENT, True, True]


def test_a_failed_beat_gives_everybody_a_lease() -> None:
    beats = Beats()
    beats.good(IN_A_LEASE + 1)
    beats.patience.failed()
    assert beats.good(IN_A_LEASE + 1) == [*PATIENT, True]


def test_so_does_a_silence_in_which_a_lease_may_have_ended() -> None:
    beats = Beats()
    beats.good(IN_A_LEASE + 1)
    beats.clock.advance(LEASE_S - 2 * BEAT_S)
    assert beats.good() == [True]
    beats.clock.advance(LEASE_S - 2 * BEAT_S + 0.1)
    assert beats.good(IN_A_LEASE + 1) == [*PATIENT, True]


def test_so_does_a_clock_that_was_set_back() -> None:
    beats = Beats()
    beats.good(IN_A_LEASE + 1)
    beats.clock.advance(-3_600)
    assert beats.good(IN_A_LEASE + 1) == [*PATIENT, True]


def test_a_database_that_keeps_failing_strands_nothing() -> None:
    beats = Beats()
    judged = []
    for _ in range(12 * IN_A_LEASE):
        judged += beats.good()
        beats.patience.failed()
    assert judged.count(True) == 2
