"""Gradescope's, PrairieLearn's, Autolab's and Classroom 50's graders, as those platforms start them."""

import base64
import json
import re
import stat
import subprocess
import zipfile
from pathlib import Path
from typing import Any

import pytest

from grader.commands import check, cli, gradescope, prairielearn, regrade_folder
from grader.commands.handed_in import graded, read_file
from grader.contracts.errors import InfrastructureError
from grader.grading.slot import Slot
from grader.use_cases import pictures
from tests.fakes.grading import Lent
from tests.unit.commands.test_check import FailingSlot

LOCK = Path(__file__).parents[3] / "requirements.lock"
HELLO = (
    b"import rclpy\nfrom rclpy.node import Node\nrclpy.init()\nnode = Node('n')\n"
    b"node.get_logger().info('hello')\nrclpy.spin(node)\n"
)


@pytest.fixture
def no_grader(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let every grading fail by a fault of the grader."""
    FailingSlot.error = InfrastructureError("the grading process ended unexpectedly")
    for module in (gradescope, prairielearn, regrade_folder):
        monkeypatch.setattr(module, "Slot", FailingSlot)


@pytest.fixture
def lent(slot: Slot, monkeypatch: pytest.MonkeyPatch) -> None:
    """Let commands grade in the one process of all tests, instead of starting their own."""
    for module in (check, gradescope, prairielearn, regrade_folder):
        monkeypatch.setattr(module, "Slot", lambda config: Lent(slot))


def _container(root: Path, **files: bytes) -> Path:
    (root / "submission").mkdir()
    for name, content in files.items():
        (root / "submission" / f"{name}.py").write_bytes(content)
    return root


def _results(root: Path) -> dict[str, Any]:
    found: dict[str, Any] = json.loads((root / "results" / "results.json").read_bytes())
    return found


def _run_gradescope(root: Path) -> dict[str, Any]:
    assert cli.run(["gradescope", "run", "hello", "--root", str(root), "--lang", "en"]) == 0
    return _results(root)


def test_gradescope_gets_a_submission_graded(tmp_path: Path) -> None:
    document = _run_gradescope(_container(tmp_path, mine=HELLO))
    assert document["score"] == sum(test["max_score"] for test in document["tests"])


@pytest.mark.parametrize(
    ("files", "told"),
    [
        ({}, "no file that ends in .py"),
        ({"a": HELLO, "b": HELLO}, "2 files were handed in (a.py, b.py)"),
        ({"a": b""}, "empty"),
    ],
)
def test_gradescope_is_told_what_was_wrong_with_the_files(
    files: dict[str, bytes], told: str, tmp_path: Path
) -> None:
    document = _run_gradescope(_container(tmp_path, **files))
    assert document["score"] == 0.0
    assert told in document["output"]


@pytest.mark.usefixtures("lent")
def test_of_several_files_the_one_is_graded_whose_name_tells_the_assignment(tmp_path: Path) -> None:
    document = _run_gradescope(_container(tmp_path, hello_node=HELLO, notes=b"x = 1\n"))
    assert document["score"] > 0


@pytest.mark.usefixtures("no_grader")
def test_a_fault_of_the_grader_is_no_number_on_any_platform(tmp_path: Path) -> None:
    """Gradescope gets a document without a score, PrairieLearn none at all, the table an empty cell."""
    document = _run_gradescope(_container(tmp_path, mine=HELLO))
    assert "score" not in document
    assert [("score" in test, test["status"]) for test in document["tests"]] == [(False, "failed")]
    (tmp_path / "student").mkdir()
    (tmp_path / "student" / "mine.py").write_bytes(HELLO)
    (tmp_path / "results" / "results.json").unlink()
    assert cli.run(["prairielearn", "--root", str(tmp_path), "-a", "hello"]) == 2
    assert not (tmp_path / "results" / "results.json").exists()
    out = tmp_path / "scores.csv"
    assert cli.run(["regrade-folder", str(tmp_path / "student"), "-a", "hello", "-o", str(out)]) == 1
    assert ",infrastructure_error,," in out.read_text("utf-8")


def test_a_file_that_the_machine_does_not_read_is_no_zero(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    root, out = _container(tmp_path, mine=HELLO), tmp_path / "scores.csv"
    for module in (gradescope, regrade_folder):
        monkeypatch.setattr(module, "pick", lambda *_: read_file(Path("/nowhere/mine.py")))
    assert "score" not in _run_gradescope(root)
    for student in ("li", "han"):
        (tmp_path / "class" / student).mkdir(parents=True)
    assert cli.run(["regrade-folder", str(tmp_path / "class"), "-a", "hello", "-o", str(out)]) == 1
    assert ",infrastructure_error,," in out.read_text("utf-8")


def test_a_damaged_export_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    export = tmp_path / "export.zip"
    with zipfile.ZipFile(export, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("li/mine.py", HELLO * 20)
    content = bytearray(export.read_bytes())
    content[45:60] = b"\xff" * 15  # in the compressed data
    export.write_bytes(content)
    assert cli.run(["regrade-folder", str(export), "-a", "hello", "--lang", "en"]) == 2
    assert "is not a zip that can be unpacked" in capsys.readouterr().err


def test_what_the_grader_got_wrong_is_tried_once_more() -> None:
    tries = []

    class Once:
        def grade(self, job: object) -> str:
            tries.append(job)
            if len(tries) == 1:
                raise InfrastructureError("once")
            return "graded"

    class Job:
        name, source = "a.py", b""

    assert graded(Once(), None, Job()) == "graded"  # type: ignore[arg-type, comparison-overlap]


def test_a_pack_has_all_that_a_container_needs(tmp_path: Path) -> None:
    """Scripts that bash takes and that are executable, no caches, no other assignment, no time of packing."""
    path = tmp_path / "a.zip"
    assert cli.run(["gradescope", "pack", "square", "-o", str(path), "--lang", "en"]) == 0
    with zipfile.ZipFile(path) as archive:
        names = archive.namelist()
        for script in ("setup.sh", "run_autograder"):
            assert archive.getinfo(script).external_attr >> 16 & stat.S_IXUSR
            subprocess.run(["bash", "-n"], input=archive.read(script), check=True)
        assert b"--assignments /autograder/source/assignments square\n" in archive.read("run_autograder")
        lock = archive.read("requirements.lock")
        assert b"--hash=sha256:" in lock
        assert b";" not in lock  # pip of Ubuntu 22.04 takes no condition for met: its Python is 3.11.0rc1
        assert len(re.findall(rb"^numpy==", lock, re.MULTILINE)) == 1
        assert set(re.findall(rb"^[a-z0-9-]+==", lock, re.MULTILINE)) == set(
            re.findall(rb"^[a-z0-9-]+==", LOCK.read_bytes(), re.MULTILINE)
        )
        assert len({entry.date_time for entry in archive.infolist()}) == 1
    assert "grader/shim/rclpy/__init__.py" in names
    assert not [name for name in names if "__pycache__" in name]
    of_assignments = {name for name in names if name.startswith("assignments/")}
    assert of_assignments == {"assignments/square/assignment.yaml", "assignments/square/solution.py"}


@pytest.mark.usefixtures("lent")
def test_prairielearn_gets_points_and_a_picture(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pictures, "draw", lambda *drawn, case: b"PNG of " + case.encode())
    (tmp_path / "student").mkdir()
    (tmp_path / "student" / "mine.py").write_bytes(HELLO)
    (tmp_path / "data").mkdir()
    (tmp_path / "data" / "data.json").write_text('{"params": {"assignment": "hello"}}', "utf-8")
    assert cli.run(["prairielearn", "--root", str(tmp_path), "--lang", "en"]) == 0
    document = _results(tmp_path)
    assert document["score"] == 1.0
    head, _, picture = document["images"][0]["url"].partition(",")
    assert (head, base64.b64decode(picture)) == ("data:image/png;base64", b"PNG of default")
    (tmp_path / "student" / "mine.py").write_bytes(b"print(\n")
    assert cli.run(["prairielearn", "--root", str(tmp_path), "-a", "hello", "--lang", "en"]) == 0
    assert _results(tmp_path)["gradable"] is False


def test_prairielearn_must_say_which_assignment(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.run(["prairielearn", "--root", str(tmp_path), "--lang", "en"]) == 2
    assert "params.assignment" in capsys.readouterr().err


@pytest.mark.usefixtures("lent")
def test_a_whole_export_of_gradescope_is_graded_offline(tmp_path: Path) -> None:
    """The zip's metadata names people; a class list goes out, and formulas in names are text."""
    about = "  - :name: =cmd()\n    :sid: '007'\n    :email: a@x\n"
    metadata = f"submission_1:\n  :submitters:\n{about}  :score: 3.0\nsubmission_2: {{}}\n"
    path, out = tmp_path / "export.zip", tmp_path / "scores.csv"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("assignment_9_export/submission_metadata.yml", metadata)
        archive.writestr("assignment_9_export/submission_1/mine.py", HELLO)
        archive.writestr("assignment_9_export/submission_2/notes.txt", "none")
    assert (
        cli.run(
            [
                "regrade-folder",
                str(path),
                "-a",
                "hello",
                "-o",
                str(out),
                "--reports",
                str(tmp_path),
                "--lang",
                "en",
            ]
        )
        == 0
    )
    head, first, second = out.read_text("utf-8-sig").splitlines()
    assert head.startswith("submission,id,email,name,file,status,score")
    assert first.startswith("submission_1,007,a@x,'=cmd(),mine.py,graded,100,100,3.0")
    assert second.startswith('submission_2,,,,,refused,0,100,,"no file that ends in .py')
    assert json.loads((tmp_path / "submission_1.json").read_bytes())["score"] == 100.0


@pytest.mark.parametrize("name", ["../mine.py", "/etc/mine.py", "a/../../mine.py", "..\\mine.py"])
def test_an_export_writes_nowhere_else(name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "export.zip"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr(name, HELLO)
    assert cli.run(["regrade-folder", str(path), "-a", "hello", "--lang", "en"]) == 2
    assert "has a file called" in capsys.readouterr().err


@pytest.mark.parametrize("coding", ["gbk", "utf-8"])
def test_names_of_an_export_are_read_as_windows_packs_them(tmp_path: Path, coding: str) -> None:
    path, name = tmp_path / "export.zip", "张伟"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("X" * len(name.encode(coding)) + "/mine.py", HELLO)
    content = path.read_bytes()
    path.write_bytes(content.replace(b"X" * len(name.encode(coding)), name.encode(coding)))
    with regrade_folder.unpacked(path) as folder:
        assert [entry.name for entry in regrade_folder.entries(folder, (".py",))] == ["mine.py"]
        assert [one.name for one in folder.iterdir()] == [name]


def test_an_export_without_submissions_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Links lead out of it: what they show is nobody's."""
    path = tmp_path / "export.zip"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("li.txt", "none")
    (tmp_path / "class").mkdir()
    (tmp_path / "class" / "li.py").symlink_to(__file__)
    for export in (path, tmp_path / "class"):
        assert cli.run(["regrade-folder", str(export), "-a", "hello", "--lang", "en"]) == 2
        assert capsys.readouterr().err == f"grader: {export}: has no submissions\n"


@pytest.mark.usefixtures("lent")
def test_classroom_50_is_told_what_its_runner_said(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Without the runner's variables nothing is written; with them points are whole and sum up; the exit is 0."""
    path = tmp_path / "hello.py"
    path.write_bytes(b"print('hello')\n")
    command = ["check", str(path), "-a", "hello", "--result", "classroom50", "--lang", "en"]
    assert cli.run(command) == 2
    assert "SUBMISSION_TAG" in capsys.readouterr().err
    for name in ("CLASSROOM", "ASSIGNMENT", "SUBMISSION_TAG", "COMMIT_URL", "RELEASE_URL"):
        monkeypatch.setenv(name, f"of {name}")
    assert cli.run(command) == 0
    document = json.loads(capsys.readouterr().out)
    assert (document["schema"], document["review"]) == ("classroom50/result/v1", "of COMMIT_URL")
    assert document["score"] == sum(test["score"] for test in document["tests"]) < document["max-score"]


@pytest.mark.usefixtures("lent")
def test_autolab_reads_the_last_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "hello.py"
    path.write_bytes(HELLO)
    assert cli.run(["check", str(path), "-a", "hello", "--result", "autolab", "--lang", "en"]) == 0
    shown, scores = (json.loads(line) for line in capsys.readouterr().out.splitlines())
    assert sum(scores["scores"].values()) == 100.0
    assert len(shown[shown["stages"][0]]) == len(scores["scores"])
