"""`grader regrade-folder`: grade a class that was handed in somewhere else, without a service.

It reads an export of Gradescope's "Download Submissions", zipped or unpacked, or any folder that has a file or a
folder for each submission.
"""

import argparse
import sys
import tempfile
import zipfile
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import Any, Final

import yaml

from grader.catalog import Catalog
from grader.commands.handed_in import graded, pick, read_file
from grader.commands.options import add_grading_options, add_language_option, tell
from grader.commands.plots import file_error, require_folder
from grader.contracts.assignment import SUFFIXES, Assignment
from grader.contracts.errors import InfrastructureError, RefusedError
from grader.contracts.report import GradeReport
from grader.contracts.text import Language, Text
from grader.contracts.upload import MAX_SOURCE_BYTES
from grader.formats.packages.archives import name_in_zip
from grader.formats.sheets.writing import csv_table
from grader.grading.slot import Slot, SlotConfig
from grader.messages import quantity

_METADATA: Final = "submission_metadata.yml"
# Far more than a class hands in, and little enough that a wrong zip fills no disk.
_MOST_MEMBERS: Final = 20_000
_MOST_BYTES: Final = 1 << 30  # of an unpacked export
_MOST_METADATA_BYTES: Final = 32 << 20
_COLUMNS: Final = (
    "submission",
    "id",
    "email",
    "name",
    "file",
    "status",
    "score",
    "max_score",
    "score_there",
    "next_step",
)
_EXIT_FAULT: Final = 1


@dataclass(frozen=True, slots=True, kw_only=True)
class Entry:
    """One submission: where its files are and, if the export says so, whose it is."""

    name: str
    path: Path
    about: dict[str, str]


