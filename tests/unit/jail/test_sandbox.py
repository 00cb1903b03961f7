"""The sandbox as the episode uses it."""

import errno
import json
import os
import select
import subprocess
import sys
import time
from pathlib import Path

import pytest

from grader.contracts.assignment import MIB, Limits
from grader.contracts.errors import NoRoomError, SandboxError
from grader.jail import bounds, landlock, supervisor
from grader.sandbox import RunEnd, Sandbox
from tests.fakes.processes import process_of, spare_of, zygote_of
from tests.fakes.waiting import wait_until
from tests.unit.jail.running import RUNNER, make, run

pytestmark = pytest.mark.skipif(landlock.abi_version() == 0, reason="this kernel has no Landlock")

NEW_OBJECTS = "[id(new()) for new in (object, list, dict, set, lambda: 2.5 * int('3'))]"
"""Where objects of several kinds and sizes lie. Among them are those of which Python keeps some for later."""
ECHO = b"""
import os
while True:
    size = int.from_bytes(os.read(channel, 4), "little")
    body = b""
    while len(body) < size:
        body += os.read(channel, size - len(body))
    frame(body[:60000])
"""


def test_frames_output_and_exit_code(sandbox: Sandbox) -> None:
    source = "import sys\nframe(b'one')\nprint('out')\nprint('err', file=sys.stderr)\nsys.exit(3)"
    frames, report = run(sandbox, source)
    assert frames == [b"one", b"end"]
    assert (report.end, report.exit_code, report.signal, report.detail) == (RunEnd.FINISHED, 3, None, "")
    assert (report.stdout.text, report.stderr.text) == ("out\n", "err\n")
    assert report.cpu_ns > 0
    assert report.peak_bytes > MIB


def test_flags_of_descriptor_0_do_not_reach_the_next_run(sandbox: Sandbox) -> None:
    source = (
        "import fcntl, os\nflags = fcntl.fcntl(0, fcntl.F_GETFL)\nprint(flags & (os.O_NONBLOCK | os.O_APPEND))\n"
        "fcntl.fcntl(0, fcntl.F_SETFL, flags | os.O_NONBLOCK | os.O_APPEND)"
    )
    assert [run(sandbox, source)[1].stdout.text for _ in range(2)] == ["0\n", "0\n"]


def test_frames_before_a_limit_are_still_delivered(sandbox: Sandbox) -> None:
    frames, report = run(sandbox, "for n in range(9): frame(b'%d' % n)\nwhile True: pass", cpu_s=0.2)
    assert frames == [b"%d" % n for n in range(9)]
    assert report.end is RunEnd.CPU_LIMIT
    assert "0.2 s" in report.detail


def test_frames_in_the_channel_outlive_the_process(sandbox: Sandbox) -> None:
    """What was sent before the kill is delivered although nobody had read it by then."""
    with sandbox.open(Limits(cpu_s=0.2)) as jail:
        jail.send(b"frame(b'begun')\nfor n in range(20): frame(b'x' * 5000)\nwhile True: pass")
        assert jail.receive() == b"begun"
        while jail._ending is None:
            jail._tend(0)
        frames = list(iter(jail.receive, None))
        report = jail.close()
    assert frames == [b"x" * 5000] * 20
    assert report.end is RunEnd.CPU_LIMIT


def test_the_largest_frames_pass_in_both_directions(sandbox: Sandbox) -> None:
    with sandbox.open(Limits()) as jail:
        jail.send(ECHO)
        for size in (1, 4096, 60_000, 4 * MIB):
            jail.send(b"x" * size)
            assert jail.receive() == b"x" * min(size, 60_000)


def test_sending_never_blocks_for_ever(sandbox: Sandbox) -> None:
    with sandbox.open(Limits(cpu_s=0.2)) as jail:
        jail.send(b"while True: pass")
        jail.send(b"x" * (8 * MIB))
        assert jail.receive() is None
        assert jail.close().end is RunEnd.CPU_LIMIT


def test_sending_to_a_script_that_only_sends_ends(sandbox: Sandbox) -> None:
    with sandbox.open(Limits(cpu_s=2.0)) as jail:
        jail.send(b"while True: frame(b'x' * 60000)")
        jail.send(b"y" * (8 * MIB))
        while jail.receive() is not None:
            pass
        assert jail.close().end is RunEnd.PROTOCOL


def test_sending_after_the_end_is_harmless(sandbox: Sandbox) -> None:
    with sandbox.open(Limits()) as jail:
        jail.send(b"import os; os._exit(0)")
        assert jail.receive() is None
        jail.send(b"too late")
        assert jail.receive() is None


