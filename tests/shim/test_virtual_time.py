"""Clocks, sleeping and dates in a script: exact to the nanosecond."""

from collections.abc import Callable
from typing import Any

import pytest

S = 10**9
RunScript = Callable[..., Any]


def test_sleep_advances_every_clock_alike(run_bare: RunScript) -> None:
    run = run_bare(
        "import time\n"
        "from time import sleep as nap, monotonic as mono\n"
        "a = time.time_ns(), time.monotonic_ns(), time.perf_counter_ns()\n"
        "time.sleep(1.5); nap(2)\n"
        "b = time.time_ns(), time.monotonic_ns(), time.perf_counter_ns()\n"
        "print([y - x for x, y in zip(a, b)], a[0], a[1], mono() < time.monotonic())\n"
    )
    assert run.stdout.split("] ")[0] == "[3500003000, 3500003000, 3500003000"
    assert run.stdout.split("] ")[1].split() == ["1700000000000001000", "100000000002000", "True"]


@pytest.mark.parametrize("name", ["process_time", "thread_time"])
def test_waiting_takes_no_time_of_the_processor(run_bare: RunScript, name: str) -> None:
    """A script that drives until two seconds of `process_time` have passed, and sleeps, drives on at home."""
    run = run_bare(
        f"import time\nclock = time.{name}\nstart = clock()\nlooks = 0\n"
        "while clock() - start < 2.0 and looks < 100:\n    looks += 1\n    time.sleep(0.1)\n"
        "print(looks, clock() - start < 0.01)\n"
        "while time.perf_counter() < 100_011.0: clock()\n"
        "print(round(clock() - start))\n"
    )
    assert run.stdout == "100 True\n1\n"


def test_an_hour_of_sleep_costs_nothing(run_bare: RunScript) -> None:
    run = run_bare("import time\nfor _ in range(3600): time.sleep(1)\nprint(time.time())\n", horizon_s=4000)
    assert run.stdout == "1700003600.000001\n"
    assert run.exit["t_ns"] == 3600 * S + 1000


@pytest.mark.parametrize(
    ("argument", "error"),
    [
        ("-1", "ValueError: sleep length must be non-negative"),
        ("'1'", "TypeError: 'str' object cannot be interpreted as an integer"),
        ("None", "TypeError: 'NoneType' object cannot be interpreted as an integer"),
        ("float('nan')", "ValueError: Invalid value NaN (not a number)"),
        ("float('inf')", "OverflowError: timestamp too large to convert to C _PyTime_t"),
    ],
)
def test_sleep_refuses_what_python_refuses(run_bare: RunScript, argument: str, error: str) -> None:
    run = run_bare(f"import time\ntime.sleep({argument})\n")
    assert run.stderr.splitlines()[-1] == error
    assert run.exit["line"] == 2
    assert "File" in run.stderr
    assert "_patches" not in run.stderr


@pytest.mark.parametrize(
    ("argument", "ns"),
    [("True", S), ("0.07", 70_000_000), ("0.3", 300_000_000), ("1e-9", 50_000), ("0", 1_000)],
)
def test_sleep_rounds_to_whole_nanoseconds(run_bare: RunScript, argument: str, ns: int) -> None:
    assert run_bare(f"import time\ntime.sleep({argument})\n").exit["t_ns"] == ns


def test_local_time_is_virtual(run_bare: RunScript) -> None:
    run = run_bare(
        "import time\n"
        "time.sleep(40)\n"
        "print(time.strftime('%F %T'), time.ctime(), time.asctime(), sep='|')\n"
        "print(time.gmtime().tm_sec, time.localtime(0).tm_year, time.strftime('%Y', time.gmtime(0)))\n"
    )
    assert run.stdout == (
        "2023-11-14 22:14:00|Tue Nov 14 22:14:00 2023|Tue Nov 14 22:14:00 2023\n0 1970 1970\n"
    )


def test_datetime_is_virtual(run_bare: RunScript) -> None:
    run = run_bare(
        "import time\nfrom datetime import datetime, timedelta, timezone, date\n"
        "start = datetime.now()\ntime.sleep(2.5)\n"
        "print(datetime.now() - start, (datetime.now() - start).total_seconds())\n"
        "print(repr(start), datetime.utcnow(), datetime.now(timezone.utc), repr(date.today()))\n"
    )
    assert run.stdout == (
        "0:00:02.500001 2.500002\n"
        "datetime.datetime(2023, 11, 14, 22, 13, 20, 1) 2023-11-14 22:13:22.500004 "
        "2023-11-14 22:13:22.500005+00:00 datetime.date(2023, 11, 14)\n"
    )


