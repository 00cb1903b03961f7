"""Packages graded by the real sandbox: what ros2 run would start drives, and fails as it does at home."""

from dataclasses import replace
from pathlib import Path

import pytest

from grader.contracts.assignment import Assignment, WantedPackage
from grader.contracts.grading import GradingJob
from grader.contracts.report import GradeReport
from grader.grading.slot import Slot
from grader.packages.bundle import bundled
from tests.e2e.grading_slot import catalog
from tests.fakes.packages import DRIVE, HELPER, NAME, package_files, zipped

MODULE = f"{NAME}/drive.py"
ALONE = HELPER + DRIVE.format(name=NAME).replace(f"from {NAME}.helper import forward\n", "") + "\n\nmain()\n"


def assignment(wanted: WantedPackage | None = None) -> Assignment:
    return replace(catalog().get("straight"), input="package", package=wanted)


def graded(slot: Slot, files: dict[str, str], wanted: WantedPackage | None = None) -> GradeReport:
    job = GradingJob(file_name="p.zip", source=bundled(zipped(files)), assignment=assignment(wanted))
    return slot.grade(job).report


def test_a_package_drives_as_its_code_in_one_file(slot: Slot) -> None:
    script = GradingJob(file_name="a.py", source=ALONE.encode(), assignment=catalog().get("straight"))
    alone = slot.grade(script)
    package = graded(slot, package_files())
    assert package.score == alone.report.score == 100
    assert package.runs[0].trajectory_sha256 == alone.report.runs[0].trajectory_sha256
    assert package == graded(slot, package_files())


def test_an_error_names_the_file_it_is_in(slot: Slot) -> None:
    broken = HELPER.replace("msg.linear.x = speed", "msg.linear.xx = speed")
    report = graded(slot, package_files(**{f"{NAME}/helper.py": broken}))
    error = report.runs[0].outcome.error
    assert error is not None
    assert (error.file, error.line) == (f"{NAME}/{NAME}/helper.py", 6)
    assert f'File "{NAME}/{NAME}/drive.py", line 15, in tick' in error.traceback


PRINTS = """import os
import sys
from {name}.helper import forward
from ament_index_python.packages import PackageNotFoundError, get_package_share_directory

def main():
    print(__name__, __file__, sys.argv)
    share = get_package_share_directory('{name}')
    print(share, os.listdir(share), os.getcwd(), os.listdir('.'))
    print(open(os.path.join(share, 'config', 'a.yaml')).read().strip())
    print(open('src/{name}/config/a.yaml').read().strip())
    try:
        get_package_share_directory('nothing')
    except PackageNotFoundError as error:
        print(error)
    return 3
"""


def test_a_module_finds_itself_and_its_files_where_colcon_installs_them(slot: Slot) -> None:
    files = package_files(**{MODULE: PRINTS.format(name=NAME), "config/a.yaml": "x: 1\n"})
    outcome = graded(slot, files).runs[0].outcome
    prefix = f"/home/student/ros2_ws/install/{NAME}"
    assert outcome.stdout.text.splitlines() == [
        f"{NAME}.drive {prefix}/lib/python3.10/site-packages/{NAME}/drive.py ['{prefix}/lib/{NAME}/drive']",
        f"{prefix}/share/{NAME} ['package.xml', 'config'] /home/student/ros2_ws ['src', 'install']",
        "x: 1",
        "x: 1",
        f"\"package 'nothing' not found, searching: ['{prefix}', '/opt/ros/humble']\"",
    ]
    assert outcome.exit_code == 3


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"setup.cfg": None}, "No executable found"),
        ({"setup.cfg": "[install]\ninstall-scripts=$base/lib/my_turtle\n"}, "No executable found"),
        ({f"{NAME}/__init__.py": None}, "ModuleNotFoundError: No module named 'my_turtle'"),
        ({MODULE: None}, "ModuleNotFoundError: No module named 'my_turtle.drive'"),
        ({MODULE: "def mian(): pass\n"}, "AttributeError: module 'my_turtle.drive' has no attribute 'main'"),
        ({MODULE: "def main(:\n"}, "SyntaxError: invalid syntax"),
        ({f"resource/{NAME}": None}, "No executable found"),
        ({"package.xml": "<package><name>my_turtle</name></package>"}, "No executable found"),
    ],
)
def test_a_broken_package_fails_as_ros2_run_does(
    slot: Slot, changed: dict[str, str | None], said: str
) -> None:
    report = graded(slot, package_files(**changed))
    outcome = report.runs[0].outcome
    assert said in outcome.stderr.text
    assert outcome.exit_code == 1
    assert report.score == 0


def test_setup_is_never_run(slot: Slot, tmp_path: Path) -> None:
    setup = package_files()[f"{NAME}/setup.py"]
    trap = tmp_path / "ran"
    evil = f"open({str(trap)!r}, 'w')\nimport os\nos._exit(1)\nwhile True: pass\n"
    assert graded(slot, package_files(**{"setup.py": evil + setup})).score == 100
    assert not trap.exists()
