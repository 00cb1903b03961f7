"""Signals, alarms and interval timers in virtual time."""

from collections.abc import Callable
from typing import Any

import pytest

RunScript = Callable[..., Any]
CLOCK = "import signal, time, os\ndef now(): return round(time.time() - 1.7e9, 3)\n"


def lines(run: Any) -> list[str]:
    assert run.stderr == ""
    out: list[str] = run.stdout.splitlines()
    return out


@pytest.mark.parametrize("preload", [(), ("signal",)])
def test_alarm_interrupts_a_sleep_and_the_sleep_goes_on(
    run_bare: RunScript, preload: tuple[str, ...]
) -> None:
    run = run_bare(
        CLOCK
        + "signal.signal(signal.SIGALRM, lambda n, f: print('alarm', n == signal.SIGALRM, f.f_lineno, now()))\n"
        "print(signal.alarm(2), signal.alarm(3))\ntime.sleep(5)\nprint(now())\n",
        preload=preload,
    )
    assert lines(run) == ["0 2", "alarm True 5 3.0", "5.0"]


def test_an_interval_timer_drives_a_loop(run_bare: RunScript) -> None:
    run = run_bare(
        CLOCK + "ticks = []\nsignal.signal(signal.SIGALRM, lambda n, f: ticks.append(now()))\n"
        "print(signal.setitimer(signal.ITIMER_REAL, 0.5, 0.25))\n"
        "while len(ticks) < 4: signal.pause()\nprint(ticks)\n"
        "left, every = signal.setitimer(signal.ITIMER_REAL, 0); print(round(left, 3), every)\ntime.sleep(1)\n"
        "print(len(ticks))\n"
    )
    assert lines(run) == ["(0.0, 0.0)", "[0.5, 0.75, 1.0, 1.25]", "0.25 0.25", "4"]


def test_an_alarm_interrupts_a_busy_loop(run_bare: RunScript) -> None:
    run = run_bare(
        CLOCK + "def late(n, f): raise TimeoutError\nsignal.signal(signal.SIGALRM, late)\nsignal.alarm(1)\n"
        "try:\n    while True: now()\nexcept TimeoutError: print(int(now()))\n"
    )
    assert lines(run) == ["1"]


def test_an_alarm_without_handler_ends_the_script(run_bare: RunScript) -> None:
    run = run_bare(CLOCK + "print('on', flush=True)\nsignal.alarm(1)\ntime.sleep(5)\nprint('never')\n")
    assert lines(run) == ["on"]
    assert (run.exit["reason"], run.exit["code"], run.exit["t_ns"]) == (0, 142, 10**9)


def test_a_script_may_signal_itself(run_bare: RunScript) -> None:
    run = run_bare(
        CLOCK + "signal.signal(signal.SIGUSR1, lambda n, f: print('usr1'))\n"
        "os.kill(os.getpid(), signal.SIGUSR1); signal.raise_signal(signal.SIGUSR1)\n"
        "try: signal.raise_signal(signal.SIGINT)\nexcept KeyboardInterrupt: print('ctrl-c')\n"
        "import _thread, threading\nthreading.Timer(1, _thread.interrupt_main).start()\n"
        "try: time.sleep(5)\nexcept KeyboardInterrupt: print('ctrl-c', now())\n"
    )
    assert lines(run) == ["usr1", "usr1", "ctrl-c", "ctrl-c 1.0"]


def test_signal_refuses_what_pythons_refuses(run_bare: RunScript) -> None:
    run = run_bare(
        CLOCK + "import threading\ndef attempt(*a):\n    try: print(signal.signal(*a))\n"
        "    except Exception as e: print(type(e).__name__, e)\n"
        "attempt(signal.SIGINT, 5); attempt(99, print); attempt(signal.SIGKILL, print)\n"
        "print(signal.getsignal(signal.SIGINT) is signal.default_int_handler)\n"
        "print(signal.signal(signal.SIGINT, signal.SIG_IGN) is signal.default_int_handler)\n"
        "t = threading.Thread(target=attempt, args=(signal.SIGINT, print)); t.start(); t.join()\n"
    )
    assert lines(run) == [
        "TypeError signal handler must be signal.SIG_IGN, signal.SIG_DFL, or a callable object",
        "ValueError signal number out of range",
        "OSError [Errno 22] Invalid argument",
        "True",
        "True",
        "ValueError signal only works in main thread of the main interpreter",
    ]


@pytest.mark.parametrize("send", ["signal.raise_signal", "lambda s: os.kill(os.getpid(), s)"])
@pytest.mark.parametrize(
    ("name", "raised"), [("SIGINT", "KeyboardInterrupt"), ("SIGTERM", "ExternalShutdownException")]
)
def test_a_signal_shuts_the_context_down_whoever_sends_it(
    run_script: Callable[..., Any], send: str, name: str, raised: str
) -> None:
    run = run_script(
        "import os, signal, threading, time, rclpy\n"
        f"send = {send}\n"
        "rclpy.init()\nnode = rclpy.create_node('n')\n"
        f"threading.Thread(target=lambda: (time.sleep(1), send(signal.{name}))).start()\n"
        "try:\n    rclpy.spin(node)\nexcept BaseException as error:\n    print(type(error).__name__)\n"
        "print(rclpy.ok(), time.time() < 1.7e9 + 1.1)\n"
    )
    assert run.stdout == f"{raised}\nFalse True\n"


def test_without_rclpy_sigterm_ends_the_process(run_script: Callable[..., Any]) -> None:
    run = run_script("import signal\nsignal.raise_signal(signal.SIGTERM)\nprint('never')\n")
    assert (run.stdout, run.exit["code"]) == ("", 143)
