"""When a run's time is up, and whether it had fallen silent by then."""

import pytest

from grader.contracts.assignment import Limits
from grader.jail import bounds
from grader.jail import ending as module
from grader.jail.ending import Clocks, Ending, RunEnd

S = 1_000_000_000


class Process:
    """A process whose clock the test turns."""

    def __init__(self) -> None:
        self.now_ns = 7 * S
        self.asleep = False

    def cpu_ns(self) -> int:
        return self.now_ns

    def sleeps(self) -> bool:
        return self.asleep


@pytest.fixture
def process() -> Process:
    return Process()


def make(process: Process, **limits: float) -> Clocks:
    return Clocks(process, Limits(**limits))  # type: ignore[arg-type]


def test_cpu_time_counts_from_the_start_of_the_script(process: Process) -> None:
    clocks = make(process, cpu_s=2.5)
    process.now_ns += int(2.5 * S)
    assert clocks.passed_limit() is None
    process.now_ns += 1
    assert clocks.passed_limit() == Ending(RunEnd.CPU_LIMIT, "more than 2.5 s of CPU time were used")
    assert clocks.exhausted(process.now_ns)


def test_a_grace_shortens_and_never_lengthens(process: Process) -> None:
    clocks = make(process, cpu_s=2.0)
    clocks.limit_cpu(10.0)
    process.now_ns += 2 * S + 1
    assert clocks.passed_limit() is not None
    later = make(process, cpu_s=10.0)
    later.limit_cpu(0.5)
    process.now_ns += S // 2 + 1
    assert later.passed_limit() is not None


def test_the_wall_clock_blames_the_host(process: Process) -> None:
    assert make(process, wall_s=-1.0).passed_limit() == Ending(RunEnd.INFRASTRUCTURE, "no end after -1 s")


@pytest.mark.parametrize(("silent_since_s", "quiet"), [(0.0, True), (4.9, True), (5.1, False), (10.0, False)])
def test_quiet_is_who_was_silent_for_half_its_time(
    process: Process, silent_since_s: float, quiet: bool
) -> None:
    clocks = make(process, cpu_s=10.0)
    process.now_ns += int(silent_since_s * S)
    clocks.note_life()
    clocks.passed_limit()
    process.now_ns = 17 * S + 1
    assert clocks.passed_limit() is not None
    assert clocks.was_quiet(RunEnd.CPU_LIMIT) is quiet


def test_a_last_word_after_the_kill_is_not_quiet(process: Process) -> None:
    clocks = make(process)
    clocks.note_life()
    assert not clocks.was_quiet(RunEnd.CPU_LIMIT)
    assert not clocks.was_quiet(RunEnd.STALLED)


def test_quiet_within_the_grace_counts_the_grace_alone(process: Process) -> None:
    clocks = make(process, cpu_s=10.0)
    process.now_ns += 8 * S
    clocks.note_life()
    clocks.passed_limit()
    clocks.limit_cpu(1.0)
    assert clocks.was_quiet(RunEnd.CPU_LIMIT)


def test_sleep_is_added_up_only_while_the_script_is_waited_for(
    process: Process, monkeypatch: pytest.MonkeyPatch
) -> None:
    now = [S]
    monkeypatch.setattr(module.time, "monotonic_ns", lambda: now[0])
    monkeypatch.setattr(bounds, "IDLE_LIMIT_NS", 3 * module.TICK_NS)
    clocks = make(process)
    process.asleep = True

    def tick() -> bool:
        now[0] += module.TICK_NS
        return clocks.sleeps_for_ever()

    assert [tick() for _ in range(4)] == [False] * 4
    clocks.forget_look()
    assert not tick()
    process.asleep = False
    assert not tick()
    process.asleep = True
    assert tick()
    assert clocks.was_quiet(RunEnd.STALLED)


def test_a_pause_of_the_whole_machine_is_not_sleep(process: Process, monkeypatch: pytest.MonkeyPatch) -> None:
    now = [S]
    monkeypatch.setattr(module.time, "monotonic_ns", lambda: now[0])
    clocks = make(process)
    process.asleep = True
    clocks.sleeps_for_ever()
    now[0] += 3600 * S
    assert not clocks.sleeps_for_ever()
