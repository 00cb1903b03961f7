"""How the grading process is started: what it may import, and from where."""

import os
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from grader.contracts.assignment import Limits
from grader.contracts.grading import GradingJob
from grader.grading import launch
from grader.grading.slot import Slot, SlotConfig
from tests.fakes.processes import process_of
from tests.unit.grading.test_slot import ASSIGNMENT, CHILD, JOB


def test_a_process_started_ahead_is_the_first_to_be_used(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(launch, "_BOOTSTRAP", f"import sys; del sys.argv[1]\n{CHILD}\nserve()")
    launch.launch_ahead()
    ahead = launch._ahead[0]
    with Slot(SlotConfig()) as one:
        assert one.grade(JOB).report.score == 1.0
        assert process_of(one)._pid == ahead.pid
    assert not launch._ahead


def test_a_shadowing_module_in_the_working_folder_is_not_imported(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "random.py").write_text("raise SystemExit(9)")
    (tmp_path / "numpy.py").write_text("raise SystemExit(9)")
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("PYTHONPATH", raising=False)
    short = replace(ASSIGNMENT, horizon_s=1.0, limits=Limits(wall_s=30.0))
    job = GradingJob(file_name="a.py", source=b"", assignment=short)
    with Slot(SlotConfig(mode="dev")) as one:
        assert one.grade(job).report.assignment == "demo"


def test_the_first_entry_of_the_path_is_not_handed_on(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """`python -m grader` puts the working folder there, where a student's random.py may lie."""
    before = launch.import_path()
    monkeypatch.setattr(sys, "path", [str(tmp_path), *before.split(os.pathsep)])
    assert launch.import_path() == before