def test_a_slow_episode_does_not_make_a_script_stalled(
    sandbox: Sandbox, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(bounds, "IDLE_LIMIT_NS", 50_000_000)
    with sandbox.open(Limits()) as jail:
        jail.send(ECHO)
        for _ in range(3):
            time.sleep(0.1)
            jail.send(b"x")
            assert jail.receive() == b"x"


def test_a_script_that_waits_for_the_answer_to_its_question_is_not_stalled(
    sandbox: Sandbox, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(bounds, "IDLE_LIMIT_NS", 50_000_000)
    ask = (  # it computes for several ticks, asks, and sleeps until it is answered
        "import os, time\nwhile True:\n    end = time.perf_counter() + 0.018\n"
        "    while time.perf_counter() < end: pass\n"
        "    os.write(channel, b'\\1\\0\\0\\0?')\n    os.read(channel, 9)\n"
    )
    with sandbox.open(Limits()) as jail:
        # It falls asleep as soon as it has asked, which is seldom quick enough to be seen.
        monkeypatch.setattr(
            process_of(jail), "sleeps", lambda: bool(select.select([jail._channel], [], [], 0)[0])
        )
        jail.send(ask.encode())
        for _ in range(30):
            assert jail.receive() == b"?"
            jail.send(b"!")


def test_parallel_runs_do_not_disturb_each_other(sandbox: Sandbox) -> None:
    source = "print(object(), {'x', 'y', 'z'})"
    alone = run(sandbox, source)[1].stdout
    with sandbox.open(Limits(cpu_s=5.0)) as hostile:
        hostile.send(b"while True: print('x')")
        for _ in range(5):
            assert run(sandbox, source)[1].stdout == alone


def test_many_runs_leave_nothing_behind(sandbox: Sandbox) -> None:
    texts = set()
    run(sandbox, "pass")
    before = len(os.listdir("/proc/self/fd"))
    for n in range(60):
        source = "import os; os.abort()" if n % 5 == 0 else f"print({{'p', 'q', 'r'}}, {NEW_OBJECTS})"
        texts.add(run(sandbox, source)[1].stdout.text)
    assert len(os.listdir("/proc/self/fd")) <= before  # what other tests left open may be closed meanwhile
    assert len(texts - {""}) == 1


def test_the_zygote_is_replaced_when_it_dies() -> None:
    with make() as sandbox:
        run(sandbox, "pass")
        zygote_of(sandbox).kill()
        zygote_of(sandbox).wait()
        assert run(sandbox, "frame(b'again')")[0] == [b"again", b"end"]


def test_a_dying_zygote_takes_its_runs_along_and_blames_nobody() -> None:
    with make() as sandbox:
        jail = sandbox.open(Limits(cpu_s=30.0))
        jail.send(b"while True: pass")
        zygote_of(sandbox).kill()
        assert jail.receive() is None
        with pytest.raises(SandboxError):
            jail.close()
        others = [os.dup(0) for _ in range(8)]  # with the numbers that became free
        with pytest.raises(SandboxError):
            jail.close()
        for other in others:
            os.close(other)
        sandbox.prepare(Limits())
        assert spare_of(sandbox) is not None, "a run counts as open, or as ended twice"


ABANDONED = """
import sys
from pathlib import Path
from grader.contracts.assignment import Limits
from grader.sandbox import Layer, Sandbox

without = frozenset(map(Layer, sys.argv[2:]))
sandbox = Sandbox(shim_path=Path(sys.argv[1]), entry="bare_runner:run", without=without)
jail = sandbox.open(Limits(cpu_s=300.0))
jail.send(b"while True: pass")
print(sandbox._zygote._process.pid, jail._process.pid, flush=True)
sys.stdin.read()
"""


@pytest.mark.parametrize("without", [(), ("namespaces",)], ids=["namespaces", "docker"])
def test_killing_the_grading_process_ends_everything(without: tuple[str, ...]) -> None:
    command = [sys.executable, "-c", ABANDONED, str(RUNNER), *without]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as grading:
        assert grading.stdout
        pids = grading.stdout.readline().split()
        assert len(pids) == 2
        assert all(is_alive(pid) for pid in pids)
        grading.kill()
    wait_until(lambda: not any(is_alive(pid) for pid in pids))


def is_alive(pid: str) -> bool:
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


@pytest.mark.parametrize("told", [OSError(errno.EAGAIN, "…"), OSError(errno.ENOMEM, "…"), MemoryError()])
def test_a_host_that_has_nothing_to_spare_for_a_moment_loses_no_layer(
    monkeypatch: pytest.MonkeyPatch, told: Exception
) -> None:
    with make() as sandbox:
        before = sandbox.isolation
        sandbox.restart()
        with monkeypatch.context() as full:
            answer = json.dumps({"error": f"{type(told).__name__}: {told}"}).encode()
            full.setattr(supervisor.Zygote, "_header", lambda _: (len(answer).to_bytes(4, "little"), []))
            full.setattr(supervisor.Zygote, "_exactly", lambda _, size: answer[:size])
            with pytest.raises(NoRoomError):
                sandbox.open(Limits())
        assert run(sandbox, "print(1)")[1].end is RunEnd.FINISHED
        assert sandbox.isolation == before


def test_the_zygote_is_recycled(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("grader.sandbox._RUNS_PER_ZYGOTE", 3)
    with make() as sandbox:
        processes = set()
        for _ in range(7):
            assert run(sandbox, "pass")[1].end is RunEnd.FINISHED
            processes.add(zygote_of(sandbox).pid)
    assert 2 <= len(processes) <= 4


def test_numpy_and_yaml_are_importable_and_nothing_beside_them(sandbox: Sandbox) -> None:
    pytest.importorskip("numpy")
    source = (
        "import numpy, yaml; frame(yaml.dump({'a': int(numpy.arange(4).sum())}).encode()); import pydantic"
    )
    frames, report = run(sandbox, source)
    assert frames[0] == b"a: 6\n"
    assert "ModuleNotFoundError: No module named 'pydantic'" in report.stderr.text


def test_byte_code_of_the_shim_is_kept_for_the_next_zygote(tmp_path: Path) -> None:
    (tmp_path / "bare_runner.py").write_bytes((RUNNER / "bare_runner.py").read_bytes())
    with Sandbox(shim_path=tmp_path, entry="bare_runner:run") as sandbox:
        assert run(sandbox, "pass")[1].end is RunEnd.FINISHED
    assert list(tmp_path.glob("__pycache__/bare_runner.*.pyc"))


# ------------------------------------------------------------------------------ nothing runs unconfined
