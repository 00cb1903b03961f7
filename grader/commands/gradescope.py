"""`grader gradescope`: one assignment as an autograder for Gradescope, and what runs inside its containers."""

import argparse
import io
import re
import sys
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Final

from grader.catalog import Catalog
from grader.catalog.files import handed_in, is_there
from grader.commands.handed_in import ChosenFile, graded, job_of, pick, told_report, write_results
from grader.commands.options import add_language_option, tell
from grader.commands.plots import file_error
from grader.contracts.assignment import SUFFIXES, Assignment
from grader.contracts.errors import (
    AssignmentError,
    GraderError,
    InfrastructureError,
    RefusedError,
)
from grader.contracts.report import GradeReport
from grader.contracts.text import Language, Text
from grader.formats.installation import add_file, package_files
from grader.grading.slot import Slot, SlotConfig
from grader.render.documents import to_gradescope

_ROOT: Final = Path("/autograder")
_LOCK: Final = "requirements.lock"
_OF_PYTHON: Final = re.compile(rb"^(\S+) ; python_full_version (<|>=) '3\.\d+'", re.MULTILINE)
_LEFT_OUT: Final = ("assignments", "lesson", "docs")

_SETUP: Final = """\
#!/usr/bin/env bash
# Runs once, as root, while Gradescope builds the image. Whatever fails here fails the build, not a student.
set -euo pipefail
cd /autograder/source
export DEBIAN_FRONTEND=noninteractive
python=$(command -v python3.11 || true)
if [ -z "$python" ]; then
    apt-get update
    apt-get install -y python3.11 python3.11-venv
    python=python3.11
fi
"$python" -c 'import ensurepip' || { apt-get update && apt-get install -y python3.11-venv; }
"$python" -m venv /opt/grader
/opt/grader/bin/python -m pip install --quiet --no-cache-dir --require-hashes --only-binary :all: \\
    -r requirements.lock
packages=$(/opt/grader/bin/python -c 'import sysconfig; print(sysconfig.get_path("purelib"))')
cp -r grader "$packages/"
/opt/grader/bin/python -m compileall -q "$packages/grader"
cd /  # so that the installed grader is what is tried
# Nobody is graded where scripts cannot be confined: the build ends here and says what is missing.
/opt/grader/bin/python -m grader doctor --lang @LANGUAGE@ ||
    /opt/grader/bin/python -m grader doctor --lang @LANGUAGE@ --prepare-root || true
/opt/grader/bin/python -m grader gradescope probe --lang @LANGUAGE@ \\
    --assignments /autograder/source/assignments @ASSIGNMENT@
"""
_RUN: Final = """\
#!/usr/bin/env bash
# Runs for each submission; what it prints is for instructors.
exec /opt/grader/bin/python -m grader gradescope run --lang @LANGUAGE@ \\
    --assignments /autograder/source/assignments @ASSIGNMENT@
"""
_FAULT: Final = Text(
    zh="评分程序自己出了错，与你的程序无关，这次没有成绩。请老师查看输出后重新评分（Rerun Autograder）。",
    en="The grader failed; this says nothing about your program, and there is no score. Instructors: see the "
    "output, then run the autograder again.",
)


