"""A process that is confined ahead of the run it is for."""

import os
import signal
from collections.abc import Iterator
from pathlib import Path

import pytest

from grader.contracts.assignment import Limits
from grader.jail import bounds, landlock
from grader.jail.ending import JailReport
from grader.sandbox import Sandbox
from tests.fakes.processes import process_of, spare_of, zygote_of

pytestmark = pytest.mark.skipif(landlock.abi_version() == 0, reason="this kernel has no Landlock")

RUNNER = Path(__file__).parents[2] / "hostile" / "runner"
LIMITS = Limits(cpu_s=5.0)


@pytest.fixture
def sandbox() -> Iterator[Sandbox]:
    with Sandbox(shim_path=RUNNER, entry="bare_runner:run") as made:
        yield made


def run(sandbox: Sandbox, source: str, limits: Limits = LIMITS) -> JailReport:
    with sandbox.open(limits) as jail:
        jail.send(source.encode())
        while jail.receive() is not None:
            pass
        return jail.close()


def waiting(sandbox: Sandbox) -> int:
    assert spare_of(sandbox) is not None
    return process_of(spare_of(sandbox)).pid


def exists(pid: int) -> bool:
    return Path(f"/proc/{pid}").exists()


def test_the_next_run_gets_the_process_that_waits(sandbox: Sandbox) -> None:
    sandbox.prepare(LIMITS)
    pid = waiting(sandbox)
    sandbox.prepare(LIMITS)
    assert waiting(sandbox) == pid
    with sandbox.open(LIMITS) as jail:
        assert process_of(jail).pid == pid
    assert spare_of(sandbox) is None
    assert not exists(pid)


def test_it_is_confined_before_it_waits(sandbox: Sandbox) -> None:
    sandbox.prepare(LIMITS)
    status = dict(
        line.split(":\t", 1) for line in Path(f"/proc/{waiting(sandbox)}/status").read_text().splitlines()
    )
    assert (status["Seccomp"], status["NoNewPrivs"]) == ("2", "1")
    if os.geteuid() == 0:  # nobody else may look into a process that is not dumpable
        assert sorted(os.listdir(f"/proc/{waiting(sandbox)}/fd")) == ["0", "1", "2", "3"]


def test_a_run_is_the_same_whether_it_was_prepared_or_not(sandbox: Sandbox) -> None:
    source = "import os, sys\nprint(os.getpid() > 0, object(), {'x', 'y'}, sys.modules.keys())"
    unprepared = run(sandbox, source).stdout
    for _ in range(3):
        sandbox.prepare(LIMITS)
        assert run(sandbox, source).stdout == unprepared
        assert run(sandbox, source).stdout == unprepared


def test_its_clocks_start_when_it_is_opened(sandbox: Sandbox, monkeypatch: pytest.MonkeyPatch) -> None:
    sandbox.prepare(LIMITS)
    monkeypatch.setattr("time.monotonic_ns", lambda: 10**18)  # decades later
    with sandbox.open(LIMITS) as jail:
        assert jail._clocks.wall_ns == 0
        assert jail._clocks.passed_limit() is None
        assert jail._clocks._cpu_deadline_ns > 5 * 10**9


def test_a_run_with_other_limits_gets_a_process_of_its_own(sandbox: Sandbox) -> None:
    sandbox.prepare(LIMITS)
    pid = waiting(sandbox)
    with sandbox.open(Limits(cpu_s=4.0)) as jail:
        assert not exists(pid)
        jail.send(b"import resource; print(resource.getrlimit(resource.RLIMIT_CPU)[0])")
        assert jail.receive() == b"end"
        assert jail.close().stdout.text == f"{4 * bounds.CPU_BACKSTOP}\n"


def test_none_waits_while_a_script_runs(sandbox: Sandbox) -> None:
    with sandbox.open(LIMITS):
        sandbox.prepare(LIMITS)
        assert spare_of(sandbox) is None
    sandbox.prepare(LIMITS)
    assert waiting(sandbox)


def test_one_that_has_ended_meanwhile_is_replaced(sandbox: Sandbox) -> None:
    sandbox.prepare(LIMITS)
    os.kill(waiting(sandbox), signal.SIGKILL)
    while spare_of(sandbox) is not None and spare_of(sandbox).waits():
        pass
    assert run(sandbox, "print('again')").stdout.text == "again\n"


def test_closing_the_sandbox_ends_it(sandbox: Sandbox) -> None:
    sandbox.prepare(LIMITS)
    pid = waiting(sandbox)
    before = len(os.listdir("/proc/self/fd"))
    sandbox.close()
    assert not exists(pid)
    assert len(os.listdir("/proc/self/fd")) < before


def test_a_zygote_that_dies_takes_it_along(sandbox: Sandbox) -> None:
    sandbox.prepare(LIMITS)
    zygote_of(sandbox).kill()
    zygote_of(sandbox).wait()
    while spare_of(sandbox) is not None and spare_of(sandbox).waits():
        pass
    assert run(sandbox, "print('again')").stdout.text == "again\n"
