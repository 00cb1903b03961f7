"""Gradings for other platforms: choosing the file in a submission's folder, grading it, writing the result."""

import json
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any

from grader.contracts.assignment import SUFFIXES, Assignment
from grader.contracts.errors import GraderError, InfrastructureError, RefusedError
from grader.contracts.explanation import Explanation, is_worth_trying
from grader.contracts.grading import GradingJob, GradingResult
from grader.contracts.report import GradeReport
from grader.contracts.text import Text, trouble
from grader.contracts.upload import MAX_SOURCE_BYTES, check_name, check_source
from grader.formats.packages.bundle import MAX_PACKAGE_BYTES, bundled
from grader.formats.packages.folders import read_bounded, read_folder
from grader.grading.slot import Slot

_MOST_FILES = 1_000
_SHOWN_NAMES = 8


@dataclass(frozen=True, slots=True, kw_only=True)
class ChosenFile:
    """One file as somebody handed it in."""

    name: str
    source: bytes


def pick(folder: Path, assignment: Assignment) -> ChosenFile:
    """Return the file to grade: the only one of its kind in a folder, or the only one whose name fits.

    Raises:
        RefusedError: there is none or more than one, or a service would not accept it either.
        InfrastructureError: this machine cannot read it.
    """
    if assignment.input == "package":
        return _package(folder)
    endings = SUFFIXES[assignment.input]
    paths = [path for path in _files(folder) if path.name.lower().endswith(endings)]
    if len(paths) > 1:
        named = [path for path in paths if _named(path.name, assignment.file_patterns)]
        paths = named if len(named) == 1 else paths
    if len(paths) != 1:
        raise _refusal(folder, paths, endings)
    check_name(paths[0].name, endings)
    return read_file(paths[0])


def _package(folder: Path) -> ChosenFile:
    """Return the package that was handed in: as the only zip, or unpacked, as some platforms leave it.

    Raises as `pick`.
    """
    zips = [path for path in _files(folder) if path.name.lower().endswith(".zip")]
    try:
        if len(zips) == 1:
            return ChosenFile(name=zips[0].name, source=bundled(read_bounded(zips[0], MAX_PACKAGE_BYTES)))
        return ChosenFile(name="package.zip", source=read_folder(folder))
    except OSError as error:
        raise InfrastructureError.about(folder.name, trouble(error)) from error


def read_file(path: Path) -> ChosenFile:
    """Return a file that somebody handed in.

    Raises:
        RefusedError: it could not be handed in to a service either.
        InfrastructureError: this machine does not read it: no fault of who handed it in.
    """
    try:
        with path.open("rb") as file:
            source = file.read(MAX_SOURCE_BYTES + 1)
    except OSError as error:
        raise InfrastructureError.about(path.name, trouble(error)) from error
    check_source(source)
    return ChosenFile(name=path.name, source=source)


def graded(slot: Slot, assignment: Assignment, handed_in: ChosenFile) -> GradingResult:
    """Return the grading of a file; what the grader itself got wrong is tried once more.

    Raises:
        InfrastructureError: the grader failed again: this says nothing about the file.
        SandboxUnavailableError: this machine cannot confine scripts.
    """
    job = job_of(assignment, handed_in)
    try:
        return slot.grade(job)
    except InfrastructureError:
        return slot.grade(job)


def job_of(assignment: Assignment, handed_in: ChosenFile) -> GradingJob:
    """Return what grades a file."""
    return GradingJob(file_name=handed_in.name, source=handed_in.source, assignment=assignment)


def told_report(slot: Slot, job: GradingJob, report: GradeReport) -> GradeReport:
    """Return a report that says what was tried in place of what was guessed; a search that fails says nothing."""
    from grader.render.steps import own_hints, told

    explanation = Explanation()
    if is_worth_trying(job.assignment, report):
        with suppress(GraderError):
            explanation = slot.explain(job)
    return told(report, explanation, job.assignment.hints, own_hints(job.assignment, report))


def write_results(root: Path, document: Mapping[str, Any]) -> None:
    """Write results.json where a platform looks for it, as a whole or not at all."""
    folder = root / "results"
    folder.mkdir(parents=True, exist_ok=True)
    unfinished = folder / "results.json.new"
    unfinished.write_text(json.dumps(document, ensure_ascii=False, allow_nan=False), "utf-8")
    unfinished.replace(folder / "results.json")


def _files(folder: Path) -> list[Path]:
    """Return the ordinary files below a folder, without links and what systems and editors leave there."""
    files: list[Path] = []
    for path in sorted(folder.rglob("*")):
        parts = path.relative_to(folder).parts
        if any(part.startswith((".", "__")) for part in parts) or path.is_symlink() or not path.is_file():
            continue
        files.append(path)
        if len(files) > _MOST_FILES:
            break
    return files


def _named(name: str, patterns: Sequence[str]) -> bool:
    return any(fnmatchcase(name.lower(), pattern.lower()) for pattern in patterns)


def _refusal(folder: Path, paths: list[Path], endings: Sequence[str]) -> RefusedError:
    kinds = Text(zh=" 或 ".join(endings), en=" or ".join(endings))
    if not paths:
        there = ", ".join(path.name for path in _files(folder)[:_SHOWN_NAMES])
        zh = f"没有交上来以 {kinds.zh} 结尾的文件" + (f"，只有：{there}。" if there else "。")
        en = f"no file that ends in {kinds.en} was handed in" + (f", only: {there}" if there else "")
        return RefusedError.saying("wrong_file_type", zh=zh + "请交一个文件。", en=f"{en}; hand in one file")
    names = ", ".join(path.name for path in paths[:_SHOWN_NAMES])
    return RefusedError.saying(
        "several_files",
        zh=f"交了 {len(paths)} 个文件（{names}），看不出要评哪一个：请只交一个。",
        en=f"{len(paths)} files were handed in ({names}), and nothing tells which to grade: hand in one",
    )
