"""Randomness and what a script can learn of its host: the same in each run of one seed."""

from collections.abc import Callable
from typing import Any

import pytest

RunScript = Callable[..., Any]
SOURCE = (
    "import random, os, uuid, secrets, tempfile\n"
    "print(random.random(), random.Random().random(), random.SystemRandom().random())\n"
    "print(os.urandom(8), secrets.token_hex(), uuid.uuid4(), uuid.uuid1())\n"
    "print(os.getpid(), os.getppid(), os.cpu_count(), os.sched_getaffinity(0), hash('x'))\n"
    "random.seed(7)\nprint(random.random(), random.Random(7).random(), random.randint(1, 6))\n"
)


@pytest.mark.parametrize("preload", [(), ("random", "uuid", "secrets")])
def test_one_seed_one_outcome(run_bare: RunScript, preload: tuple[str, ...]) -> None:
    first, second = run_bare(SOURCE, seed=1, preload=preload), run_bare(SOURCE, seed=1, preload=preload)
    assert first.stdout == second.stdout
    assert first.stderr == ""
    other = run_bare(SOURCE, seed=2, preload=preload)
    assert first.stdout.splitlines()[0] != other.stdout.splitlines()[0]
    assert (
        first.stdout.splitlines()[-1]
        == other.stdout.splitlines()[-1]
        == "0.32383276483316237 0.32383276483316237 2"
    )


def test_reseeding_without_argument_is_repeatable(run_bare: RunScript) -> None:
    source = "import random\nrandom.seed()\nprint(random.random())\n"
    assert run_bare(source, seed=3).stdout == run_bare(source, seed=3).stdout


@pytest.mark.parametrize("preload", [(), ("resource",)])
def test_what_was_used_is_the_time_in_which_nothing_waited(
    run_bare: RunScript, preload: tuple[str, ...]
) -> None:
    source = (
        "import os, resource, time\ntime.sleep(2)\n"
        "while os.times().elapsed < 3: resource.getrusage(resource.RUSAGE_SELF)\n"
        "used = resource.getrusage(resource.RUSAGE_SELF)\n"
        "print(round(used.ru_utime, 2), round(os.times().user, 2), used.ru_maxrss, sum(used[3:]))\n"
        "resource.getrusage(99)\n"
    )
    run = run_bare(source, preload=preload)
    assert (run.stdout, run.exit["message"]) == ("1.0 1.0 50000 0\n", "invalid who parameter")


def test_urandom_refuses_a_negative_size(run_bare: RunScript) -> None:
    assert run_bare("import os\nprint(os.urandom(0))\nos.urandom(-1)\n").exit["message"] == (
        "negative argument not allowed"
    )


def test_the_host_is_the_same_ubuntu_everywhere(run_bare: RunScript) -> None:
    run = run_bare(
        "import getpass, os, platform, shelve, shutil, socket, sys\n"
        "print(getpass.getuser(), os.getlogin(), os.getuid(), os.getgroups())\n"
        "print(os.environ['HOME'], os.getenv('ROS_DISTRO'), *sys.orig_argv)\n"
        "print(socket.gethostname(), platform.system(), platform.node(), platform.machine())\n"
        "print(os.get_terminal_size().columns, shutil.get_terminal_size().lines, os.getloadavg())\n"
        "with shelve.open('kept') as shelf: shelf['laps'] = 3\n"
        "with shelve.open('kept') as shelf: print(dict(shelf))\n"
    )
    assert run.stdout.splitlines() == [
        "student student 1000 [1000]",
        "/home/student humble /usr/bin/python3 student.py",
        "ubuntu Linux ubuntu x86_64",
        "80 24 (0.0, 0.0, 0.0)",
        "{'laps': 3}",
    ]


def test_a_window_finds_no_screen(run_bare: RunScript) -> None:
    pytest.importorskip("_tkinter")
    run = run_bare("import tkinter\ntkinter.Tk()\n")
    assert (run.exit["type"], run.exit["message"]) == (
        "TclError",
        "no display name and no $DISPLAY environment variable",
    )


def test_a_full_screen_program_finds_no_terminal(run_bare: RunScript) -> None:
    pytest.importorskip("_curses")
    run = run_bare("import curses\ncurses.wrapper(print)\n")
    assert (run.exit["type"], run.exit["message"]) == ("error", "setupterm: could not find terminal")


def test_no_recursion_is_deeper_than_the_stack_at_home(run_bare: RunScript) -> None:
    run = run_bare(
        "import sys\nsys.setrecursionlimit(10**9)\ndeep = 0\n"
        "def fall():\n    global deep\n    deep += 1\n    fall()\n"
        "try: fall()\nexcept RecursionError: print(29_000 < deep < 30_000)\n"
        "for limit in 0, 2**40, '9':\n"
        "    try: sys.setrecursionlimit(limit)\n"
        "    except Exception as error: print(type(error).__name__)\n"
    )
    assert run.stdout.splitlines() == ["True", "ValueError", "OverflowError", "TypeError"]
