"""The sandbox as the episode uses it."""

import os
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from grader.contracts.errors import SandboxError, SandboxUnavailableError
from grader.contracts.limits import MIB, Limits
from grader.jail import landlock, policy
from grader.jail.report import JailReport
from grader.sandbox import Layer, Mode, Sandbox, Verdict

pytestmark = pytest.mark.skipif(landlock.abi_version() == 0, reason="this kernel has no Landlock")

RUNNER = Path(__file__).parents[2] / "hostile" / "runner"
ECHO = b"""
import os
while True:
    size = int.from_bytes(os.read(channel, 4), "little")
    body = b""
    while len(body) < size:
        body += os.read(channel, size - len(body))
    frame(body[:60000])
"""


def make(mode: Mode = Mode.STRICT, *without: Layer, entry: str = "bare_runner:run", **more: bool) -> Sandbox:
    return Sandbox(mode, RUNNER, entry=entry, without=frozenset(without), **more)


@pytest.fixture(scope="module")
def sandbox() -> Iterator[Sandbox]:
    with make() as made:
        yield made


def run(sandbox: Sandbox, source: str | bytes, **limits: float) -> tuple[list[bytes], JailReport]:
    with sandbox.open(Limits(**limits)) as jail:  # type: ignore[arg-type]
        jail.send(source if isinstance(source, bytes) else source.encode())
        frames = []
        while (frame := jail.receive()) is not None:
            frames.append(frame)
        return frames, jail.close()


def test_frames_output_and_exit_code(sandbox: Sandbox) -> None:
    source = "import sys\nframe(b'one')\nprint('out')\nprint('err', file=sys.stderr)\nsys.exit(3)"
    frames, report = run(sandbox, source)
    assert frames == [b"one", b"end"]
    assert (report.verdict, report.exit_code, report.signal, report.detail) == (Verdict.FINISHED, 3, None, "")
    assert (report.stdout.text, report.stderr.text) == ("out\n", "err\n")
    assert report.cpu_ns > 0
    assert report.peak_bytes > MIB


def test_frames_before_a_limit_are_still_delivered(sandbox: Sandbox) -> None:
    frames, report = run(sandbox, "for n in range(9): frame(b'%d' % n)\nwhile True: pass", cpu_s=0.2)
    assert frames == [b"%d" % n for n in range(9)]
    assert report.verdict is Verdict.CPU_LIMIT
    assert "0.2 s" in report.detail


def test_frames_in_the_channel_outlive_the_process(sandbox: Sandbox) -> None:
    """What was sent before the kill is delivered although nobody had read it by then."""
    with sandbox.open(Limits(cpu_s=0.2)) as jail:
        jail.send(b"frame(b'begun')\nfor n in range(20): frame(b'x' * 5000)\nwhile True: pass")
        assert jail.receive() == b"begun"
        while jail._verdict is None:
            jail._tend(0)
        frames = list(iter(jail.receive, None))
        report = jail.close()
    assert frames == [b"x" * 5000] * 20
    assert report.verdict is Verdict.CPU_LIMIT


@pytest.mark.parametrize(
    ("source", "verdict", "settled"),
    [
        ("print('a')", Verdict.FINISHED, True),
        ("print('a')\nwhile True: pass", Verdict.CPU_LIMIT, True),
        ("n = 0\nwhile True:\n    n += 1\n    if n % 10000 == 0: print(n)", Verdict.CPU_LIMIT, False),
        ("while True: print('a' * 99)", Verdict.OUTPUT_LIMIT, True),
        ("import sys\nwhile True: print('a'); print('b', file=sys.stderr)", Verdict.OUTPUT_LIMIT, False),
        ("import os\nos.write(channel, bytes(4))\nwhile True: print('a')", Verdict.PROTOCOL, False),
    ],
)
def test_it_is_told_whether_output_depends_on_the_moment_of_a_kill(
    sandbox: Sandbox, source: str, verdict: Verdict, settled: bool
) -> None:
    _, report = run(sandbox, source, cpu_s=0.4, output_bytes=200_000)
    assert (report.verdict, report.settled) == (verdict, settled)


