"""`grader prairielearn`: the entrypoint of an external grader of PrairieLearn (docs/externalGrading.md there)."""

import argparse
import base64
import json
import os
from pathlib import Path
from typing import Any, Final

from grader.catalog import Catalog
from grader.commands.handed_in import graded, job_of, pick, told_report, write_results
from grader.commands.options import add_language_option
from grader.contracts.assignment import Assignment
from grader.contracts.errors import RefusedError, SettingsError
from grader.contracts.grading import GradingResult
from grader.contracts.text import Language
from grader.grading.slot import Slot, SlotConfig
from grader.render.documents import to_prairielearn

_ROOT: Final = Path("/grade")
_VARIABLE: Final = "GRADER_ASSIGNMENT"
_MOST_BYTES: Final = 1_000_000  # PrairieLearn accepts a results.json of up to 1 MB
_MOST_DATA_BYTES: Final = 1 << 20  # of data.json, which an instructor writes
_MOST_PICTURES: Final = 4


def configure(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments."""
    parser.add_argument("--root", type=Path, default=_ROOT, help=argparse.SUPPRESS)
    parser.add_argument(
        "-a",
        "--assignment",
        help=f"assignment id, else params.assignment of data.json, else ${_VARIABLE} / 作业 id",
    )
    parser.add_argument("--assignments", type=Path, metavar="DIR", help="folder of assignments / 作业文件夹")
    add_language_option(parser)


def run(arguments: argparse.Namespace) -> int:
    """Write results.json and return 0, whatever the score.

    A fault of the grader raises GraderError and writes no file: PrairieLearn then calls the job failed.
    """
    root: Path = arguments.root
    assignment = Catalog(arguments.assignments).get(arguments.assignment or _assignment_id(root))
    write_results(root, _document(root / "student", assignment, arguments.lang))
    return 0


def _assignment_id(root: Path) -> str:
    path = root / "data" / "data.json"
    try:
        with path.open("rb") as file:
            params = json.loads(file.read(_MOST_DATA_BYTES))["params"]
        named = params.get("assignment")
    except (OSError, ValueError, KeyError, AttributeError):
        named = None
    found = named if isinstance(named, str) and named else os.environ.get(_VARIABLE)
    if not found:
        raise SettingsError(
            f"which assignment? Say it with params.assignment in {path}, ${_VARIABLE} or --assignment",
            f"不知道是哪个作业：请写在 {path} 的 params.assignment、环境变量 {_VARIABLE} 或 --assignment 里",
        )
    return found


def _document(student: Path, assignment: Assignment, language: Language) -> dict[str, Any]:
    try:
        handed_in = pick(student, assignment)
    except RefusedError as refusal:
        return {"gradable": False, "format_errors": [refusal.message_in(language)]}
    with Slot(SlotConfig()) as slot:
        result = graded(slot, assignment, handed_in)
        report = told_report(slot, job_of(assignment, handed_in), result.report)
    document = to_prairielearn(report, language)
    pictures = _pictures(assignment, result, language) if document["gradable"] else []
    with_pictures = {**document, "images": pictures}
    return (  # better no pictures than no result
        with_pictures
        if len(json.dumps(with_pictures, ensure_ascii=False).encode()) <= _MOST_BYTES
        else document
    )


def _pictures(assignment: Assignment, result: GradingResult, language: Language) -> list[dict[str, str]]:
    from grader.use_cases.pictures import draw

    if assignment.input == "text":
        return []
    pictures = []
    for run_ in result.report.runs[:_MOST_PICTURES]:
        picture = draw(assignment, result.report, result.trajectories[run_.case], language, case=run_.case)
        url = f"data:image/png;base64,{base64.b64encode(picture).decode()}"
        pictures.append({"label": assignment.title.get(language), "url": url})
    return pictures
