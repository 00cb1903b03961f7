"""Scripts with threads, spin loops of their own, busy loops, and other ways to let time pass."""

from math import pi

from grader.contracts.outcome import RunStatus
from tests.styles.expectation import Expectation, drive
from tests.styles.ideal import Leg

INTERRUPTED = RunStatus.INTERRUPTED

EXPECTED = {
    "thread_daemon": Expectation(
        plan=drive(0.0, (1.5, 1.0, 0.0), (1.0, 0.0, 1.0), (1.5, 1.0, 0.0)),
        status=INTERRUPTED,
        says=("thread done",),
    ),
    "thread_not_daemon": Expectation(
        plan=(Leg(0.0, 3.0, 1.0),), stdout="main finished\nworker finished\n", exit_code=0
    ),
    "thread_subclass": Expectation(
        plan=drive(0.02, (1.98, 1.0, 0.0), (1.0, 0.0, 1.0), (1.0, 1.0, 0.5)), stdout="mover alive: False\n"
    ),
    "spin_thread_rate": Expectation(
        plan=drive(0.0, *[(1.0, 1.0, 0.0), (1.0, 0.0, pi / 2)] * 4), stdout="joined\n", exit_code=0
    ),
    "spin_once_rate": Expectation(plan=(Leg(0.0, 2.0, 1.0),)),
    "spin_once_timeout": Expectation(plan=drive(0.0, (2.0, 1.0, 0.0), (2.0, 0.0, -0.785), (2.0, 1.0, 0.0))),
    "spin_once_polling": Expectation(plan=(Leg(0.016, 2.0, 1.0),)),
    "busy_ros_clock": Expectation(plan=drive(0.0, *[(1.0, 1.0, 0.0), (1.0, 0.0, 1.5708)] * 2)),
    "busy_time": Expectation(plan=(Leg(0.0, 2.0, 1.5),), stdout="2.0\n"),
    "busy_perf_counter": Expectation(plan=drive(0.0, *[(0.8, 1.0, 0.0), (0.5, 0.0, 1.0)] * 3), stdout="39\n"),
    # The turn is commanded once, at 0.8 s, and held for one second.
    "busy_flag": Expectation(plan=drive(0.0, (0.8, 1.0, 0.0), (1.0, 0.0, 1.0)), stdout="flag seen\n"),
    "threading_timer": Expectation(plan=(Leg(0.1, 2.0, 1.0),), status=INTERRUPTED),
    "event_wait": Expectation(plan=(Leg(0.1, 1.95, 0.5),), stdout="half way\n", says=("20 messages",)),
    "condition_ping_pong": Expectation(plan=drive(0.0, *[(0.75, 1.0, 0.0), (0.75, 0.0, 1.0)] * 2)),
    "thread_pool_of_processes": Expectation(plan=drive(0.0, *[(0.75, 1.0, 0.0), (0.75, 0.0, 1.0)] * 2)),
    "queue_worker": Expectation(
        plan=drive(0.0, (1.0, 1.0, 0.0), (0.5, 0.0, 1.0), (0.5, 1.0, 0.0), (1.0, 0.0, -1.0)),
        stdout="all done\n",
        says=("nothing to do",),
    ),
    "thread_pool": Expectation(plan=drive(0.0, (0.8, 1.0, 0.0), (0.8, 0.0, 1.0)), stdout="[0.0, 0.8, 1.6]\n"),
    "asyncio_run": Expectation(plan=drive(0.0, (2.0, 1.0, 0.0), (1.0, 0.0, 1.0)), stdout="7\n"),
    "asyncio_spin_once": Expectation(plan=drive(0.1, (1.5, 1.0, 0.0), (1.0, -1.0, 0.0))),
    "datetime_deadline": Expectation(plan=(Leg(0.0, 3.0, 0.5, 0.5),), stdout="3 秒\n"),
    "signal_alarm": Expectation(plan=(Leg(0.0, 2.0, 1.0),), stdout="time is up\n", exit_code=0),
    "sched_module": Expectation(plan=drive(0.0, (2.0, 1.0, 0.0), (0.5, 0.0, 2.0))),
    "duration_arithmetic": Expectation(
        plan=drive(0.0, (1.5, 1.0, 0.0), (1.5, 0.0, -1.0)), stdout="True (3, 5)\n"
    ),
    "clock_sleep_until": Expectation(plan=(Leg(0.0, 2.0, 1.0),), exit_code=0),
    "guard_condition": Expectation(
        plan=drive(0.0, (0.9, 1.0, 0.0), (0.9, 0.0, 1.0), (0.9, 1.0, 0.0)), stdout="spin returned\n"
    ),
    "multithreaded_groups": Expectation(
        plan=drive(0.05, (2.0, 0.5, 0.0), (2.95, 0.5, 0.5)), says=("slow callback ends",)
    ),
    "executor_task": Expectation(
        plan=drive(0.0, (0.9, 1.0, 0.0), (0.9, 0.0, 1.0), (0.9, 1.0, 0.0)), stdout="driven\n"
    ),
    "own_context_executor": Expectation(plan=(Leg(0.1, 1.0, 1.0),), stdout="False False\n"),
}
