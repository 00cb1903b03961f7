"""Every hostile script in every mode this machine offers: root or not, with namespaces or as in Docker."""

import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import msgspec
import pytest

from grader.jail import landlock, layers

HERE = Path(__file__).resolve().parent
SCRIPTS = sorted(path for path in (HERE / "scripts").iterdir() if path.suffix in (".py", ".script"))
ORDINARY_UID = 54_321
INTERPRETERS = ("/usr/bin/python3", "/usr/local/bin/python3")

REFUSED_BY_DOCKER = [
    "unshare",
    "setns",
    "mount",
    "umount2",
    "pivot_root",
    "mount_setattr",
    "move_mount",
    "fsopen",
    "open_tree",
    "keyctl",
    "add_key",
    "request_key",
    "bpf",
    "perf_event_open",
    "userfaultfd",
    "io_uring_setup",
    "pidfd_getfd",
    "syslog",
    "kexec_load",
    "reboot",
    "swapon",
    "quotactl",
]

pytestmark = pytest.mark.skipif(landlock.abi_version() == 0, reason="this kernel has no Landlock")


def expectation(script: Path) -> tuple[str, ...]:
    """The verdicts that a script's docstring allows."""
    match = re.search(r"^Expected: (.+)$", script.read_text(errors="replace"), re.MULTILINE)
    assert match, f"{script.name} does not say what is expected"
    return tuple(match[1].split(" or "))


def test_every_script_states_attack_and_verdict() -> None:
    for script in SCRIPTS:
        assert expectation(script)
        assert "Attack: " in script.read_text(errors="replace"), script.name


def interpreter_for(uid: int | None) -> str:
    """An interpreter that the user may start, of this version: msgspec is compiled for it."""
    if uid is None:
        return sys.executable
    own = os.path.realpath(sys.executable)  # a link to it may lie where the user may not look
    if layers.reachable_by_others([own]):
        return own
    for path in INTERPRETERS:
        check = [path, "-c", f"import sys, ctypes; sys.exit(sys.version_info[:2] != {sys.version_info[:2]})"]
        if os.path.exists(path) and subprocess.run(check, check=False).returncode == 0:
            return path
    pytest.skip("no Python of this version that another user could start")


def docker_like_filter(path: Path) -> None:
    """Write what Docker's default profile refuses: namespaces, mounts, keys and other kernel interfaces."""
    seccomp = pytest.importorskip("pyseccomp")
    program = seccomp.SyscallFilter(seccomp.ALLOW)
    refused = seccomp.ERRNO(1)
    for bit in (7, 17, 25, 26, 27, 28, 29, 30):
        program.add_rule(refused, "clone", seccomp.Arg(0, seccomp.MASKED_EQ, 1 << bit, 1 << bit))
    program.add_rule(refused, "personality", seccomp.Arg(0, seccomp.EQ, 0x40000))
    program.add_rule(seccomp.ERRNO(38), "clone3")
    for name in REFUSED_BY_DOCKER:
        program.add_rule(refused, name)
    with path.open("wb") as file:
        program.export_bpf(file)


def reachable_folder(uid: int | None, open_path: Path) -> Path:
    """The driver's folder, or a copy of it beside the grader, where the user can enter."""
    if uid is None or layers.reachable_by_others([str(HERE / "driver.py")]):
        return HERE
    ignored = shutil.ignore_patterns("__pycache__")
    shutil.copytree(HERE.parents[1] / "grader", open_path / "grader", ignore=ignored)
    copied = shutil.copytree(HERE, open_path / "tests" / "hostile", ignore=ignored)
    for path in open_path.rglob("*"):
        path.chmod(0o755 if path.is_dir() else 0o644)
    return copied


