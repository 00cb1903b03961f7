"""When a run's time is up, and whether it had fallen silent by then."""

import time
from collections.abc import Callable

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
        self.waited: int | None = 0
        self.count = 1

    def threads(self) -> int:
        return self.count

    def waited_ns(self) -> int | None:
        return self.waited

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


def test_threads_are_counted_whether_or_not_the_kernel_does(process: Process) -> None:
    clocks = make(process, threads=8)
    process.count = 9  # with the main thread
    assert clocks.passed_limit() is None
    process.count = 10
    time.sleep(module.TICK_NS / 1e9)
    assert clocks.passed_limit() == Ending(RunEnd.FORBIDDEN, "more than 8 threads ran at once")


@pytest.fixture
def wall(monkeypatch: pytest.MonkeyPatch) -> Callable[[float], None]:
    """Turn the wall clock on by so many seconds; nothing else passes."""
    now = [S]

    def turn(seconds: float) -> None:
        now[0] += int(seconds * S)

    monkeypatch.setattr(module.time, "monotonic_ns", lambda: now[0])
    monkeypatch.setattr(module.time, "thread_time_ns", lambda: 0)
    monkeypatch.setattr(module, "disk_pressure_ns", lambda: 0)
    return turn


Wall = Callable[[float], None]


def run_ticks(clocks: Clocks, wall: Wall, seconds: float) -> Ending | None:
    """Look at the clocks a hundred times a second, as a grader that has a processor does."""
    for _ in range(round(seconds * 100)):
        wall(0.01)
        if (ending := clocks.passed_limit()) is not None:
            return ending
    return None


def test_who_waits_on_an_idle_host_is_at_fault(process: Process, wall: Wall) -> None:
    clocks = make(process, wall_s=2.0)
    assert run_ticks(clocks, wall, 2.0) is None
    ending = run_ticks(clocks, wall, 0.1)
    assert ending is not None
    assert ending.end is RunEnd.STALLED


def test_waiting_for_a_processor_moves_the_wall_limit(process: Process, wall: Wall) -> None:
    clocks = make(process, wall_s=2.0)
    for _ in range(600):
        assert run_ticks(clocks, wall, 0.01) is None
        process.now_ns += S // 1000
        assert process.waited is not None
        process.waited += S // 100 - S // 1000
    ending = run_ticks(clocks, wall, 2.0)
    assert ending is not None
    assert ending.end is RunEnd.STALLED  # from there on it had all the processor it wanted


def test_a_pause_of_the_grader_moves_the_wall_limit(process: Process, wall: Wall) -> None:
    clocks = make(process, wall_s=2.0)
    clocks.passed_limit()
    for _ in range(5):
        wall(1.0)
        process.now_ns += 1
        assert clocks.passed_limit() is None


def test_a_run_that_gets_no_processor_at_all_blames_the_host(process: Process, wall: Wall) -> None:
    clocks = make(process, wall_s=2.0)
    process.waited = 3600 * S
    assert run_ticks(clocks, wall, 10.0) is None
    ending = run_ticks(clocks, wall, 3.0)
    assert ending is not None
    assert ending.end is RunEnd.INFRASTRUCTURE


def test_no_run_lasts_for_ever_on_a_busy_host(process: Process, wall: Wall) -> None:
    clocks = make(process, wall_s=1.0, cpu_s=60.0)
    process.waited = 3600 * S
    ending = None
    while ending is None:
        wall(0.01)
        process.now_ns += S // 100_000
        ending = clocks.passed_limit()
    assert ending == Ending(RunEnd.INFRASTRUCTURE, "no end after 15 s on a busy host")


@pytest.mark.parametrize(("busy_share", "enough_s"), [(1.0, 4.0), (0.4, 2.0)])
def test_a_run_that_computed_for_long_on_a_busy_host_is_the_scripts(
    process: Process, wall: Wall, busy_share: float, enough_s: float
) -> None:
    """Sooner where it was silent for half of its time, long before the wall limit has moved as far as it can."""
    clocks = make(process, wall_s=1.0, cpu_s=10.0)
    process.waited = 3600 * S
    begun_ns, ending = process.now_ns, None
    while ending is None:
        wall(0.01)
        process.now_ns += S // 100
        if process.now_ns - begun_ns < busy_share * enough_s * S:
            clocks.note_life()
        ending = clocks.passed_limit()
    spent = f"no end after {enough_s:g} s of CPU time, for which a busy host took long"
    assert ending == Ending(RunEnd.CPU_LIMIT, spent)
    assert clocks.wall_ns < 2 * enough_s * S + bounds.STARVED_NS


def test_a_long_wall_limit_moves_by_eight_minutes_at_most(process: Process, wall: Wall) -> None:
    clocks = make(process, wall_s=120.0, cpu_s=60.0)
    process.waited = 3600 * S
    ending = None
    while ending is None:
        wall(1.0)
        process.now_ns += S // 100_000
        ending = clocks.passed_limit()
    assert ending.end is RunEnd.INFRASTRUCTURE
    assert 600 * S <= clocks.wall_ns <= 600 * S + bounds.STARVED_NS


def test_a_host_whose_disk_is_slow_is_at_fault(
    process: Process, wall: Wall, monkeypatch: pytest.MonkeyPatch
) -> None:
    clocks = make(process, wall_s=2.0)
    assert run_ticks(clocks, wall, 1.5) is None
    monkeypatch.setattr(module, "disk_pressure_ns", lambda: S)
    ending = run_ticks(clocks, wall, 1.0)
    assert ending is not None
    assert ending.end is RunEnd.INFRASTRUCTURE


@pytest.mark.parametrize(("load", "end"), [(1e9, None), (0.0, RunEnd.STALLED)])
def test_without_the_kernels_account_the_load_tells(
    process: Process, wall: Wall, monkeypatch: pytest.MonkeyPatch, load: float, end: RunEnd | None
) -> None:
    monkeypatch.setattr(module.os, "getloadavg", lambda: (load, 0.0, 0.0))
    process.waited = None
    ending = run_ticks(make(process, wall_s=2.0), wall, 3.0)
    assert (ending and ending.end) == end


def test_what_the_grader_computes_for_a_script_is_charged_to_it(
    process: Process, wall: Wall, monkeypatch: pytest.MonkeyPatch
) -> None:
    clocks = make(process, cpu_s=1.0)
    assert clocks.passed_limit() is None
    monkeypatch.setattr(module.time, "thread_time_ns", lambda: 3 * S)
    assert clocks.passed_limit() is None
    monkeypatch.setattr(module.time, "thread_time_ns", lambda: 3 * S + 1)
    ending = clocks.passed_limit()
    assert ending is not None
    assert ending.end is RunEnd.CPU_LIMIT


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
