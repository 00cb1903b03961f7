"""Check assignments by their own files: solutions get full marks, wrong scripts the scores they must get."""

from collections.abc import Iterable, Mapping, Sequence
from contextlib import closing
from dataclasses import replace
from pathlib import Path

from rich import text as styled
from rich.table import Table

from grader.catalog import Catalog
from grader.catalog.files import handed_in
from grader.catalog.misfits import refusals
from grader.catalog.reference import record
from grader.checks import problems as check_problems
from grader.commands.plots import file_error
from grader.contracts.assignment import Assignment
from grader.contracts.errors import AssignmentError
from grader.contracts.grading import Grader
from grader.contracts.notation import written
from grader.contracts.text import EMPTY, Language, Text, trouble
from grader.grading.examination import Examination, Finding, OwnScript, own_scripts
from grader.grading.examination import examine as examine_scripts
from grader.grading.examination.blind import driven_blindly, looks
from grader.grading.examination.reference import traced, wants_reference
from grader.grading.examination.sensitivity import Sensitivity
from grader.grading.slot import Slot, SlotConfig
from grader.messages.quantity import NOTHING, number
from grader.render.progress import followed
from grader.render.terminal import console

_ASSIGNMENT = Text(zh="作业", en="assignment")
_SCRIPT = Text(zh="脚本", en="script")
_SCORE = Text(zh="得分", en="score")
_PROBLEM = Text(zh="问题", en="problem")
_ITEM = Text(zh="评分项", en="item")
_SOLUTION = Text(zh="答案", en="solution")
_MARGIN = Text(zh="余量", en="margin")
_INSIDE = Text(zh="：答案离满分范围的边还有多远", en=": how far the solution lies inside each band")
_ERROR_IN = Text(zh="哪里有误差", en="error in")
_LESS_COSTS = Text(zh="小多少开始扣", en="too small: costs from")
_LESS_LEAVES_NOTHING = Text(zh="小多少扣完", en="nothing left at")
_MORE_COSTS = Text(zh="大多少开始扣", en="too large: costs from")
_MORE_LEAVES_NOTHING = Text(zh="大多少扣完", en="nothing left at")
_DRIVER = Text(zh="不看的开法", en="driver that looks at nothing")
_USUAL_TOTAL = 100
_SHIFT = 100  # of the seeds of another room
_LATER_S = 4.0  # longer than a side and a corner of most figures take
_LUCK = Text(
    zh="得分随种子或 Ctrl+C 的时刻变化", en="the score changes with the seed or the instant of Ctrl+C"
)
_WHICH_COSTS = Text(zh="：答案的动作差多少就扣多少", en=": which error in the solution's motion costs what")


def validate(
    catalog: Catalog, assignment_ids: Iterable[str], language: Language, *, details: bool = False
) -> int:
    """Grade the files of the assignments and print their scores; return 0 when all are as expected.

    Exercises with a sensor or a goal are also driven by drivers that look at nothing, which may earn little. On a
    terminal, standard error shows the progress.

    `details`: print the solution's margins and the rubric's sensitivity as well.
    """
    examinations: dict[str, Examination] = {}
    blind: dict[str, list[Finding]] = {}
    with Slot(SlotConfig()) as slot, closing(followed(list(assignment_ids))) as under_way:
        for assignment_id in under_way:
            examinations[assignment_id] = examine(catalog, assignment_id, slot, sensitive=details)
            if looks(catalog.get(assignment_id)):
                blind[assignment_id] = _blindly(catalog, assignment_id, slot)
    findings = [finding for each in examinations.values() for finding in each.findings]
    console().print(_scores(findings, language))
    for note in unusual_totals(findings):
        console().print(styled.Text(note.get(language)))
    for assignment_id, examination in examinations.items():
        if examination.idle:
            console().print(styled.Text(_idle(catalog, assignment_id, examination.idle).get(language)))
    if blind:
        console().print(_blind_table(blind, language))
    if details:
        for assignment_id, examination in examinations.items():
            _print_details(assignment_id, examination, language)
    findings += [finding for each in blind.values() for finding in each]
    return 1 if any(finding.problem != EMPTY for finding in findings) else 0


def _blindly(catalog: Catalog, assignment_id: str, grader: Grader) -> list[Finding]:
    assignment = catalog.get(assignment_id)
    file = catalog.own_file(assignment, "solution")
    solution = OwnScript(name=file.name, source=handed_in(file))
    return driven_blindly(assignment, solution, grader, catalog.with_seeds(_SHIFT).get(assignment_id))