def drive(
    here: Path, uid: int | None, filter_path: Path | None, *without: str, root: Path | None = None
) -> list[dict[str, object]]:
    """Run the driver; return its results, the first of which describes the sandbox."""
    options = {
        "uid": uid,
        "filter": filter_path and str(filter_path),
        "without": without,
        "root": root and str(root),
        "scripts": [str(here / "scripts" / script.name) for script in SCRIPTS],
    }
    with tempfile.TemporaryDirectory() as packages:
        # All that the sandbox needs beyond the standard library. With more, scripts could read more.
        Path(packages, "msgspec").symlink_to(Path(msgspec.__file__).parent)
        done = subprocess.run(
            [interpreter_for(uid), str(here / "driver.py"), json.dumps(options)],
            capture_output=True,
            text=True,
            check=False,
            cwd="/",
            env=os.environ | {"PYTHONPATH": packages},
        )
    assert done.returncode == 0, done.stderr
    return [json.loads(line) for line in done.stdout.splitlines()]


def problems(result: dict, good: list) -> list[str]:
    """What is wrong with the outcome of one script."""
    script = Path(result["script"])
    expected = expectation(script)
    got = " ".join(filter(None, (result["end"], result["signal"])))
    if result["frames"][-2:-1] and bytes.fromhex(result["frames"][-2]).startswith(b"raised"):
        got = "raised"
    found = []
    if got not in expected:
        found.append(
            f"{got} instead of {' or '.join(expected)}: {result['detail']} {result['stderr'][-400:]}"
        )
    if "BREACH" in result["stdout"]:
        found.append(str([line for line in result["stdout"].splitlines() if "BREACH" in line]))
    if got == "finished" and "held" not in result["stdout"]:
        found.append("it did not come to its attack")
    if result["left_behind"]:
        found.append(f"left behind {result['left_behind']}")
    if result["good_again"] != good:
        found.append(f"the next run differed: {result['good_again']}")
    if result["output_bytes"] > 4 * 64 * 1024 + 200:
        found.append(f"{result['output_bytes']} bytes of output kept")
    return [f"{script.name}: {text}" for text in found]


@pytest.mark.parametrize(
    ("user", "namespaces"),
    [
        pytest.param("root", True, id="root-namespaces"),
        pytest.param("root", False, id="root-docker", marks=pytest.mark.slow),
        pytest.param("ordinary", True, id="ordinary-namespaces", marks=pytest.mark.slow),
        pytest.param("ordinary", False, id="ordinary-docker"),
    ],
)
def test_every_attack_is_held(user: str, namespaces: bool, open_path: Path) -> None:
    if user == "root" and os.geteuid() != 0:
        pytest.skip("not root")
    uid = ORDINARY_UID if user == "ordinary" and os.geteuid() == 0 else None
    here = reachable_folder(uid, open_path)
    filter_path = None
    if not namespaces:
        filter_path = open_path / "docker.bpf"
        docker_like_filter(filter_path)
        filter_path.chmod(0o644)
    sandbox, *results = drive(here, uid, filter_path, *(() if namespaces else ("namespaces",)))
    assert len(results) == len(SCRIPTS)
    assert str(sandbox["isolation"]).startswith("strict: process+rlimits+seccomp+landlock")
    assert ("namespaces" in str(sandbox["isolation"])) <= namespaces
    assert [problem for result in results for problem in problems(result, sandbox["good"])] == []


@pytest.mark.slow
@pytest.mark.skipif(os.geteuid() != 0, reason="only root can change the root directory")
def test_every_attack_is_held_by_a_prepared_root_in_place_of_landlock(open_path: Path) -> None:
    """As in a container that is root's, with an engine or a kernel that refuses Landlock."""
    filter_path = open_path / "docker.bpf"
    docker_like_filter(filter_path)
    sandbox, *results = drive(HERE, None, filter_path, "landlock", root=open_path / "jail-root")
    assert len(results) == len(SCRIPTS)
    assert sandbox["isolation"] == "strict: process+rlimits+seccomp+own_uid+own_root"
    assert [problem for result in results for problem in problems(result, sandbox["good"])] == []
