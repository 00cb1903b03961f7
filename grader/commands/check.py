"""`grader check FILE`: the local pre-check, with the same grading core as the service."""

import argparse
import json
import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING

from grader.commands.options import (
    ASSIGNMENT_HELP,
    JSON_HELP,
    add_distro_option,
    add_grading_options,
    add_language_option,
    add_way_option,
    tell,
)
from grader.commands.plots import check_bag_path, check_plot_path, file_error, form_of, of_case, write_file
from grader.contracts.assignment import Assignment, Hints
from grader.contracts.errors import (
    InfrastructureError,
    RefusedError,
    SandboxUnavailableError,
    SettingsError,
    UnknownAssignmentError,
)
from grader.contracts.explanation import Explanation, is_worth_trying
from grader.contracts.extras import MissingExtraError
from grader.contracts.grading import GradingJob, GradingResult
from grader.contracts.python import UTC
from grader.contracts.text import Language
from grader.grading.slot import Slot, SlotConfig

if TYPE_CHECKING:
    from grader.catalog import Catalog

EXIT_FULL_MARKS = 0
EXIT_NOT_FULL = 1
EPILOG = "exit code / 退出码: 0 full marks / 满分, 1 fewer / 未满分, 2 not graded / 没有评分"
FORMATS = ("gradescope", "prairielearn", "autolab", "classroom50")