def _scores(findings: Iterable[Finding], language: Language) -> Table:
    """Return what each of the assignments' own files scored."""
    table = _table(language, EMPTY, _ASSIGNMENT, _SCRIPT, _SCORE, _PROBLEM)
    for finding in findings:
        table.add_row(
            "✗" if finding.problem != EMPTY else "✓",
            finding.assignment,
            finding.script,
            f"{'—' if finding.score is None else written(finding.score)}/{written(finding.max_score)}",
            styled.Text(finding.problem.get(language), style="red"),
        )
    return table


def _blind_table(blind: Mapping[str, Sequence[Finding]], language: Language) -> Table:
    """Return what each driver that looks at nothing earned, a row for each, a column for each exercise."""
    table = _table(language, _DRIVER, *(Text(zh=text, en=text) for text in blind))
    scores = {
        (assignment_id, finding.script): finding
        for assignment_id, findings in blind.items()
        for finding in findings
    }
    for driver in dict.fromkeys(driver for _, driver in scores):
        cells = (scores.get((assignment_id, driver)) for assignment_id in blind)
        table.add_row(driver, *map(_cell, cells))
    return table


def _cell(finding: Finding | None) -> styled.Text:
    if finding is None or finding.score is None:
        return styled.Text(NOTHING)
    is_paid = finding.problem != EMPTY
    return styled.Text(f"{'✗ ' if is_paid else ''}{written(finding.score)}", style="red" if is_paid else "")


def _idle(catalog: Catalog, assignment_id: str, places: tuple[str, ...]) -> Text:
    """Say which expectations no wrong attempt fails: they may test nothing."""
    lines = ", ".join(
        catalog.place(assignment_id, place).rpartition("assignment.yaml:")[2] for place in places
    )
    return Text(
        zh=f"{assignment_id}：这些期望没有一个错误程序不满足，可能什么也没查（行号：字段）：{lines}",
        en=f"{assignment_id}: no wrong attempt fails these expectations, so they may test nothing: {lines}",
    )


def write_scripts(catalog: Catalog, assignment_ids: Iterable[str], folder: Path) -> None:
    """Write all scripts of the assignments, also those that are changes of others, to folders called by the ids.

    Raises GraderError: an assignment cannot be read, or a script cannot be written.
    """
    for assignment_id in assignment_ids:
        for name, source in catalog.scripts(assignment_id).items():
            path = folder / assignment_id / name
            try:
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_bytes(source)
            except OSError as error:
                raise file_error("output_file", str(path), error) from error


def unusual_totals(findings: Iterable[Finding]) -> list[Text]:
    """Return a sentence for each assignment whose items do not add up to 100 points: allowed, but often a slip."""
    totals = {finding.assignment: finding.max_score for finding in findings}
    return [
        Text(
            zh=f"{assignment}：各评分项一共 {written(total)} 分，不是 100 分",
            en=f"{assignment}: the items add up to {written(total)} points, not to 100",
        )
        for assignment, total in totals.items()
        if total != _USUAL_TOTAL
    ]


def validate_seeds(catalog: Catalog, assignment_ids: Iterable[str], language: Language, seeds: int) -> int:
    """Grade the files of the assignments with `seeds` seeds; return 0 when all scores are as expected.

    With each seed they are graded twice, once with a Ctrl+C that comes up to 4 s later. A row has the lowest and
    the highest score of a script, and the first seed that makes a problem, or that its score changes.
    """
    table = _table(language, EMPTY, _ASSIGNMENT, _SCRIPT, _SCORE, _PROBLEM)
    failed = False
    with Slot(SlotConfig()) as slot, closing(followed(list(assignment_ids))) as under_way:
        for assignment_id in under_way:
            scores: dict[str, list[float]] = {}
            problems: dict[str, str] = {}
            for shift in range(seeds):
                shifted = catalog.with_seeds(100 * shift)
                for finding in examine(shifted, assignment_id, slot).findings:
                    scores.setdefault(finding.script, []).append(finding.score or 0.0)
                    if finding.problem != EMPTY:
                        problems.setdefault(
                            finding.script, f"seed +{100 * shift}: {finding.problem.get(language)}"
                        )
                later_s = _LATER_S * (shift + 1) / seeds
                for finding in examine(shifted, assignment_id, slot, later_s=later_s).findings:
                    scores[finding.script].append(finding.score or 0.0)
            for script, found in scores.items():
                low, high = written(min(found)), written(max(found))
                problem = problems.get(script, "")
                luck = _LUCK.get(language) if low != high else ""
                table.add_row(
                    "✗" if problem else "✓",
                    assignment_id,
                    script,
                    f"{low} - {high}",
                    styled.Text(problem, style="red") if problem else styled.Text(luck, style="yellow"),
                )
            failed |= bool(problems)
    console().print(table)
    return 1 if failed else 0


