"""Scripts driven by timers, and by the 1.0 s for which a command is held."""

from math import pi, radians

from grader.contracts.outcome import RunStatus
from tests.styles.expectation import Expectation, drive
from tests.styles.ideal import Leg

INTERRUPTED = RunStatus.INTERRUPTED

EXPECTED = {
    "timer_counter": Expectation(
        plan=drive(0.1, *[(2.0, 1.0, 0.0), (1.0, 0.0, pi / 2)] * 4), status=INTERRUPTED, says=("完成",)
    ),
    # `elapsed >= 2.0` holds after two seconds, though the phase began later in its tick than the look comes.
    "timer_state_machine": Expectation(
        plan=drive(0.05, (1.95, 1.0, 0.0), (2.0, 0.0, pi / 3), *[(2.0, 1.0, 0.0), (2.0, 0.0, pi / 3)] * 2),
        says=("FORWARD -> TURN", "TURN -> FORWARD", "TURN -> DONE", "bye"),
        exit_code=0,
    ),
    # The tick that stops sends a stop already, so the last turn is one tick short.
    "timer_elapsed": Expectation(
        plan=drive(0.1, *[(2.0, 1.0, 0.0), (1.0, 0.0, pi / 2)] * 3, (2.0, 1.0, 0.0), (0.9, 0.0, pi / 2)),
        status=INTERRUPTED,
    ),
    "timer_cancel_reset": Expectation(
        plan=(Leg(0.1, 0.95, 0.8), Leg(2.2, 0.95, 0.8), Leg(4.3, 0.95, 0.8), Leg(6.4, 0.95, 0.8)),
        status=INTERRUPTED,
        horizon_s=8.0,
        says=("pause", "resume", "pause", "resume", "pause", "resume", "pause"),
    ),
    "two_timers": Expectation(
        plan=drive(0.02, (2.5, 1.2, 0.0), (1.98, 0.0, -0.5)),
        status=INTERRUPTED,
        stdout="stopped by user\n",
    ),
    # The last command is sent at 3.0 s (the canceling timer comes after it) and held for one second.
    "lambda_timer": Expectation(plan=(Leg(0.1, 3.9, 1.0, 0.5),), status=INTERRUPTED),
    "old_school_spin_once": Expectation(plan=(Leg(0.25, 1.75, -1.0),), exit_code=0),
    "one_per_second_hold": Expectation(plan=drive(0.0, (2.0, 1.0, 0.0), (1.0, 0.0, pi / 2), (3.0, 1.0, 0.0))),
    "single_publish": Expectation(plan=(Leg(0.0, 1.0, 2.0, 1.0),), stdout="published once\n"),
    "slow_publisher_gaps": Expectation(
        plan=(Leg(1.5, 1.0, 1.0), Leg(3.0, 1.0, 1.0), Leg(4.5, 1.0, 1.0)), says=("push 1", "push 2", "push 3")
    ),
    # Each call comes as soon as the one before has slept: a late timer is called at once, not made up for.
    "sleeping_callback": Expectation(plan=drive(0.5, *[(0.9, 1.0, 0.0), (0.9, 0.0, 1.57)] * 2)),
    # StopIteration out of a coroutine is a RuntimeError, so the script's `except` misses it (PEP 479).
    "generator_plan": Expectation(
        plan=drive(0.05, (1.5, 1.0, 0.0), (0.5, 0.0, -1.0), (1.0, 1.0, 0.0)),
        status=RunStatus.CRASHED,
        error="RuntimeError",
        says=("coroutine raised StopIteration",),
        exit_code=1,
    ),
    "cycle_for_ever": Expectation(
        plan=drive(0.1, *[(2.0, 1.0, 0.0), (1.0, 0.0, radians(120.0))] * 4),
        status=INTERRUPTED,
        horizon_s=12.1,
        exit_code=0,
    ),
    "spiral": Expectation(
        plan=drive(0.5, *[(0.5, v / 10, 1.0) for v in range(5, 16)]), stdout="end of spiral\n", exit_code=0
    ),
    "figure_eight": Expectation(plan=drive(0.0, (3.15, 2.0, 2.0), (3.15, 2.0, -2.0))),
    "match_statement": Expectation(
        plan=drive(
            1.0, (2.0, 1.0, 0.0), (1.0, 0.0, 1.0), (1.0, -1.0, 0.0), (1.0, 0.0, -1.0), (1.0, 1.0, 0.0)
        ),
        status=INTERRUPTED,
    ),
    "straight_for_ever_100hz": Expectation(
        plan=(Leg(0.01, 7.99, 0.25),), status=INTERRUPTED, horizon_s=8.0, exit_code=130
    ),
    "into_the_wall": Expectation(
        plan=(Leg(0.1, 5.544444 / 2.0, 2.0), Leg(4.1, 2.0, -2.0)), status=INTERRUPTED, notes=("wall",)
    ),
    "logging_throttle": Expectation(
        plan=(Leg(0.1, 2.5, 1.0),),
        exit_code=3,
        says=("moving", "first time only", "not the first time", "moving", "moving", "the end"),
    ),
    "non_ascii_names": Expectation(
        plan=(Leg(0.1, 1.5, 1.0),),
        status=INTERRUPTED,
        stdout="结束啦\n",
        says=("[INFO] [1700000002.2", "[wugui]: 🐢 走了1.5米,“完成” ✓"),
    ),
}