def configure(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments."""
    parser.add_argument(
        "file",
        type=Path,
        help="the script, answer or package (folder, zip) to grade / 要评分的脚本、答案或功能包",
    )
    parser.add_argument("-a", "--assignment", help=ASSIGNMENT_HELP)
    add_language_option(parser)
    parser.add_argument("--json", action="store_true", help=JSON_HELP)
    parser.add_argument(
        "--result",
        choices=FORMATS,
        help="print the result as another platform reads it / 以其他平台的格式输出结果",
    )
    parser.add_argument(
        "--plot",
        type=Path,
        metavar="OUT",
        help="draw the trajectory to OUT, .png or .svg; of several cases each to OUT-CASE / 把轨迹画到 OUT",
    )
    parser.add_argument(
        "--record",
        type=Path,
        metavar="OUT.mcap",
        help="write the run as a ROS bag; of several cases each to OUT-CASE.mcap / 把运行写成 ROS bag",
    )
    parser.add_argument(
        "--logs", action="store_true", help="show the script's logs and output, too / 同时显示日志和输出"
    )
    add_distro_option(
        parser,
        help="the course's release of ROS 2, for assignments that name none (humble) / 课程的 ROS 2 版本",
    )
    add_way_option(parser)
    add_grading_options(parser)


def run(arguments: argparse.Namespace) -> int:
    """Grade the file; 0 full marks (with ``--result`` any), 1 not, 2 not gradable (raised as GraderError)."""
    if arguments.plot is not None:
        check_plot_path(arguments.plot)
    if arguments.record is not None:
        check_bag_path(arguments.record)
    source = read_handed_in(arguments.file)
    _check_environment(arguments)
    with Slot(SlotConfig(mode=arguments.isolation)) as slot:  # warms up while the assignment is read
        job, result = _grade(slot, arguments, source)
        if is_explained(arguments, job.assignment, result):
            _print_table(arguments, job.assignment, result, show_steps=False)
            _explain(slot, arguments, job, result)
        else:
            shown = _as_told(slot, arguments, job, result)
            slot.abort()  # such a large process takes a while to die: let it do so while the table is printed
            _show_result(arguments, job.assignment, shown, result.report.sha256())
        _write_files(arguments, job.assignment, result)
    report = result.report
    if arguments.result is not None:
        return EXIT_FULL_MARKS  # other platforms take anything else for a fault of the grader
    return EXIT_FULL_MARKS if report.score == report.max_score else EXIT_NOT_FULL


def read_handed_in(path: Path) -> bytes:
    """Return what would be stored of a script, an answer, or a package as a zip or a folder.

    Raises RefusedError: it cannot be read, or could not be uploaded either.
    """
    if path.is_dir() or path.suffix.lower() == ".zip":
        from grader.formats.packages.bundle import MAX_PACKAGE_BYTES, bundled
        from grader.formats.packages.folders import read_bounded, read_folder

        try:
            return read_folder(path) if path.is_dir() else bundled(read_bounded(path, MAX_PACKAGE_BYTES))
        except OSError as error:
            raise file_error("unreadable", str(path), error) from error
    return read_source(path)


def handed_in_name(path: Path) -> str:
    """Return the name under which a file or a package's folder is handed in."""
    return f"{path.resolve().name}.zip" if path.is_dir() else path.name


def read_source(path: Path) -> bytes:
    """Return the bytes of a script.

    Raises RefusedError: it cannot be read, or could not be uploaded either.
    """
    from grader.contracts.upload import MAX_SOURCE_BYTES, check_source

    try:
        with path.open("rb") as file:
            source = file.read(MAX_SOURCE_BYTES + 1)  # no more: it may be a device that never ends
    except OSError as error:
        raise file_error("unreadable", str(path), error) from error
    if len(source) > MAX_SOURCE_BYTES:
        raise RefusedError.saying(
            "too_large",
            zh=f"{path}：文件超过 {MAX_SOURCE_BYTES} 字节",
            en=f"{path}: the file has more than {MAX_SOURCE_BYTES} bytes",
        )
    check_source(source)
    return source


def is_explained(arguments: argparse.Namespace, assignment: Assignment, result: GradingResult) -> bool:
    """Whether changes are tried: for people who read why marks are lacking."""
    return _for_people(arguments) and is_worth_trying(assignment, result.report)


def _explain(slot: Slot, arguments: argparse.Namespace, job: GradingJob, result: GradingResult) -> None:
    """Print what to do, when the marks are printed; a search that fails leaves the report's own hints."""
    from grader.catalog import Catalog
    from grader.contracts.upload import same_program
    from grader.render.labels import word
    from grader.render.terminal import console, render_steps

    output = console()
    starter = Catalog(arguments.assignments).starter(job.assignment.id)
    if starter and same_program(job.source, starter):
        output.print(word("untouched", arguments.lang))
        return
    try:
        with output.status(
            word("looking", arguments.lang)
        ):  # shows nothing, unless somebody sits at a terminal
            explanation = slot.explain(job)
    except InfrastructureError:
        explanation = Explanation()
    explained_lines = list(render_steps(result.report, explanation, job.assignment, arguments.lang))
    for number, part in enumerate(explained_lines, 1):
        output.print(part)
        if number < len(explained_lines) and not _asks_for_more(arguments, output.is_terminal):
            return


def _asks_for_more(arguments: argparse.Namespace, is_terminal: bool) -> bool:
    """Whether the next hint is wanted: whoever sits at a terminal is asked, and others read all."""
    from grader.render.labels import word

    if not (is_terminal and sys.stdin.isatty()):
        return True
    try:
        return not input(word("more_hint_key", arguments.lang)).strip()
    except (EOFError, KeyboardInterrupt):
        return False


def _grade(slot: Slot, arguments: argparse.Namespace, source: bytes) -> tuple[GradingJob, GradingResult]:
    from grader.catalog import Catalog
    from grader.catalog.cache import AssignmentCache, default_cache_folder

    folder = default_cache_folder()
    catalog = Catalog(arguments.assignments, None if folder is None else AssignmentCache(folder))
    chosen = catalog.get(arguments.assignment or _guess(catalog, arguments.file))
    assignment = chosen.of_course(arguments.distro, arguments.runs_as)
    _check_input(arguments, assignment)
    job = GradingJob(file_name=handed_in_name(arguments.file), source=source, assignment=assignment)
    with faults_explained():
        result = slot.grade(job, _import_output if _for_people(arguments) else lambda: None)
    return job, result


@contextmanager
def faults_explained() -> Iterator[None]:
    """Explain faults of the grader or its sandbox to a student who grades a script on their own computer."""
    try:
        yield
    except SandboxUnavailableError as error:
        raise SandboxUnavailableError(
            f"{error}\nRun `grader doctor` for details. For your own code, `--isolation dev` runs it unprotected.",
            f"这台电脑缺少安全运行脚本所需的隔离（{error}）。\n"
            "详情见 `grader doctor`。自己的代码可以用 `--isolation dev` 不加保护地运行。",
        ) from error
    except MissingExtraError:
        raise
    except InfrastructureError as error:
        raise InfrastructureError(
            f"{error}\nThe grader failed, not your script: try again.",
            f"评分程序自己出了错，不是你的脚本的问题：请再试一次。（{error}）",
        ) from error


def _import_output() -> None:
    """Import what prints the table while the script runs; earlier, that would only slow its start down."""
    import grader.render.terminal  # noqa: F401


def _check_input(arguments: argparse.Namespace, assignment: Assignment) -> None:
    """Refuse a script where a text is asked for, and the other way round, as an upload would be.

    Raises RefusedError: the file's name, ``--plot`` or ``--record`` does not go with the assignment.
    """
    from grader.contracts.assignment import SUFFIXES
    from grader.contracts.upload import check_name

    check_name(handed_in_name(arguments.file), SUFFIXES[assignment.input])
    if assignment.input != "text":
        return
    if arguments.plot is not None:
        raise RefusedError.saying(
            "plot_text",
            zh=f"作业 {assignment.id} 交的是文字，没有轨迹可画",
            en=f"{assignment.id} is answered by a text: there is nothing to plot",
        )
    if arguments.record is not None:
        raise RefusedError.saying(
            "record_text",
            zh=f"作业 {assignment.id} 交的是文字，没有运行可记录",
            en=f"{assignment.id} is answered by a text: there is no run to record",
        )


def _guess(catalog: "Catalog", file: Path) -> str:
    from grader.contracts.assignment import SUFFIXES
    from grader.contracts.upload import check_name

    file_name = handed_in_name(file)
    guess = catalog.guess_assignment(file_name)
    if guess is None:
        endings = tuple(ending for suffixes in SUFFIXES.values() for ending in suffixes)
        if not file_name.lower().endswith(endings) or ".py." in file_name.lower():
            check_name(file_name, SUFFIXES["script"])  # says what the file is instead
        raise UnknownAssignmentError.unguessed(file_name)
    return guess


def _check_environment(arguments: argparse.Namespace) -> None:
    """Refuse Classroom 50's format where its runner has not said which submission this is.

    Raises SettingsError: names the variables that are missing.
    """
    if arguments.result != "classroom50":
        return
    from grader.render.documents import CLASSROOM50_FIELDS

    missing = [
        name for field, name in CLASSROOM50_FIELDS.items() if field != "review" and not os.environ.get(name)
    ]
    if missing:
        raise SettingsError(
            f"--result classroom50 needs these environment variables, which its runner sets: {', '.join(missing)}",
            f"--result classroom50 需要它的运行器设置的环境变量：{', '.join(missing)}",
        )


def _for_people(arguments: argparse.Namespace) -> bool:
    return not arguments.json and arguments.result is None


def _as_told(
    slot: Slot, arguments: argparse.Namespace, job: GradingJob, result: GradingResult
) -> GradingResult:
    """Return a result as other platforms show it, and as much of it as the assignment tells."""
    if arguments.json or (arguments.result is None and job.assignment.hints is Hints.CHANGE):
        return result
    from grader.commands.handed_in import told_report

    return replace(result, report=told_report(slot, job, result.report))


def _show_result(
    arguments: argparse.Namespace, assignment: Assignment, result: GradingResult, sha256: str
) -> None:
    """Print a result; `sha256`: of the report as it was made."""
    if arguments.json:
        sys.stdout.write(result.report.canonical_bytes().decode() + "\n")
    elif arguments.result is not None:
        for document in _documents(arguments, result, sha256):
            sys.stdout.write(json.dumps(document, ensure_ascii=False, allow_nan=False) + "\n")
    else:
        _print_table(arguments, assignment, result)


def _write_files(arguments: argparse.Namespace, assignment: Assignment, result: GradingResult) -> None:
    if arguments.plot is not None:
        _plot(arguments, assignment, result)
    if arguments.record is not None:
        _record(arguments, assignment, result)


def _documents(
    arguments: argparse.Namespace, result: GradingResult, sha256: str
) -> tuple[dict[str, object], ...]:
    """Return the lines of the format that ``--result`` asks for."""
    from grader.render import documents

    report, language = result.report, arguments.lang
    if arguments.result == "gradescope":
        return (documents.to_gradescope(report, language, sha256),)
    if arguments.result == "prairielearn":
        return (documents.to_prairielearn(report, language),)
    if arguments.result == "autolab":
        return documents.to_autolab(report, language)
    return (documents.to_classroom50(report, os.environ, datetime.now(UTC), language),)


def _print_table(
    arguments: argparse.Namespace, assignment: Assignment, result: GradingResult, *, show_steps: bool = True
) -> None:
    from grader.render.terminal import console, render_report

    language: Language = arguments.lang
    output = console()
    output.print(
        render_report(
            result.report,
            language=language,
            file_name=arguments.file.name,
            title=assignment.title,
            cases={case.id: case.title for case in assignment.cases},
            show_logs=arguments.logs,
            show_steps=show_steps,
        )
    )
    if not result.measurements.isolation.startswith("strict"):  # weaker than what a service grades under
        layers = ", ".join(result.measurements.missing_layers)
        tell(
            arguments,
            zh=f"grader: 隔离不完整，缺少：{layers}",
            en=f"grader: isolation is incomplete, without: {layers}",
        )


def _plot(arguments: argparse.Namespace, assignment: Assignment, result: GradingResult) -> None:
    from grader.use_cases.pictures import draw

    form = form_of(arguments.plot)

    def drawn(case: str) -> bytes:
        trajectory = result.trajectories[case]
        return draw(assignment, result.report, trajectory, arguments.lang, form, case=case)

    _write_each(arguments, result, "--plot", arguments.plot, drawn)


def _record(arguments: argparse.Namespace, assignment: Assignment, result: GradingResult) -> None:
    from grader.use_cases.bags import bagged

    content = result.report.canonical_bytes()

    def bag(case: str) -> bytes:
        return bagged(assignment, result.report, content, result.trajectories[case], case)

    _write_each(arguments, result, "--record", arguments.record, bag)


def _write_each(
    arguments: argparse.Namespace, result: GradingResult, option: str, out: Path, made: Callable[[str], bytes]
) -> None:
    """Write what is made of each case to the file that an option names."""
    cases = [run.case for run in result.report.runs]
    for case in cases:
        file = of_case(out, case, cases)
        write_file(option, file, made(case))
        if _for_people(arguments):
            sys.stdout.write(f"→ {file}\n")
