"""Set up .venv from the lock file and run one of the project's commands in it.

Needs only Python 3.11 or later. Debian and Ubuntu split `venv` into a package of its own, and for Python 3.12 and
later PyBullet is offered as source only, which takes a compiler. What is missing is installed when we may install
packages, otherwise the message says what to type.
"""

from __future__ import annotations

import hashlib
import os
import shutil
import subprocess
import sys
import sysconfig
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
VENV = ROOT / ".venv"
PYTHON = VENV / "bin" / "python"
_PACKAGE = f"python{sys.version_info.major}.{sys.version_info.minor}"
STAMP = VENV / ".lock-digest"
LOCKS = (ROOT / "requirements-extras.lock", ROOT / "requirements-dev.lock")
SHIM = ROOT / "grader" / "shim"

# a module's tests share its servers; the modules that take longest come first by name
_PYTEST = ("-m", "pytest", "-n", "auto", "--dist", "loadfile", "--no-loadscope-reorder")

COMMANDS: dict[str, list[list[str]]] = {
    "setup": [["-m", "compileall", "-q", "grader"]],  # whoever runs it may not be allowed to write here
    "demo": [["-m", "grader", "demo"]],
    "test": [[*_PYTEST, "-m", "not slow"]],
    "test-all": [[*_PYTEST, "--hypothesis-profile", "all"]],
    "image-test": [["-m", "tools.image", "test"]],
    "check": [
        ["-m", "ruff", "format", "--check", "."],
        ["-m", "ruff", "check", "."],
        ["-m", "mypy"],
        ["tools/lint_layers.py"],
    ],
    "bench": [["-m", "benchmarks.bench"], ["-m", "benchmarks.startup"], ["-m", "benchmarks.styles"]],
    "load": [["-m", "benchmarks.load"]],
    "capacity": [["-m", "benchmarks.capacity"]],
    "messages": [["-m", "grader.messages.check"]],
    "interfaces": [["tools/generate_interfaces.py"]],
}


def main() -> int:
    """Run the command named on the command line; return its exit code."""
    if sys.version_info < (3, 11):
        return _fail(
            f"Python 3.11 or later is needed; this is {sys.version.split()[0]}. On Ubuntu 22.04: sudo apt install "
            "python3.11 python3.11-venv, then make demo PYTHON=python3.11"
        )
    name = sys.argv[1] if len(sys.argv) > 1 else ""
    if name not in COMMANDS:
        return _fail(f"Say one of: {', '.join(COMMANDS)}.")
    try:
        _set_up()
    except subprocess.CalledProcessError as error:
        return _fail(f"Set-up failed: {' '.join(map(str, error.cmd))} ended with {error.returncode}.")
    for command in COMMANDS[name]:
        code = subprocess.call([PYTHON, *command, *sys.argv[2:]], cwd=ROOT)
        if code:
            return code
    return 0


def _set_up() -> None:
    digest = hashlib.sha256(b"".join(lock.read_bytes() for lock in LOCKS)).hexdigest() + f" {sys.version}"
    if STAMP.exists() and STAMP.read_text() == digest:
        return
    if VENV.exists():
        shutil.rmtree(VENV)
    _say(f"Setting up {VENV.name} (once) ...")
    _create_venv()
    pip = [str(PYTHON), "-m", "pip", "--disable-pip-version-check", "--no-input", "install", "--quiet"]
    locks = [part for lock in LOCKS for part in ("-r", str(lock))]
    subprocess.check_call([*pip, "--no-deps", "--require-hashes", *locks])  # they name all that is needed
    subprocess.check_call([*pip, "--no-deps", "--no-build-isolation", "--editable", str(ROOT)])
    STAMP.write_text(digest)


def _create_venv() -> None:
    try:
        import ensurepip  # noqa: F401  (only asks whether this Python can make a venv with pip)
        import venv  # noqa: F401
    except ImportError:
        _install(f"{_PACKAGE}-venv")
    if sys.version_info >= (3, 12):
        header = Path(sysconfig.get_path("include"), "Python.h")
        missing = {"g++": shutil.which("g++"), f"{_PACKAGE}-dev": header.exists()}
        if packages := [package for package, there in missing.items() if not there]:
            _install(*packages)
        _say("PyBullet is compiled for this Python, which takes some minutes ...")
    subprocess.check_call([sys.executable, "-m", "venv", VENV])


def _install(*packages: str) -> None:
    """Install packages of Debian or Ubuntu, or say that they are needed."""
    needed = " ".join(packages)
    sudo = [] if os.geteuid() == 0 else ["sudo"]
    if not shutil.which("apt-get") or (sudo and not shutil.which("sudo")):
        raise SystemExit(f"bootstrap: install {needed} and try again.")
    _say(f"Installing {needed} ...")
    subprocess.check_call([*sudo, "apt-get", "update", "-qq"])
    subprocess.check_call([*sudo, "apt-get", "install", "-y", "-qq", "--no-install-recommends", *packages])


def _say(text: str) -> None:
    print(f"bootstrap: {text}", file=sys.stderr, flush=True)


def _fail(text: str) -> int:
    _say(text)
    return 2


if __name__ == "__main__":
    sys.exit(main())
