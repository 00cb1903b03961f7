"""Other programs: a screen is cleared by nothing, turtlesim is there already, the rest is refused."""

from collections.abc import Callable
from typing import Any

RunScript = Callable[..., Any]


def test_a_screen_is_cleared_without_a_program(run_bare: RunScript) -> None:
    run = run_bare(
        "import os, subprocess\n"
        "print(os.system('clear'), subprocess.call('clear', shell=True), repr(os.popen('tput cols').read()))\n"
        "print(subprocess.run(['clear'], capture_output=True, text=True, check=True).stdout == '')\n"
    )
    assert (run.stdout, run.stderr, run.notes) == ("0 0 ''\nTrue\n", "", [])


def test_a_shell_finds_no_program_and_the_script_goes_on(run_bare: RunScript) -> None:
    run = run_bare(
        "import os\nprint(os.system('ros2 service call /reset std_srvs/srv/Empty'), os.system(''))\n"
    )
    assert (run.stdout, run.stderr) == ("32512 0\n", "sh: 1: ros2: not found\n")
    assert run.notes == [("forbidden", "os.system: ros2 service call /reset std_srvs/srv/Empty")]


def test_a_turtlesim_that_is_started_runs_until_it_is_ended(run_bare: RunScript) -> None:
    run = run_bare(
        "import os, signal, subprocess, time\n"
        "print(os.system('ros2 run turtlesim turtlesim_node &'))\n"
        "sim = subprocess.Popen(['ros2', 'run', 'turtlesim', 'turtlesim_node'], stdout=subprocess.PIPE)\n"
        "print(sim.poll(), sim.returncode)\n"
        "try: sim.wait(timeout=2.5)\nexcept subprocess.TimeoutExpired: print(round(time.monotonic(), 3))\n"
        "sim.terminate()\nprint(sim.wait(), sim.poll(), sim.communicate())\n"
        "with subprocess.Popen('ros2 run turtlesim turtlesim_node', shell=True) as sim: sim.kill()\n"
        "os.system('ros2 run turtlesim turtlesim_node')\n",
        horizon_s=10.0,
    )
    assert run.stdout.splitlines() == ["0", "None None", "100002.5", "-15 -15 (b'', None)"]
    assert (run.exit["after_interrupt"], run.exit["code"], [code for code, _ in run.notes]) == (
        1,
        130,
        ["interrupted"],
    )


def test_a_file_or_stream_given_to_a_program_stays_open(run_bare: RunScript) -> None:
    run = run_bare(
        "import subprocess, sys\n"
        "with open('sim.log', 'w') as log:\n"
        "    sim = subprocess.Popen(['ros2', 'run', 'turtlesim', 'turtlesim_node'], stdout=log, stderr=log)\n"
        "    log.write('started')\n"
        "sim.kill()\n"
        "subprocess.run(['clear'], stdout=sys.stdout, stderr=sys.stderr)\n"
        "subprocess.run(['clear'], stdout=subprocess.DEVNULL, stderr=subprocess.STDOUT, stdin=subprocess.PIPE)\n"
        "print(open('sim.log').read(), sim.wait())\n"
    )
    assert (run.stdout, run.stderr, run.notes) == ("started -9\n", "", [])


def test_a_started_turtlesim_is_ended_by_its_number_or_group(run_bare: RunScript) -> None:
    run = run_bare(
        "import os, signal, subprocess\n"
        "turtlesim = 'ros2 run turtlesim turtlesim_node'\n"
        "def start(): return subprocess.Popen(turtlesim, shell=True, preexec_fn=os.setsid)\n"
        "sim = start(); os.killpg(os.getpgid(sim.pid), signal.SIGTERM); print(sim.wait())\n"
        "sim = start(); os.kill(sim.pid, 0); print(sim.poll())\n"
        "os.kill(sim.pid, signal.SIGINT); print(sim.wait())\n"
        "print(os.getpgrp() == os.getpgid(0) == os.getsid(0) == os.getpid())\n"
    )
    assert (run.stdout, run.stderr, run.notes) == ("-15\nNone\n-2\nTrue\n", "", [])