@pytest.mark.parametrize("preload", [(), ("datetime",)])
def test_the_datetime_classes_behave_as_the_real_ones(run_bare: RunScript, preload: tuple[str, ...]) -> None:
    run = run_bare(
        "import datetime, copy, pickle\n"
        "d = datetime.datetime(2024, 2, 28, 12)\n"
        "print(isinstance(d.date(), datetime.date), isinstance(d, datetime.date))\n"
        "print(issubclass(datetime.datetime, datetime.date), isinstance(3, datetime.date))\n"
        "print(d + datetime.timedelta(days=2), datetime.datetime.strptime('12:30', '%H:%M').hour)\n"
        "print(pickle.loads(pickle.dumps(d)) == d, copy.deepcopy(d) == d, datetime.datetime.min.year)\n"
        "class Mine(datetime.datetime): pass\nprint(type(Mine.now()).__name__, f'{d:%d.%m.}')\n",
        preload=preload,
    )
    assert run.stdout == "True True\nTrue False\n2024-03-01 12:00:00 12\nTrue True 1\nMine 28.02.\n"


def test_sched_is_virtual(run_bare: RunScript) -> None:
    run = run_bare(
        "import sched, time\ns = sched.scheduler()\nseen = []\n"
        "s.enter(2, 1, lambda: seen.append(round(time.time(), 3)))\n"
        "s.enter(1, 1, lambda: seen.append(round(time.time(), 3)))\ns.run()\nprint(seen)\n"
    )
    assert run.stdout == "[1700000001.0, 1700000002.0]\n"


def test_the_lessons_loop_publishes_as_often_as_at_home(run_bare: RunScript) -> None:
    run = run_bare(
        "import time\nstart = time.time()\ncount = 0\n"
        "while time.time() - start < 2.0:\n    count += 1\n    time.sleep(0.01)\nprint(count)\n"
    )
    assert run.stdout == "200\n"


def test_preloaded_modules_that_copied_a_clock_follow(run_bare: RunScript) -> None:
    run = run_bare(
        "import sched, time\ns = sched.scheduler()\ns.enter(3, 1, print)\ns.run()\n",
        preload=("sched", "queue", "threading", "asyncio", "random", "datetime"),
    )
    assert run.exit["t_ns"] // 10**6 == 3000


@pytest.mark.parametrize("name", ["time", "monotonic", "perf_counter", "process_time", "thread_time"])
def test_a_loop_that_only_looks_at_a_clock_ends(run_bare: RunScript, name: str) -> None:
    run = run_bare(
        f"import time\nclock = time.{name}\nstart = clock()\nlooks = 0\n"
        "while clock() - start < 16.0:\n    looks += 1\nprint(looks)\n"
    )
    assert 30_000 < int(run.stdout) < 40_000
    assert 16 * S <= run.exit["t_ns"] <= 16 * S + 2_000_000


def test_clocks_stay_functions_as_attributes_of_a_class(run_bare: RunScript) -> None:
    run = run_bare(
        "import logging, os, sys, time\n"
        "class Car:\n    now, nap, cwd, load = time.time, time.sleep, os.getcwd, open\n"
        "car = Car()\ncar.nap(1.5)\nprint(car.now(), car.cwd(), car.load('a', 'w').name)\n"
        "logging.basicConfig(stream=sys.stdout, format='%(asctime)s %(message)s')\nlogging.warning('late')\n"
    )
    assert run.stdout == ("1700000001.500003 /home/student/ros2_ws a\n2023-11-14 22:13:21,500 late\n")


def test_functions_are_copied_and_called_by_name_as_those_written_in_c(run_bare: RunScript) -> None:
    run = run_bare(
        "import copy, os, pickle, time\nclass Car: pass\ncar = Car()\ncar.now = time.time\n"
        "print(copy.deepcopy(car).now(), pickle.loads(pickle.dumps(open)) is open, os.getcwd)\n"
        "time.time - 1.0\n"
    )
    assert run.stdout == "1700000000.000001 True <built-in function getcwd>\n"
    assert run.exit["message"] == (
        "unsupported operand type(s) for -: 'builtin_function_or_method' and 'float'"
    )