def test_c_code_that_dies_for_lack_of_memory_met_the_memory_limit(sandbox: Sandbox) -> None:
    hoard = "import os\nkept = []\ntry:\n    while True: kept.append(bytearray(1 << 20))\n"
    _, report = run(sandbox, hoard + "except MemoryError: os.abort()", memory_bytes=96 * MIB)
    assert (report.verdict, report.signal) == (Verdict.MEMORY_LIMIT, "SIGABRT")
    _, report = run(sandbox, "import os\nos.abort()", memory_bytes=96 * MIB)
    assert (report.verdict, report.signal) == (Verdict.CRASHED, "SIGABRT")


def test_last_words_of_a_killed_script_are_kept(sandbox: Sandbox) -> None:
    _, report = run(sandbox, "print('last words')\nwhile True: pass", cpu_s=0.2)
    assert report.stdout.text == "last words\n"


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
        assert jail.close().verdict is Verdict.CPU_LIMIT


def test_sending_to_a_script_that_only_sends_ends(sandbox: Sandbox) -> None:
    with sandbox.open(Limits(cpu_s=2.0)) as jail:
        jail.send(b"while True: frame(b'x' * 60000)")
        jail.send(b"y" * (8 * MIB))
        while jail.receive() is not None:
            pass
        assert jail.close().verdict is Verdict.PROTOCOL


def test_sending_after_the_end_is_harmless(sandbox: Sandbox) -> None:
    with sandbox.open(Limits()) as jail:
        jail.send(b"import os; os._exit(0)")
        assert jail.receive() is None
        jail.send(b"too late")
        assert jail.receive() is None


def test_grace_after_the_horizon(sandbox: Sandbox) -> None:
    with sandbox.open(Limits(cpu_s=60.0)) as jail:
        jail.send(b"frame(b'horizon')\nwhile True: pass")
        assert jail.receive() == b"horizon"
        jail.limit_cpu(0.1)
        assert jail.receive() is None
        report = jail.close()
    assert report.verdict is Verdict.CPU_LIMIT
    assert report.cpu_ns < 2_000_000_000


def test_closing_early_ends_the_process_without_blame(sandbox: Sandbox) -> None:
    with sandbox.open(Limits()) as jail:
        jail.send(b"while True: pass")
        report = jail.close()
        assert jail.close() is report
    assert (report.verdict, report.exit_code, report.signal) == (Verdict.FINISHED, None, None)


def test_the_wall_limit_blames_the_host(sandbox: Sandbox) -> None:
    with sandbox.open(Limits(wall_s=0.0)) as jail:
        jail.send(b"while True: pass")
        assert jail.receive() is None
        assert jail.close().verdict is Verdict.INFRASTRUCTURE


def test_a_kill_from_outside_blames_the_host(sandbox: Sandbox) -> None:
    with sandbox.open(Limits()) as jail:
        jail.send(b"while True: pass")
        jail._process.kill()
        assert jail.receive() is None
        assert jail.close().verdict is Verdict.INFRASTRUCTURE


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
        jail._process.kill()
        assert jail.receive() is None
        assert jail.close().verdict is Verdict.MEMORY_LIMIT


