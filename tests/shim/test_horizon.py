"""Ctrl+C at the horizon, out of whatever the script waits in; and stalls before it."""

from collections.abc import Callable
from typing import Any

import pytest

S = 10**9
RunScript = Callable[..., Any]

WAITS = {
    "sleep": "time.sleep(100)",
    "sleeps": "while True: time.sleep(1)",
    "clock": "while True: time.time()",
    "join": "t = threading.Thread(target=time.sleep, args=(100,), daemon=True); t.start(); t.join()",
    "event": "threading.Thread(target=time.sleep, args=(100,), daemon=True).start(); threading.Event().wait()",
    "lock": "l = threading.Lock(); l.acquire(); l.acquire(timeout=100)",
    "queue": "queue.Queue().get(timeout=100)",
    "pause": "import signal; signal.pause()",
    "flag": "threading.Timer(100, print).start()\n    while True: pass",
    "select": "import select; select.select([], [], [], 100)",
    "result": "from concurrent.futures import ThreadPoolExecutor as P; P().submit(time.sleep, 100).result()",
}


@pytest.mark.parametrize("wait", WAITS.values(), ids=WAITS)
def test_ctrl_c_reaches_the_main_thread_wherever_it_waits(run_bare: RunScript, wait: str) -> None:
    run = run_bare(
        f"import time, threading, queue\ntry:\n    {wait}\nexcept KeyboardInterrupt:\n    print('ctrl-c')\n"
        "finally:\n    time.sleep(0.5)\n    print('clean')\n",
        horizon_s=5,
    )
    assert run.stdout == "ctrl-c\nclean\n"
    assert run.stderr == ""
    end = run.exit
    assert (end["reason"], end["after_interrupt"], end["t_ns"]) == (0, 1, 5 * S)


def test_an_uncaught_ctrl_c_is_a_normal_end_that_prints_its_traceback(run_bare: RunScript) -> None:
    run = run_bare("import time\ntry:\n    time.sleep(9)\nfinally:\n    print('bye')\n", horizon_s=5)
    end = run.exit
    assert (end["reason"], end["after_interrupt"], end["code"], end["type"]) == (0, 1, 130, "")
    assert run.stdout == "bye\n"
    # Python 3.13 marks a whole line, too
    lines = [line for line in run.stderr.splitlines() if line.strip(" ~^")]
    assert lines == [
        "Traceback (most recent call last):",
        '  File "student.py", line 3, in <module>',
        "    time.sleep(9)",
        "KeyboardInterrupt",
    ]


def test_an_exception_after_ctrl_c_is_reported_as_one(run_bare: RunScript) -> None:
    run = run_bare("import time\ntry:\n    time.sleep(9)\nfinally:\n    1 / 0\n", horizon_s=5)
    end = run.exit
    assert (end["reason"], end["after_interrupt"], end["type"], end["line"]) == (1, 1, "ZeroDivisionError", 5)
    assert "KeyboardInterrupt" in end["text"]


def test_the_scripts_own_handler_is_called_instead(run_bare: RunScript) -> None:
    run = run_bare(
        "import signal, sys, time\nstopping = False\n"
        "def stop(n, f):\n    global stopping\n    stopping = True\n    print('handler')\n"
        "signal.signal(signal.SIGINT, stop)\nwhile not stopping: time.sleep(0.4)\nprint('end')\n",
        horizon_s=5,
    )
    assert run.stdout == "handler\nend\n"
    assert run.exit["reason"] == 0


def test_replacing_the_handler_replaces_what_rclpy_does(run_bare: RunScript) -> None:
    source = (
        "import signal, sys, time\nfrom rclpy._kernel import kernel\n"
        "{before}kernel.on_interrupt(lambda: print('shutdown'))\n{after}time.sleep(9)\n"
    )
    handler = "signal.signal(signal.SIGINT, lambda n, f: sys.exit('handler'))\n"
    run = run_bare(source.format(before=handler, after=""), horizon_s=5)
    assert (run.stdout, run.stderr, run.exit["code"]) == ("shutdown\n", "handler\n", 1)
    run = run_bare(source.format(before="", after=handler), horizon_s=5)
    assert (run.stdout, run.stderr, run.exit["code"]) == ("", "handler\n", 1)


def test_ignoring_ctrl_c_for_ever_is_ended(run_bare: RunScript) -> None:
    run = run_bare(
        "import time\nwhile True:\n    try: time.sleep(1)\n    except KeyboardInterrupt: print('no')\n",
        horizon_s=5,
    )
    assert run.stdout == "no\nno\n"
    end = run.exit
    assert (end["reason"], end["after_interrupt"], end["t_ns"], end["code"]) == (0, 1, 5 * S, 130)


def test_ctrl_c_inside_an_except_block(run_bare: RunScript) -> None:
    run = run_bare(
        "import time\ntry:\n    1 / 0\nexcept ZeroDivisionError:\n    try: time.sleep(9)\n"
        "    except KeyboardInterrupt as e: print(type(e.__context__).__name__)\nprint('on')\n",
        horizon_s=5,
    )
    assert run.stdout == "ZeroDivisionError\non\n"


