"""The units of `deploy/`: systemd takes them, and they leave processes few rights."""

import shutil
import subprocess
import sys
from configparser import ConfigParser
from pathlib import Path

import pytest

UNITS = Path(__file__).resolve().parents[2] / "deploy"
SERVICES = ("grader.service", "grader-worker.service", "grader-backup.service")
pytestmark = pytest.mark.skipif(shutil.which("systemd-analyze") is None, reason="there is no systemd")


def analyzed(*arguments: str, folder: Path) -> subprocess.CompletedProcess[str]:
    command = ["systemd-analyze", *arguments]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """The units, with a program that is there."""
    for unit in [*UNITS.glob("*.service"), *UNITS.glob("*.timer")]:
        text = unit.read_text(encoding="utf-8").replace("/opt/grader/.venv/bin/grader", sys.executable)
        (tmp_path / unit.name).write_text(text, encoding="utf-8")
    return tmp_path


def test_systemd_takes_them(folder: Path) -> None:
    names = [f"./{one.name}" for one in sorted(folder.iterdir())]
    assert len(names) > len(SERVICES)
    done = analyzed("verify", *names, folder=folder)
    assert (done.returncode, [line for line in done.stderr.splitlines() if "/grader" in line]) == (0, [])


@pytest.mark.parametrize("name", SERVICES)
def test_they_leave_few_rights(folder: Path, name: str) -> None:
    """A unit of before had 9.2 of 10."""
    done = analyzed("security", "--offline=true", "--threshold=26", f"./{name}", folder=folder)
    assert done.returncode == 0, done.stdout[-300:]


@pytest.mark.parametrize("name", SERVICES[:2])
def test_they_are_begun_again_for_as_long_as_it_takes(name: str) -> None:
    unit = ConfigParser(strict=False, interpolation=None)
    unit.optionxform = str  # type: ignore[assignment,method-assign]
    unit.read(UNITS / name)
    assert unit["Unit"]["StartLimitIntervalSec"] == "0"
    assert (unit["Service"]["Restart"], unit["Service"]["RestartSec"]) == ("always", "5")