def test_a_script_that_sleeps_for_ever_is_stalled(sandbox: Sandbox, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(policy, "IDLE_LIMIT_NS", 100_000_000)
    _, report = run(sandbox, "import os\nos.read(os.pipe()[0], 1)")
    assert report.verdict is Verdict.STALLED


def test_a_slow_episode_does_not_make_a_script_stalled(
    sandbox: Sandbox, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(policy, "IDLE_LIMIT_NS", 50_000_000)
    with sandbox.open(Limits()) as jail:
        jail.send(ECHO)
        for _ in range(3):
            time.sleep(0.1)
            jail.send(b"x")
            assert jail.receive() == b"x"


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
        source = "import os; os.abort()" if n % 5 == 0 else "print(object(), [i for i in {'p', 'q', 'r'}])"
        texts.add(run(sandbox, source)[1].stdout.text)
    assert len(os.listdir("/proc/self/fd")) == before
    assert len(texts - {""}) == 1


def test_the_zygote_is_replaced_when_it_dies() -> None:
    with make() as sandbox:
        run(sandbox, "pass")
        sandbox._zygote._process.kill()
        sandbox._zygote._process.wait()
        assert run(sandbox, "frame(b'again')")[0] == [b"again", b"end"]


def test_a_dying_zygote_takes_its_runs_along_and_blames_nobody() -> None:
    with make() as sandbox:
        jail = sandbox.open(Limits(cpu_s=30.0))
        jail.send(b"while True: pass")
        sandbox._zygote._process.kill()
        assert jail.receive() is None
        with pytest.raises(SandboxError):
            jail.close()


ABANDONED = """
import sys
from pathlib import Path
from grader.contracts.limits import Limits
from grader.sandbox import Sandbox

sandbox = Sandbox(shim_path=Path(sys.argv[1]), entry="bare_runner:run", namespaces=sys.argv[2] == "1")
jail = sandbox.open(Limits(cpu_s=300.0))
jail.send(b"while True: pass")
print(sandbox._zygote._process.pid, jail._process.pid, flush=True)
sys.stdin.read()
"""


@pytest.mark.parametrize("namespaces", ["0", "1"])
def test_killing_the_grading_process_ends_everything(namespaces: str) -> None:
    command = [sys.executable, "-c", ABANDONED, str(RUNNER), namespaces]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as grading:
        assert grading.stdout
        pids = grading.stdout.readline().split()
        assert len(pids) == 2
        assert all(is_alive(pid) for pid in pids)
        grading.kill()
    for _ in range(1000):
        if not any(is_alive(pid) for pid in pids):
            return
        time.sleep(0.01)
    pytest.fail("a process outlived the grading process")


def is_alive(pid: str) -> bool:
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


def test_the_zygote_is_recycled(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("grader.jail.box._RUNS_PER_ZYGOTE", 3)
    with make() as sandbox:
        processes = set()
        for _ in range(7):
            assert run(sandbox, "pass")[1].verdict is Verdict.FINISHED
            processes.add(sandbox._zygote._process.pid)
    assert 2 <= len(processes) <= 4


def test_numpy_is_importable_and_nothing_beside_it(sandbox: Sandbox) -> None:
    pytest.importorskip("numpy")
    frames, report = run(sandbox, "import numpy; frame(str(numpy.arange(4).sum()).encode()); import pydantic")
    assert frames[0] == b"6"
    assert "ModuleNotFoundError: No module named 'pydantic'" in report.stderr.text


# ------------------------------------------------------------------------------ nothing runs unconfined


def test_the_layers_hold(sandbox: Sandbox) -> None:
    proof = sandbox.prove()
    assert proof.breaches == ()
    assert proof.descriptors == (0, 1, 2, 3)
    assert set(proof.environment) <= {*policy.ENVIRONMENT, "LC_CTYPE"}


@pytest.mark.parametrize("namespaces", [True, False])
def test_a_confined_process_has_no_rights_of_its_own(namespaces: bool) -> None:
    """As the kernel tells it, from outside: user, groups, capabilities, session, signals and filters."""
    with make(namespaces=namespaces) as sandbox, sandbox.open(Limits()) as jail:
        pid = jail._process.pid
        status = dict(line.split(":\t", 1) for line in Path(f"/proc/{pid}/status").read_text().splitlines())
        session = os.getsid(pid)
        owner = os.stat(f"/proc/{pid}/environ").st_uid
        zygote_session = os.getsid(sandbox._zygote._process.pid)
        expected = sandbox._config.box_uid if os.geteuid() == 0 else os.geteuid()
        keep_read = sandbox._config.keep_read and "namespaces" in sandbox.missing_layers
        unprivileged = "own_uid" not in sandbox.missing_layers
    assert status["Uid"].split() == [str(expected)] * 4
    if unprivileged:
        assert status["Gid"].split() == [str(expected)] * 4
        assert status["Groups"].split() == []
    dac_read_search = 1 << 2
    assert int(status["CapEff"], 16) == int(status["CapPrm"], 16) == (dac_read_search if keep_read else 0)
    assert (int(status["CapInh"], 16), int(status["CapAmb"], 16)) == (0, 0)
    assert (status["NoNewPrivs"], status["Seccomp"], status["Umask"]) == ("1", "2", "0077")
    assert session not in (zygote_session, os.getsid(0))
    assert owner == 0  # not dumpable: its like cannot look into it


GROUPED = """
import os, sys
from pathlib import Path
from grader.contracts.limits import Limits
from grader.sandbox import Sandbox

os.setgroups([4, 27, 4242])
with Sandbox(shim_path=Path(sys.argv[1]), entry="bare_runner:run") as sandbox, sandbox.open(Limits()) as jail:
    print(Path(f"/proc/{jail._process.pid}/status").read_text())
"""


@pytest.mark.skipif(os.geteuid() != 0, reason="only root has groups to give up")
def test_the_graders_groups_are_given_up() -> None:
    done = subprocess.run(
        [sys.executable, "-c", GROUPED, str(RUNNER)], capture_output=True, text=True, check=True
    )
    status = dict(line.split(":\t", 1) for line in done.stdout.splitlines() if ":\t" in line)
    assert status["Groups"].split() == []


@pytest.mark.parametrize("layer", [Layer.LANDLOCK, Layer.SECCOMP])
def test_leaving_out_a_required_layer_is_noticed_from_inside(layer: Layer) -> None:
    with make(Mode.BEST_EFFORT, layer, Layer.NAMESPACES) as sandbox:
        breaches = sandbox.prove().breaches
        assert layer.value in sandbox.missing_layers
    assert any(breach.startswith(f"{layer}: ") for breach in breaches)


@pytest.mark.parametrize("layer", [Layer.LANDLOCK, Layer.SECCOMP])
def test_strict_refuses_to_start_without_a_required_layer(layer: Layer) -> None:
    with pytest.raises(SandboxUnavailableError, match=layer.value):
        make(Mode.STRICT, layer)


@pytest.mark.skipif(os.geteuid() != 0, reason="only root can give away its user id")
def test_root_never_runs_a_script_as_root() -> None:
    with make() as sandbox:
        assert sandbox.prove().uid >= 60_000
    with pytest.raises(SandboxUnavailableError, match="own_uid"):
        make(Mode.STRICT, Layer.OWN_UID)


def test_strict_does_not_believe_a_layer_that_does_not_hold() -> None:
    with make() as sandbox:
        sandbox._config = replace(sandbox._config, landlock=False, namespaces=False)
        sandbox.restart()
        with pytest.raises(SandboxUnavailableError, match="read /etc/passwd"):
            sandbox.open(Limits())


def test_a_failing_step_of_confinement_runs_nothing(tmp_path: Path) -> None:
    machine = os.uname().machine
    placeholder = policy.OWN_PID.to_bytes(4, "little")
    (tmp_path / f"{machine}.bpf").write_bytes(b"\xff\xff\xff\xff" + placeholder)
    with make() as sandbox:
        sandbox._config = replace(sandbox._config, filters=str(tmp_path))
        sandbox._proven = True
        sandbox.restart()
        with pytest.raises(SandboxError, match=r"could not be confined.*seccomp"):
            sandbox.open(Limits())


def test_a_host_that_allows_only_half_of_the_namespaces_is_used_without_them() -> None:
    with make() as sandbox:
        sandbox._config = replace(sandbox._config, shown=["/no/such/directory"])
        sandbox.restart()
        assert "namespaces" in sandbox.missing_layers
        assert run(sandbox, "frame(b'x')")[0] == [b"x", b"end"]


def test_an_entry_that_cannot_be_imported_is_reported() -> None:
    with make(entry="no_such_module:run") as sandbox, pytest.raises(SandboxError, match="no_such_module"):
        sandbox.open(Limits())


def test_dev_mode_runs_and_says_what_is_missing() -> None:
    with make(Mode.DEV) as sandbox:
        assert sandbox.isolation == "dev: process+rlimits"
        assert {"landlock", "seccomp"} <= set(sandbox.missing_layers)
        assert run(sandbox, "frame(b'x')")[0] == [b"x", b"end"]
