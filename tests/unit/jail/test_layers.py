"""What keeps a script in: each layer holds, is proven before use, and is missed when it is not there."""

import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from grader.contracts.assignment import Limits
from grader.contracts.errors import SandboxError, SandboxUnavailableError
from grader.jail import bounds, landlock, syscalls
from grader.sandbox import Layer, Mode, RunEnd, Sandbox
from tests.fakes.processes import process_of, zygote_of
from tests.unit.jail.running import RUNNER, make, run

pytestmark = pytest.mark.skipif(landlock.abi_version() == 0, reason="this kernel has no Landlock")


def test_the_layers_hold(sandbox: Sandbox) -> None:
    proof = sandbox.prove()
    assert proof.breaches == ()
    assert proof.descriptors == (0, 1, 2, 3)
    assert set(proof.environment) <= {*bounds.ENVIRONMENT, "LC_CTYPE"}


@pytest.mark.parametrize("without", [(), (Layer.NAMESPACES,)], ids=["namespaces", "docker"])
def test_a_confined_process_has_no_rights_of_its_own(without: tuple[Layer, ...]) -> None:
    """As the kernel tells it, from outside: user, groups, capabilities, session, signals and filters."""
    with make(Mode.STRICT, *without) as sandbox, sandbox.open(Limits()) as jail:
        pid = process_of(jail).pid
        status = dict(line.split(":\t", 1) for line in Path(f"/proc/{pid}/status").read_text().splitlines())
        session, group = os.getsid(pid), os.getpgid(pid)
        owner = os.stat(f"/proc/{pid}/environ").st_uid
        zygote = zygote_of(sandbox).pid
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
    assert (session, group) == (
        zygote,
        pid,
    )  # no terminal of ours, no signal for others; priority as the zygote's
    assert owner == 0  # not dumpable: its like cannot look into it


GROUPED = """
import os, sys
from pathlib import Path
from grader.contracts.assignment import Limits
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
    placeholder = syscalls.OWN_PID.to_bytes(4, "little")
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


def test_an_operators_strict_umask_takes_nothing_from_scripts() -> None:
    before = os.umask(0o077)
    try:
        with make() as sandbox:
            _, report = run(sandbox, "import mmap, random\nprint(len(open(random.__file__).read()) > 0)")
    finally:
        os.umask(before)
    assert (report.end, report.stdout.text) == (RunEnd.FINISHED, "True\n"), report.stderr.text