def fitting(catalog: Catalog, assignment_id: str) -> Assignment:
    """Return an assignment that fits its check.

    Raises:
        UnknownAssignmentError: no assignment has that id.
        AssignmentError: it does not fit, or its file is wrong; the message names file, line, field and fix.
    """
    assignment = catalog.get(assignment_id)
    misfits = [(catalog.place(assignment_id, field), told) for field, told in check_problems(assignment)]
    if misfits:
        raise refusals(misfits)
    return assignment


def examine(
    catalog: Catalog, assignment_id: str, grader: Grader, *, sensitive: bool = False, later_s: float = 0.0
) -> Examination:
    """Examine one assignment of a folder (`grader.grading.examination`); record what its solution drives.

    `later_s`: by how much Ctrl+C comes later than the assignment says, unless it talks to the script by the clock.

    Raises GraderError: the assignment cannot be read, or the grader failed.
    """
    record_reference(catalog, assignment_id, grader)
    assignment, attempts = fitting(catalog, assignment_id), catalog.wrong_attempts(assignment_id)
    if not assignment.steps and not any(item.expect for item in assignment.items):
        assignment = replace(assignment, horizon_s=assignment.horizon_s + later_s)
    own = own_scripts(assignment, attempts, catalog.scripts(assignment_id))
    return examine_scripts(own, grader, sensitive=sensitive)


def record_reference(catalog: Catalog, assignment_id: str, grader: Grader) -> None:
    """Run the solution of an assignment that wants what it drives, unless that is recorded already.

    Raises GraderError: the solution hardly drives, it cannot be recorded, or the grader failed.
    """
    assignment = catalog.get(assignment_id)
    if not wants_reference(assignment):
        return
    solution = catalog.own_file(assignment, "solution")
    trace = traced(assignment, str(solution), handed_in(solution), grader)
    try:
        record(solution.parent, trace)
    except OSError as error:
        raise AssignmentError.about(solution.parent, trouble(error)) from error


def _table(language: Language, *headings: Text) -> Table:
    table = Table(box=None)
    for heading in headings:
        table.add_column(heading.get(language), overflow="fold")
    return table


def _print_details(assignment_id: str, examination: Examination, language: Language) -> None:
    table = _table(language, _ITEM, _SOLUTION, _MARGIN)
    for margin in examination.margins:
        table.add_row(
            margin.item, *(number(value, margin.unit, 3) for value in (margin.measured, margin.margin))
        )
    console().print(f"\n{assignment_id}{_INSIDE.get(language)}", table)
    for case, sensitivity in examination.sensitivity.items():
        if sensitivity:
            where = f" ({case})" if len(examination.sensitivity) > 1 else ""
            console().print(
                f"\n{assignment_id}{where}{_WHICH_COSTS.get(language)}", _costs(sensitivity, language)
            )


def _costs(found: Sequence[Sensitivity], language: Language) -> Table:
    """Return a row for each error and item; the error is named in its first row only."""
    headings = (_LESS_COSTS, _LESS_LEAVES_NOTHING, _MORE_COSTS, _MORE_LEAVES_NOTHING)
    table = _table(language, _ERROR_IN, _ITEM, *headings)
    sizes: dict[tuple[str, str], dict[bool, Sensitivity]] = {}
    for finding in found:
        sizes.setdefault((finding.perturbation.name.get(language), finding.item), {})[
            finding.starts > 0.0
        ] = finding
    named = ""
    for (name, item), by_sign in sizes.items():
        cells = [cell for more in (False, True) for cell in _sizes(by_sign.get(more))]
        table.add_row("" if name == named else name, item, *cells)
        named = name
    return table


def _sizes(found: Sensitivity | None) -> tuple[str, str]:
    """Return from which error on points are lost, and from which on all are."""
    if found is None:
        return NOTHING, NOTHING
    full, unit = found.perturbation.full, found.perturbation.unit
    starts, zero = (
        NOTHING if error is None else number(abs(error) * full, unit, 0)
        for error in (found.starts, found.zero)
    )
    return starts, zero
