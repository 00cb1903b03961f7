"""The kernel by itself: one thread, a fake world, exact times."""

import importlib.util
import sys
from pathlib import Path
from types import ModuleType
from typing import Any
from unittest.mock import patch

import pytest
from hypothesis import given
from hypothesis import strategies as st

SHIM = Path(__file__).resolve().parents[2] / "grader" / "shim" / "rclpy"
S = 10**9
MS = 10**6
US = 1_000


def load(name: str) -> ModuleType:
    """Load one module of the shim on its own, whatever else is imported as rclpy."""
    spec = importlib.util.spec_from_file_location(f"rclpy.{name}", SHIM / f"{name}.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    with patch.dict(sys.modules, {f"rclpy.{name}": module}):
        spec.loader.exec_module(module)
    return module


kernel_module = load("_kernel")


def make(horizon_s: float = 60) -> Any:
    kernel = kernel_module.Kernel()
    kernel.start_episode(round(horizon_s * S), 0)
    return kernel


def charge_for_ever(kernel: Any) -> None:
    while True:
        kernel.charge()


class FakeWorld:
    """Something is due at fixed instants."""

    def __init__(self, *due_ns: int) -> None:
        self.coupled = True
        self.due = list(due_ns)
        self.quiet_ns = 0
        self.reckons = False
        self.asked: list[int] = []
        self.arrived = 0

    def advance(self, target_ns: int, together_ns: int) -> int:
        self.asked.append(target_ns)
        now_ns = max(min([target_ns, *self.due]), together_ns)
        while self.due and self.due[0] <= now_ns:
            self.arrived += 1
            self.due.pop(0)
        self.quiet_ns = min(self.due, default=1 << 62)
        return now_ns

    def deliver_pose(self) -> tuple[int, ...]:
        self.due.pop(0)
        self.arrived += 1
        self.quiet_ns = min(self.due, default=1 << 62)
        return (1,)


def test_a_sleep_takes_exactly_its_duration() -> None:
    kernel = make()
    kernel.sleep_ns(450 * MS)
    kernel.sleep_ns(50 * MS)
    assert kernel.now_ns == 500 * MS


def test_a_sleep_shorter_than_the_timer_slack_takes_the_slack() -> None:
    kernel = make()
    kernel.sleep_ns(1)
    assert kernel.now_ns == 50 * US


@pytest.mark.parametrize("duration_ns", [0, -1])
def test_a_sleep_of_nothing_costs_a_charge(duration_ns: int) -> None:
    kernel = make()
    kernel.sleep_ns(duration_ns)
    assert kernel.now_ns == 1 * US


def test_the_charge_grows_in_a_streak() -> None:
    kernel = make(600)
    instants = {}
    for count in range(1, 20_003):
        kernel.charge()
        instants[count] = kernel.now_ns
    assert instants[1_000] == 1_000 * US
    assert instants[1_001] == 1_010 * US
    assert instants[5_000] == 41 * MS
    assert instants[20_000] == 1_541 * MS
    assert instants[20_002] == 1_543 * MS


def test_a_sleep_ends_the_streak() -> None:
    kernel = make()
    for _ in range(1_500):
        kernel.charge()
    kernel.sleep_ns(MS)
    before = kernel.now_ns
    kernel.charge()
    assert kernel.now_ns - before == 1 * US


def test_a_look_at_the_clock_never_shows_the_same_time_twice() -> None:
    kernel = make()
    assert [kernel.clock_ns() for _ in range(3)] == [1_000, 2_000, 3_000]


def test_wait_tells_whether_its_condition_or_its_deadline_ended_it() -> None:
    kernel = make()
    assert kernel.wait(lambda: True, 5 * S, "") is True
    assert kernel.now_ns == 1 * US
    assert kernel.wait(lambda: False, 5 * S, "") is False
    assert kernel.now_ns == 5 * S
    assert kernel.wait(lambda: False, 3 * S, "") is False
    assert kernel.now_ns == 5 * S + 1 * US


def test_the_horizon_runs_callbacks_then_raises_keyboard_interrupt() -> None:
    kernel = make(2)
    seen = []
    kernel.on_interrupt(lambda: seen.append(kernel.now_ns))
    with pytest.raises(KeyboardInterrupt):
        kernel.sleep_ns(3 * S)
    assert seen == [2 * S]
    assert kernel.now_ns == 2 * S
    assert kernel.interrupted


def test_a_sleep_up_to_the_horizon_is_interrupted() -> None:
    kernel = make(2)
    with pytest.raises(KeyboardInterrupt):
        kernel.sleep_ns(2 * S)


def test_a_busy_loop_is_interrupted_at_the_horizon() -> None:
    kernel = make(2)
    with pytest.raises(KeyboardInterrupt):
        charge_for_ever(kernel)
    assert 2 * S <= kernel.now_ns < 2 * S + MS


def test_time_goes_on_after_the_horizon_until_the_second_interrupt_and_the_end() -> None:
    kernel = make(2)
    ended: list[str] = []

    def end(reason: str) -> None:
        ended.append(reason)
        raise SystemExit

    kernel.end = end
    for interrupts_ns in (2 * S, 12 * S):
        with pytest.raises(KeyboardInterrupt):
            kernel.sleep_ns(100 * S)
        assert kernel.now_ns == interrupts_ns
    with pytest.raises(SystemExit):
        kernel.sleep_ns(100 * S)
    assert ended == ["interrupted"]
    assert kernel.now_ns == 22 * S


def test_a_wait_that_nothing_can_end_is_a_stall() -> None:
    kernel = make()
    with pytest.raises(kernel_module.StalledError):
        kernel.wait(lambda: False, None, "client.call() waits for a response")


def test_an_idle_wait_lasts_until_the_horizon() -> None:
    kernel = make(60)
    with pytest.raises(KeyboardInterrupt):
        kernel.wait(lambda: False, None, "spin", idle=True)
    assert kernel.now_ns == 60 * S


def test_an_alarm_ends_no_wait_but_is_delivered_in_it() -> None:
    kernel = make()
    delivered = []
    kernel.deliver = lambda number: delivered.append((number, kernel.now_ns))
    kernel.set_alarm(3 * S)
    kernel.sleep_ns(5 * S)
    assert delivered == [(14, 3 * S)]
    assert kernel.now_ns == 5 * S


def test_a_signal_interrupts_a_wait_when_its_handler_raises() -> None:
    kernel = make()

    def deliver(number: int) -> None:
        raise TimeoutError(number)

    kernel.deliver = deliver
    kernel.set_alarm(3 * S)
    with pytest.raises(TimeoutError):
        kernel.wait(lambda: False, None, "", idle=True)
    assert kernel.now_ns == 3 * S


def test_a_coupled_sleep_asks_once_for_everything_that_comes_meanwhile() -> None:
    kernel = make()
    world = FakeWorld(16 * MS, 32 * MS, 48 * MS)
    kernel.connect(world)
    kernel.sleep_ns(40 * MS)
    assert world.asked == [40 * MS]
    assert world.arrived == 2
    assert kernel.now_ns == 40 * MS


def test_a_wait_takes_poses_that_are_computed_here_up_to_its_deadline_and_asks_nobody() -> None:
    kernel = make()
    world = FakeWorld(16 * MS, 32 * MS, 48 * MS)
    world.quiet_ns, world.reckons = 16 * MS, True
    kernel.connect(world)
    assert kernel.wait(lambda: world.arrived == 2, None, "spin()")
    assert (kernel.now_ns, world.arrived) == (32 * MS, 2)
    assert not kernel.wait(lambda: world.arrived == 3, 40 * MS, "spin()")
    assert (kernel.now_ns, world.arrived, world.asked) == (40 * MS, 2, [])


def test_a_quiet_world_is_not_asked() -> None:
    kernel = make()
    world = FakeWorld(50 * MS)
    world.quiet_ns = 50 * MS
    kernel.connect(world)
    while kernel.now_ns < 40 * MS:
        kernel.sleep_ns(MS)
        kernel.charge()
        kernel.wait(lambda: False, kernel.now_ns, "spin_once(timeout_sec=0)")
        kernel.wait(lambda: False, kernel.now_ns + MS, "spin_once(timeout_sec=0.001)")
    assert world.asked == []
    kernel.sleep_ns(20 * MS)
    assert len(world.asked) == world.arrived == 1


def test_a_coupled_wait_ends_at_the_event_that_makes_it_ready() -> None:
    kernel = make()
    world = FakeWorld(16 * MS, 32 * MS)
    kernel.connect(world)
    assert kernel.wait(lambda: world.arrived == 2, None, "") is True
    assert kernel.now_ns == 32 * MS


def test_a_coupled_busy_loop_asks_the_world_once_a_slice() -> None:
    kernel = make()
    world = FakeWorld(1_500 * US)
    kernel.connect(world)
    while not world.arrived:
        kernel.charge()
    assert 1_500 * US <= kernel.now_ns <= 2_010 * US
    assert len(world.asked) == 2


def test_polling_meets_the_world_as_soon_as_waiting() -> None:
    kernel = make()
    world = FakeWorld(16 * MS, 32 * MS)
    kernel.connect(world)
    while world.arrived < 2:
        kernel.wait(lambda: False, kernel.now_ns, "spin_once(timeout_sec=0)")
    assert 32 * MS <= kernel.now_ns <= 34 * MS


def test_the_world_is_never_asked_for_a_time_beyond_the_horizon() -> None:
    kernel = make(2)
    world = FakeWorld(*range(16 * MS, 3 * S, 16 * MS))
    kernel.connect(world)
    with pytest.raises(KeyboardInterrupt):
        charge_for_ever(kernel)
    assert max(world.asked) == 2 * S
    assert world.asked == sorted(world.asked)


def test_an_uncoupled_world_is_never_asked() -> None:
    kernel = make()
    world = FakeWorld(16 * MS)
    world.coupled = False
    kernel.connect(world)
    kernel.sleep_ns(S)
    assert world.asked == []


@given(st.lists(st.one_of(st.just("charge"), st.integers(-5, 10**9)), max_size=60), st.booleans())
def test_time_is_the_sum_of_sleeps_and_charges_and_never_decreases(
    steps: list[str | int], coupled: bool
) -> None:
    kernel = make(3_600)
    if coupled:
        kernel.connect(FakeWorld())
    expected = 0
    for step in steps:
        before = kernel.now_ns
        if isinstance(step, str):
            kernel.charge()
            expected += 1_000
        else:
            kernel.sleep_ns(step)
            expected += max(step, 50_000) if step > 0 else 1_000
        assert kernel.now_ns >= before
    assert kernel.now_ns == expected
