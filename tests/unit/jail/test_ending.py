"""How runs end, and what the account of an end says."""

import os

import pytest

from grader.contracts.assignment import MIB, Limits
from grader.jail import bounds, landlock
from grader.sandbox import RunEnd, Sandbox
from tests.fakes.processes import process_of
from tests.fakes.waiting import wait_until
from tests.unit.jail.running import run

SILENT = "import os\nprint('a', flush=True)\nos.read(channel, 5)\nwhile True: pass"
"""Says something, waits until that was seen, and is silent from then on."""

pytestmark = pytest.mark.skipif(landlock.abi_version() == 0, reason="this kernel has no Landlock")


@pytest.mark.parametrize(
    ("source", "end", "settled"),
    [
        ("print('a')", RunEnd.FINISHED, True),
        (SILENT, RunEnd.CPU_LIMIT, True),
        ("n = 0\nwhile True:\n    n += 1\n    if n % 10000 == 0: print(n)", RunEnd.CPU_LIMIT, False),
        ("while True: print('a' * 99)", RunEnd.OUTPUT_LIMIT, True),
        ("import sys\nwhile True: print('a'); print('b', file=sys.stderr)", RunEnd.OUTPUT_LIMIT, False),
        ("import os\nos.write(channel, bytes(4))\nwhile True: print('a')", RunEnd.PROTOCOL, False),
    ],
)
def test_it_is_told_whether_output_depends_on_the_moment_of_a_kill(
    sandbox: Sandbox, source: str, end: RunEnd, settled: bool
) -> None:
    with sandbox.open(Limits(cpu_s=0.4, output_bytes=200_000)) as jail:
        jail.send(source.encode())
        while not jail._stdout.total_bytes and jail._ending is None:
            jail._tend(0)
        jail.send(b"g")  # or else its silence would begin when this process gets round to looking
        while jail.receive() is not None:
            pass
        report = jail.close()
    assert (report.end, report.settled) == (end, settled)


def test_a_slow_episode_makes_nobody_look_busy(sandbox: Sandbox) -> None:
    """Whether a script was silent for long is the same however long the episode takes over its frames."""
    source = SILENT.replace("print", "os.write(channel, b'\\1\\0\\0\\0a\\1\\0\\0\\0b'); print")
    with sandbox.open(Limits(cpu_s=0.6)) as jail:
        jail.send(source.encode())
        assert jail.receive() == b"a"
        wait_until(process_of(jail).sleeps)
        jail._next_glance_ns = 0
        assert jail.receive() == b"b"
        start_ns = process_of(jail).cpu_ns()
        jail.send(b"g")
        wait_until(lambda: process_of(jail).cpu_ns() > start_ns + 350_000_000)
        assert jail.receive() is None
        report = jail.close()
    assert (report.end, report.stdout.text, report.settled) == (RunEnd.CPU_LIMIT, "a\n", True)


def test_c_code_that_dies_for_lack_of_memory_met_the_memory_limit(sandbox: Sandbox) -> None:
    hoard = "import os\nkept = []\ntry:\n    while True: kept.append(bytearray(1 << 20))\n"
    _, report = run(sandbox, hoard + "except MemoryError: os.abort()", memory_bytes=96 * MIB)
    assert (report.end, report.signal) == (RunEnd.MEMORY_LIMIT, "SIGABRT")
    _, report = run(sandbox, "import os\nos.abort()", memory_bytes=96 * MIB)
    assert (report.end, report.signal) == (RunEnd.CRASHED, "SIGABRT")


def test_a_real_time_signal_is_told_by_its_number(sandbox: Sandbox) -> None:
    with sandbox.open(Limits()) as jail:
        jail.send(b"frame(b'ready')\nwhile True: pass")
        assert jail.receive() == b"ready"
        os.kill(process_of(jail).pid, 40)
        assert jail.receive() is None
        report = jail.close()
    assert (report.end, report.signal) == (RunEnd.CRASHED, "signal 40")
    assert report.detail == "the process was ended by signal 40"


def test_last_words_of_a_killed_script_are_kept(sandbox: Sandbox) -> None:
    _, report = run(sandbox, "print('last words')\nwhile True: pass", cpu_s=0.2)
    assert report.stdout.text == "last words\n"


def test_grace_after_the_horizon(sandbox: Sandbox) -> None:
    with sandbox.open(Limits(cpu_s=60.0)) as jail:
        jail.send(b"frame(b'horizon')\nwhile True: pass")
        assert jail.receive() == b"horizon"
        jail.limit_cpu(0.1)
        assert jail.receive() is None
        report = jail.close()
    assert report.end is RunEnd.CPU_LIMIT
    assert report.cpu_ns < 30_000_000_000


def test_closing_early_ends_the_process_without_blame(sandbox: Sandbox) -> None:
    with sandbox.open(Limits()) as jail:
        jail.send(b"while True: pass")
        report = jail.close()
        assert jail.close() is report
    assert (report.end, report.exit_code, report.signal) == (RunEnd.FINISHED, None, None)


def test_a_script_that_waits_in_crumbs_ends_at_the_wall_limit(sandbox: Sandbox) -> None:
    with sandbox.open(Limits(wall_s=0.5)) as jail:
        jail.send(b"import time\nwhile True:\n    time.sleep(0.002)\n    frame(b'x')")
        while jail.receive() is not None:
            pass
        assert jail.close().end is RunEnd.STALLED


def test_frames_that_cost_the_grader_too_much_end_the_script(
    sandbox: Sandbox, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(bounds, "WORK_PER_CPU", 0.02)
    with sandbox.open(Limits(cpu_s=5.0)) as jail:
        jail.send(b"while True: frame(b'x')")
        while jail.receive() is not None:
            sum(range(30_000))
        report = jail.close()
    assert report.end is RunEnd.CPU_LIMIT
    assert "simulator" in report.detail


def test_a_kill_from_outside_blames_the_host(sandbox: Sandbox) -> None:
    with sandbox.open(Limits()) as jail:
        jail.send(b"while True: pass")
        process_of(jail).kill()
        assert jail.receive() is None
        assert jail.close().end is RunEnd.INFRASTRUCTURE


def test_a_script_that_the_host_ended_with_more_than_its_memory_met_the_memory_limit(
    sandbox: Sandbox,
) -> None:
    """Shared mappings are not private memory; the kernel ends the hungriest when the host runs short."""
    hungry = (
        "import mmap\nkept = mmap.mmap(-1, 200 << 20)\nfor at in range(0, len(kept), 4096): kept[at] = 1\n"
        "frame(b'full')\nwhile True: pass"
    )
    with sandbox.open(Limits(memory_bytes=120 * MIB)) as jail:
        jail.send(hungry.encode())
        assert jail.receive() == b"full"
        process_of(jail).kill()
        assert jail.receive() is None
        assert jail.close().end is RunEnd.MEMORY_LIMIT


def test_a_script_that_sleeps_for_ever_is_stalled(sandbox: Sandbox, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bounds, "IDLE_LIMIT_NS", 100_000_000)
    _, report = run(sandbox, "import os\nos.read(os.pipe()[0], 1)")
    assert report.end is RunEnd.STALLED