def configure(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments."""
    parser.add_argument(
        "export", type=Path, metavar="EXPORT", help="zip or folder of submissions / 提交的压缩包或文件夹"
    )
    parser.add_argument("-a", "--assignment", required=True, help="assignment id / 作业 id")
    parser.add_argument(
        "-o", "--output", type=Path, metavar="OUT.csv", help="the scores (default: printed) / 成绩表"
    )
    parser.add_argument(
        "--reports", type=Path, metavar="DIR", help="a report of each as JSON / 每份的完整报告"
    )
    add_language_option(parser)
    add_grading_options(parser)


def run(arguments: argparse.Namespace) -> int:
    """Grade every submission; return 1 if the grader failed at some, whose scores stay empty, else 0."""
    assignment = Catalog(arguments.assignments).get(arguments.assignment)
    if arguments.reports is not None:
        arguments.reports.mkdir(parents=True, exist_ok=True)
    if arguments.output is not None:
        require_folder("--output", arguments.output)
    rows: list[dict[str, str]] = []
    with unpacked(arguments.export) as folder, Slot(SlotConfig(mode=arguments.isolation)) as slot:
        files = entries(folder, SUFFIXES[assignment.input])
        if not files:
            raise _refused(arguments.export, zh="里没有提交", en="has no submissions")
        for entry in files:
            rows.append(_row(slot, assignment, entry, arguments))
            if arguments.output is not None:
                tell(arguments, zh=_line(rows[-1]), en=_line(rows[-1]))
    _write(arguments, rows)
    faults = [row["submission"] for row in rows if row["status"] == "infrastructure_error"]
    if not faults:
        return 0
    tell(
        arguments,
        zh=f"grader: {len(faults)} 份因评分程序自己的错误没有成绩，请再试一次：{', '.join(faults[:8])}",
        en=f"grader: {len(faults)} have no score because the grader failed, try again: {', '.join(faults[:8])}",
    )
    return _EXIT_FAULT


@contextmanager
def unpacked(export: Path) -> Iterator[Path]:
    """Yield the folder of an export; a zip is unpacked into one that is removed afterwards.

    Raises RefusedError: it is neither a zip nor a folder, or the zip must not be unpacked.
    """
    if export.is_dir():
        yield export
        return
    with tempfile.TemporaryDirectory(prefix="grader-export-") as name:
        try:
            with zipfile.ZipFile(export) as archive:
                _unpack(archive, Path(name), export)
        except OSError as error:
            raise file_error("unreadable", str(export), error) from error
        except (zipfile.BadZipFile, zlib.error, EOFError, NotImplementedError, RuntimeError) as error:
            raise _refused(
                export, zh="不是可以解开的 zip 文件", en="is not a zip that can be unpacked"
            ) from error
        yield Path(name)


def _unpack(archive: zipfile.ZipFile, folder: Path, export: Path) -> None:
    """Unpack into `folder`, and refuse a zip with anything but ordinary files inside it."""
    members = [member for member in archive.infolist() if not member.is_dir()]
    if len(members) > _MOST_MEMBERS or sum(member.file_size for member in members) > _MOST_BYTES:
        raise _refused(
            export,
            zh="太大：文件太多或解开后超过 1 GiB",
            en="is too large: too many files, or over 1 GiB unpacked",
        )
    for member in members:
        name = name_in_zip(member)
        parts = PurePosixPath(name.replace("\\", "/")).parts
        kind = member.external_attr >> 28  # of a Unix file: 8 is an ordinary one, 0 is not said
        if not parts or parts[0] == "/" or ".." in parts or "\0" in name or kind not in (0, 8):
            raise _refused(export, zh=f"里有不该有的文件名 {name!r}", en=f"has a file called {name!r}")
        # One byte too many is enough for `read_file` to refuse the file.
        most = _MOST_METADATA_BYTES if parts[-1] == _METADATA else MAX_SOURCE_BYTES + 1
        place = folder.joinpath(*parts)
        place.parent.mkdir(parents=True, exist_ok=True)
        with archive.open(member) as packed:
            place.write_bytes(packed.read(most))


def _refused(export: Path, *, zh: str, en: str) -> RefusedError:
    return RefusedError("export", Text(zh=zh, en=en).about(export))


def entries(folder: Path, endings: tuple[str, ...]) -> list[Entry]:
    """Return the submissions of an unpacked export, in the order of their names; none behind links.

    Raises RefusedError: the metadata cannot be read.
    """
    inner = [path for path in folder.iterdir() if not path.name.startswith((".", "__"))]
    if len(inner) == 1 and inner[0].is_dir() and not (folder / _METADATA).exists():
        folder = inner[0]
    metadata = _metadata(folder / _METADATA)
    paths = sorted(
        path
        for path in folder.iterdir()
        if not path.name.startswith((".", "__")) and (path.is_dir() or path.name.lower().endswith(endings))
        if not path.is_symlink()
    )
    return [Entry(name=path.name, path=path, about=metadata.get(path.name, {})) for path in paths]


def _metadata(path: Path) -> dict[str, dict[str, str]]:
    """Return what Gradescope says of each submission. All values are read as text, so no tag makes an object."""
    if not path.is_file():
        return {}
    try:
        content = path.read_bytes()[:_MOST_METADATA_BYTES].decode("utf-8")
        document = yaml.load(content, Loader=yaml.BaseLoader)  # noqa: S506  (texts only)
    except (OSError, UnicodeDecodeError, yaml.YAMLError, RecursionError) as error:
        raise _refused(Path(path.name), zh="读不懂", en="cannot be read") from error
    if not isinstance(document, dict):
        return {}
    return {str(name): _about(each) for name, each in document.items() if isinstance(each, dict)}


def _about(each: dict[str, Any]) -> dict[str, str]:
    submitters = each.get(":submitters")
    first = (
        submitters[0]
        if isinstance(submitters, list) and submitters and isinstance(submitters[0], dict)
        else {}
    )
    fields = {
        "id": first.get(":sid"),
        "email": first.get(":email"),
        "name": first.get(":name"),
        "score_there": each.get(":score"),
    }
    return {key: value for key, value in fields.items() if isinstance(value, str)}


def _row(slot: Slot, assignment: Assignment, entry: Entry, arguments: argparse.Namespace) -> dict[str, str]:
    language: Language = arguments.lang
    row = dict.fromkeys(_COLUMNS, "") | {"submission": entry.name} | entry.about
    row["max_score"] = quantity.points(assignment.max_score)
    try:
        handed_in = pick(entry.path, assignment) if entry.path.is_dir() else read_file(entry.path)
        row["file"] = handed_in.name
        report = graded(slot, assignment, handed_in).report
    except RefusedError as refusal:
        return row | {"status": "refused", "score": "0", "next_step": refusal.message_in(language)}
    except InfrastructureError as error:
        return row | {"status": "infrastructure_error", "next_step": error.message_in(language)}
    if arguments.reports is not None:
        (arguments.reports / f"{entry.name}.json").write_bytes(report.canonical_bytes())
    return row | _graded_row(report, language)


def _graded_row(report: GradeReport, language: Language) -> dict[str, str]:
    score = "" if report.score is None else quantity.points(report.score)
    return {"status": report.status.value, "score": score, "next_step": report.hint.get(language)}


def _line(row: dict[str, str]) -> str:
    return f"{row['submission']}: {row['status']} {row['score'] or '—'}/{row['max_score']}"


def _write(arguments: argparse.Namespace, rows: list[dict[str, str]]) -> None:
    table = csv_table([_COLUMNS, *([row[column] for column in _COLUMNS] for row in rows)])
    if arguments.output is None:
        sys.stdout.write(table)
        return
    try:
        arguments.output.write_text(table, "utf-8", newline="")
    except OSError as error:
        raise file_error("output_file", str(arguments.output), error) from error
    tell(
        arguments,
        zh=f"→ {arguments.output}：{len(rows)} 份",
        en=f"→ {arguments.output}: {len(rows)} submissions",
    )