def test_ctrl_c_in_a_condition_leaves_its_lock_in_order(run_bare: RunScript) -> None:
    run = run_bare(
        "import threading, time\nc = threading.Condition()\ndef hold():\n    time.sleep(4)\n"
        "    with c: time.sleep(3)\nthreading.Thread(target=hold, daemon=True).start()\n"
        "try:\n    with c: c.wait(4.5)\nexcept KeyboardInterrupt: print('ctrl-c', time.time())\n",
        horizon_s=5,
    )
    assert run.stdout.startswith("ctrl-c 1700000007.0")
    assert run.stderr == ""


def test_threads_left_over_after_ctrl_c_do_not_hang_the_run(run_bare: RunScript) -> None:
    run = run_bare(
        "import threading, time\ndef work():\n    while True: time.sleep(0.1)\n"
        "threading.Thread(target=work).start()\n"
        "try: time.sleep(99)\nexcept KeyboardInterrupt: print('main ends')\n",
        horizon_s=5,
    )
    assert run.stdout == "main ends\n"
    assert (run.exit["reason"], run.exit["after_interrupt"]) == (0, 1)


def test_a_thread_that_outlives_main_runs_until_the_horizon(run_bare: RunScript) -> None:
    run = run_bare(
        "import threading, time\ncount = 0\ndef work():\n    global count\n    while True:\n"
        "        time.sleep(0.1)\n        count += 1\n"
        "import atexit; atexit.register(lambda: print(count))\nthreading.Thread(target=work).start()\n",
        horizon_s=5,
    )
    assert run.stdout in ("49\n", "50\n")
    assert (run.exit["reason"], run.exit["after_interrupt"], run.exit["t_ns"]) == (0, 1, 5 * S)
    ignored, *rest = run.stderr.splitlines()
    assert ignored.startswith("Exception ignored in: <module 'threading' from ")
    assert rest == ["KeyboardInterrupt: "]


@pytest.mark.parametrize(
    "start",
    [
        "import threading, time; threading.Thread(target=time.sleep, args=[99]).start()",
        "import concurrent.futures, time; concurrent.futures.ThreadPoolExecutor().submit(time.sleep, 99)",
    ],
)
def test_what_ended_main_before_ctrl_c_is_no_failure_of_the_clean_up(run_bare: RunScript, start: str) -> None:
    """A thread that spins keeps the process, as at home, while the main thread has failed long ago."""
    run = run_bare(f"{start}\n\ntime.sleep(1)\n1 / 0\n", horizon_s=5)
    end = run.exit
    assert (end["reason"], end["after_interrupt"], end["type"], end["line"]) == (1, 0, "ZeroDivisionError", 4)
    assert (end["code"], end["t_ns"]) == (1, 5 * S)


def test_a_stall_names_each_thread_its_line_and_its_call(run_bare: RunScript) -> None:
    run = run_bare(
        "import threading, queue, time\nfrom rclpy._kernel import kernel\n"
        "box = queue.Queue()\ndef work():\n    box.get()\n"
        "threading.Thread(target=work, name='reader').start()\ndef rate():\n"
        "    kernel.wait(lambda: False, None, 'rate.sleep() waits for a timer, but nobody spins the node')\n"
        "time.sleep(1)\nprint('before')\nrate()\n"
    )
    end = run.exit
    assert (end["reason"], end["after_interrupt"], end["t_ns"] // 10**6) == (2, 0, 1000)
    assert end["text"] == (
        "main thread, line 8: rate.sleep() waits for a timer, but nobody spins the node; "
        "reader, line 5: Queue.get() waits for ever"
    )
    assert run.stdout == "before\n"


@pytest.mark.parametrize(
    ("source", "text"),
    [
        ("import threading\nthreading.Event().wait()", "main thread, line 2: Event.wait() waits for ever"),
        ("import threading as t\nl = t.Lock()\nwith l:\n    with l: pass", "line 4: Lock.__enter__()"),
        (
            "import threading\na, b = threading.Lock(), threading.Lock()\n"
            "def f():\n    with b:\n        e.wait(1)\n        a.acquire()\ne = threading.Event()\n"
            "threading.Thread(target=f, name='f').start()\nwith a:\n"
            "    e.wait(2)\n    b.acquire()",
            "main thread, line 11: Lock.acquire() waits for ever; f, line 6: Lock.acquire() waits for ever",
        ),
        ("import threading\nthreading.Barrier(2).wait()", "line 2: Barrier.wait()"),
    ],
)
def test_deadlocks_are_stalls(run_bare: RunScript, source: str, text: str) -> None:
    end = run_bare(source).exit
    assert end["reason"] == 2
    assert text in end["text"]


def test_after_ctrl_c_the_end_of_the_program_waits_for_its_threads(run_bare: RunScript) -> None:
    run = run_bare(
        "import threading, time\ndef work():\n    time.sleep(3)\n    print('done')\n"
        "threading.Thread(target=work).start()\n"
        "try:\n    time.sleep(9)\nexcept KeyboardInterrupt:\n    print('caught')\n",
        horizon_s=2,
    )
    assert (run.stdout, run.stderr, run.exit["code"]) == ("caught\ndone\n", "", 0)
