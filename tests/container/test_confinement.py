"""What an ordinary container refuses, and that the sandbox inside it needs none of that."""

import json
import platform
import re
import sysconfig
from pathlib import Path

import pytest

from tests.container.running import good, python
from tools.image.runtime import MEMORY_BYTES, TASKS, UID, Runtime

ROOT = Path(__file__).resolve().parents[2]
SOURCE, PACKAGES = "/source", "/packages"


def test_an_ordinary_user_without_capabilities(runtime: Runtime) -> None:
    status = python(runtime, "-c", "print(open('/proc/self/status').read())")
    field = dict(line.split(":\t", 1) for line in status.splitlines() if ":\t" in line)
    assert field["Uid"].split() == field["Gid"].split() == [str(UID)] * 4
    assert {field[f"Cap{kind}"] for kind in ("Inh", "Prm", "Eff", "Bnd", "Amb")} == {"0" * 16}
    assert (field["NoNewPrivs"], field["Seccomp"], field["Groups"].strip()) == ("1", "2", "")


@pytest.mark.skipif(platform.machine() != "x86_64", reason="the script has the call numbers of x86_64")
def test_dockers_filter_read_only_root_and_masks_are_in_force(runtime: Runtime) -> None:
    answers = json.loads(python(runtime, "/scripts/refused_by_docker.py"))
    refused = dict.fromkeys(("unshare", "mount", "setns", "bpf", "keyctl", "perf_event_open"), "EPERM")
    assert answers["calls"] == {**refused, "clone3": "ENOSYS"}
    assert set(answers["writing"].values()) <= {"EROFS", "EACCES"}
    assert answers["masked"]
    assert set(answers["masked"].values()) == {""}


def test_doctor_is_ready_for_strict_mode(runtime: Runtime) -> None:
    print("\n" + good(runtime.run("doctor", "--lang", "en")))
    diagnosis = json.loads(good(runtime.run("doctor", "--json")))
    required = dict.fromkeys(("process", "rlimits", "seccomp", "landlock"), "active")
    assert {finding["layer"]: finding["state"] for finding in diagnosis["findings"]} == {
        **required,
        "own_uid": "not_needed",
        "namespaces": "absent",
    }
    assert (diagnosis["host"]["user"], diagnosis["host"]["container"]) == (str(UID), "yes")
    outer = diagnosis["outer"]
    if runtime.limited:
        assert (outer["memory_bytes"], outer["tasks"]) == (MEMORY_BYTES, TASKS)


def test_the_lessons_square_gets_full_marks(runtime: Runtime) -> None:
    command = ["grader", "check", "/lesson/square_mover.py", "--assignment", "square", "--lang", "en"]
    assert "100 / 100" in good(runtime.run_program(command, shown={"/lesson": ROOT / "lesson"}))


@pytest.mark.parametrize("name", ["pb_sphere", "panda_lift"])
def test_a_pybullet_script_gets_full_marks(runtime: Runtime, name: str) -> None:
    """With the models that the image keeps."""
    command = ["grader", "check", f"/set/{name}/solution.py", "--assignment", name, "--lang", "en"]
    assert "100 / 100" in good(
        runtime.run_program(command, shown={"/set": ROOT / "assignments" / "pybullet"})
    )


@pytest.mark.parametrize(
    "part", ["tests/hostile/test_hostile.py", "tests/hostile/episode", "tests/unit/jail"]
)
def test_the_sandboxs_own_tests_pass(runtime: Runtime, part: str) -> None:
    """By the image's Python, of the image's grader: only the test runner comes from outside."""
    shown = {
        f"{SOURCE}/tests": ROOT / "tests",
        f"{SOURCE}/pyproject.toml": ROOT / "pyproject.toml",
        PACKAGES: Path(sysconfig.get_path("purelib")),
    }
    runner = (
        "import os, sys; os.environ['PYTEST_DISABLE_PLUGIN_AUTOLOAD'] = '1'; "
        f"os.chdir('{SOURCE}'); sys.path.append('{PACKAGES}'); "
        "sys.modules['pyseccomp'] = None; "  # compiles filters by a library that the image has no use for
        "import pytest, grader; assert grader.__file__.startswith('/opt/grader/'); "
        f"sys.exit(pytest.main(['-q', '-p', 'no:cacheprovider', '{part}']))"
    )
    last = good(runtime.run_program(["python", "-c", runner], shown=shown)).splitlines()[-1]
    print(f"\n{part}, inside: {last}")
    assert re.match(r"\d+ passed", last)