def configure(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments."""
    actions = parser.add_subparsers(dest="action", required=True, metavar="pack | run | probe")
    pack = actions.add_parser("pack", help="write the zip to be uploaded / 生成要上传的 zip")
    pack.add_argument(
        "-o", "--output", type=Path, required=True, metavar="OUT.zip", help="the zip / 输出文件"
    )
    run_one = actions.add_parser("run", help="grade one submission inside a container / 在容器里评一份提交")
    run_one.add_argument("--root", type=Path, default=_ROOT, help=argparse.SUPPRESS)
    probe = actions.add_parser("probe", help="refuse a container that cannot grade / 检查容器能否评分")
    for action in (pack, run_one, probe):
        action.add_argument("assignment", help="assignment id / 作业 id")
        action.add_argument(
            "--assignments", type=Path, metavar="DIR", help="folder of assignments / 作业文件夹"
        )
        add_language_option(action)


def run(arguments: argparse.Namespace) -> int:
    """Do one of the actions; 0 done. A grading is done whatever the score is, and also when the grader failed."""
    catalog = Catalog(arguments.assignments)
    assignment = catalog.get(arguments.assignment)
    if arguments.action == "pack":
        _pack(arguments, catalog.folder(assignment.id), assignment)
    elif arguments.action == "probe":
        _probe(arguments, catalog.folder(assignment.id), assignment)
    else:
        _run(arguments, assignment)
    return 0


# ------------------------------------------------------------------------------------------------ packing


def _pack(arguments: argparse.Namespace, folder: Path, assignment: Assignment) -> None:
    out: Path = arguments.output
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, text in (("setup.sh", _SETUP), ("run_autograder", _RUN)):
            script = text.replace("@LANGUAGE@", arguments.lang).replace("@ASSIGNMENT@", assignment.id)
            add_file(archive, name, script.encode(), executable=True)
        for name, path in _files(folder, assignment):
            content = path.read_bytes()
            add_file(archive, name, _for_python_311(content) if name == _LOCK else content)
    try:
        out.write_bytes(packed.getvalue())
    except OSError as error:
        raise file_error("output_file", str(out), error) from error
    tell(
        arguments,
        zh=f"→ {out}：在 Gradescope 的 Configure Autograder 里上传。镜像选 Ubuntu 22.04，内存至少 768 MB。",
        en=f"→ {out}: upload it under Configure Autograder. Base image Ubuntu 22.04, at least 768 MB of memory.",
    )


def _files(folder: Path, assignment: Assignment) -> Iterator[tuple[str, Path]]:
    """Yield name and path of what goes into the zip: this grader, its packages by version, the assignment."""
    for name, path in package_files():
        if name.partition("/")[0] not in _LEFT_OUT:
            yield (name if name == _LOCK else f"grader/{name}"), path
    for path in sorted(folder.rglob("*")):
        parts = path.relative_to(folder).parts
        if (
            path.is_file()
            and parts[0] not in ("wrong", "__pycache__")
            and not path.name.startswith("starter")
        ):
            yield f"assignments/{assignment.id}/{'/'.join(parts)}", path


def _for_python_311(lock: bytes) -> bytes:
    """Return the packages for the Python that `_SETUP` installs, without conditions.

    Ubuntu 22.04 has 3.11.0rc1, of which its pip 22.0 says that it is neither below 3.13 nor above.
    """
    entries = re.split(rb"^(?=\S)", lock, flags=re.MULTILINE)
    conditioned = [(entry, _OF_PYTHON.match(entry)) for entry in entries]
    return b"".join(_OF_PYTHON.sub(rb"\1", one) for one, of in conditioned if of is None or of[2] == b"<")


# ---------------------------------------------------------------------------------------------- containers


def _probe(arguments: argparse.Namespace, folder: Path, assignment: Assignment) -> None:
    """Grade the assignment's own solution as a student's would be.

    Raises GraderError: scripts cannot be confined here, or the solution has not got full marks.
    """
    path = folder / f"solution{SUFFIXES[assignment.input][0]}"
    if not is_there(path):
        raise AssignmentError(
            f"{assignment.id}: there is no {path.name} to try the container with",
            f"{assignment.id}：没有 {path.name}，无法检查容器",
        )
    with Slot(SlotConfig()) as slot:
        report = graded(slot, assignment, ChosenFile(name=path.name, source=handed_in(path))).report
    if report.score not in (report.max_score, None):
        raise InfrastructureError(
            f"the solution of {assignment.id} got {report.score} of {report.max_score} here",
            f"{assignment.id} 的参考答案在这里只得 {report.score}/{report.max_score}",
        )
    tell(
        arguments,
        zh="评分环境正常：参考答案得满分。",
        en="This container grades: the solution has full marks.",
    )


def _run(arguments: argparse.Namespace, assignment: Assignment) -> None:
    root: Path = arguments.root
    write_results(root, _document(root / "submission", assignment, arguments.lang))


def _document(submission: Path, assignment: Assignment, language: Language) -> dict[str, Any]:
    """Return results.json: of a file that cannot be graded 0 and why, of a fault of the grader no number."""
    try:
        handed_in = pick(submission, assignment)
        with Slot(SlotConfig()) as slot:
            report: GradeReport = graded(slot, assignment, handed_in).report
            shown = told_report(slot, job_of(assignment, handed_in), report)
    except RefusedError as refusal:
        return _message(refusal.message_in(language), score=0.0)
    except GraderError as error:  # the container can no longer do what it could when it was built
        sys.stdout.write(f"{type(error).__name__}: {error}\n")
        return _message(_FAULT.get(language))
    sys.stdout.write(f"{handed_in.name}: {report.status.value}, {report.score}/{report.max_score}\n")
    return to_gradescope(shown, language, report.sha256())


def _message(text: str, score: float | None = None) -> dict[str, Any]:
    """Return a document without a graded item; Gradescope wants a test where there is no score."""
    common = {"output": text, "output_format": "text", "visibility": "visible", "stdout_visibility": "hidden"}
    if score is not None:
        return {**common, "score": score, "tests": []}
    return {
        **common,
        "tests": [{"name": "grader", "status": "failed", "output": text, "visibility": "visible"}],
    }
