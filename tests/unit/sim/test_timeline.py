from fractions import Fraction

from hypothesis import given
from hypothesis import strategies as st

from grader.sim.car import NS_PER_S, STEPS_PER_S, UPDATE_NS, last_step_at, next_update, step_time_ns

STEPS = st.integers(0, 10**9)
TIMES = st.integers(0, 10**18)


@given(STEPS)
def test_a_step_stands_at_its_share_of_a_second_rounded_down(step: int) -> None:
    exact = Fraction(step * NS_PER_S, STEPS_PER_S)
    assert step_time_ns(step) == exact.__floor__()


@given(STEPS)
def test_whole_seconds_are_exact(second: int) -> None:
    assert step_time_ns(second * STEPS_PER_S) == second * NS_PER_S


@given(TIMES)
def test_a_command_is_taken_by_the_first_update_after_it(t_ns: int) -> None:
    update = next_update(t_ns)
    assert (update - 1) * UPDATE_NS <= t_ns < update * UPDATE_NS


@given(TIMES)
def test_the_last_step_is_not_after_its_time(t_ns: int) -> None:
    step = last_step_at(t_ns)
    assert step_time_ns(step) <= t_ns < step_time_ns(step + 1)


@given(STEPS)
def test_steps_and_times_are_inverse(step: int) -> None:
    assert last_step_at(step_time_ns(step)) == step
