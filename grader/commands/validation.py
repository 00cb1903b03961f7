"""Check assignments by their own files: solutions get full marks, wrong scripts the scores they must get."""

from collections.abc import Iterable, Iterator
from contextlib import closing
from dataclasses import dataclass, field

from rich import text as styled
from rich.table import Table

from grader.catalog import Catalog
from grader.catalog.misfits import refusals
from grader.checks import problems as check_problems
from grader.commands.reference import record_reference
from grader.commands.sensitivity import Sensitivity, lax, replayable, sensitivities
from grader.contracts.assignment import Assignment, ItemSpec, WrongAttempt
from grader.contracts.grading import Grader, GradingJob, GradingResult
from grader.contracts.notation import written
from grader.contracts.report import GradeReport, GradeStatus
from grader.contracts.rubric import ItemStatus, RubricItem
from grader.contracts.scoring import Run
from grader.contracts.text import EMPTY, Language, Text
from grader.contracts.trajectory import decode_trajectory
from grader.grading.slot import Slot, SlotConfig
from grader.messages import join
from grader.render.progress import followed
from grader.render.terminal import console

_AND = Text(zh="；", en="; ")
_GIFT = Text(zh="起始文件已经满分", en="the starter already has full marks")
_ASSIGNMENT = Text(zh="作业", en="assignment")
_SCRIPT = Text(zh="脚本", en="script")
_SCORE = Text(zh="得分", en="score")
_PROBLEM = Text(zh="问题", en="problem")
_ITEM = Text(zh="评分项", en="item")
_SOLUTION = Text(zh="答案", en="solution")
_MARGIN = Text(zh="余量", en="margin")
_INSIDE = Text(zh="：答案离满分范围的边还有多远", en=": how far the solution lies inside each band")
_ERROR_IN = Text(zh="哪里有误差", en="error in")
_COSTS = Text(zh="开始扣分", en="costs from")
_NOTHING_LEFT = Text(zh="扣完", en="nothing left at")
_WHICH_COSTS = Text(zh="：答案的动作差多少就扣多少", en=": which error in the solution's motion costs what")


@dataclass(frozen=True, slots=True, kw_only=True)
class Finding:
    """What one of an assignment's own files scored. `problem` is `EMPTY` when the score is as expected.

    Attributes:
        score: None while a person has still to grade.
    """

    assignment: str
    script: str
    score: float | None
    max_score: float
    problem: Text


@dataclass(frozen=True, slots=True, kw_only=True)
class Margin:
    """How far the solution's measure lies inside its band of full credit; negative outside."""

    item: str
    measured: float
    margin: float
    unit: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Examination:
    """All that is known about one assignment.

    Attributes:
        sensitivity: by case; without those where the solution's motion cannot be driven again without its script.
    """

    findings: list[Finding]
    margins: list[Margin] = field(default_factory=list)
    sensitivity: dict[str, list[Sensitivity]] = field(default_factory=dict)


def validate(
    catalog: Catalog, assignment_ids: Iterable[str], language: Language, *, details: bool = False
) -> int:
    """Grade the files of the assignments and print their scores; return 0 when all are as expected.

    On a terminal, standard error shows the progress.

    Args:
        catalog: where the assignments are.
        assignment_ids: those to look at.
        language: of what is printed.
        details: print the solution's margins and the rubric's sensitivity as well.
    """
    table = _table(language, EMPTY, _ASSIGNMENT, _SCRIPT, _SCORE, _PROBLEM)
    examinations: dict[str, Examination] = {}
    with Slot(SlotConfig()) as slot, closing(followed(list(assignment_ids))) as under_way:
        for assignment_id in under_way:
            examinations[assignment_id] = examine(catalog, assignment_id, slot, sensitive=details)
    findings = [finding for each in examinations.values() for finding in each.findings]
    for finding in findings:
        table.add_row(
            "✗" if finding.problem != EMPTY else "✓",
            finding.assignment,
            finding.script,
            f"{'—' if finding.score is None else written(finding.score)}/{written(finding.max_score)}",
            styled.Text(finding.problem.get(language), style="red"),
        )
    console().print(table)
    if details:
        for assignment_id, examination in examinations.items():
            _print_details(assignment_id, examination, language)
    return 1 if any(finding.problem != EMPTY for finding in findings) else 0


def fitting(catalog: Catalog, assignment_id: str) -> Assignment:
    """Return an assignment that fits its check.

    Raises:
        UnknownAssignmentError: no assignment has that id.
        AssignmentError: it does not fit, or its file is wrong; the message names file, line, field and fix.
    """
    assignment = catalog.get(assignment_id)
    found = [(catalog.place(assignment_id, field), told) for field, told in check_problems(assignment)]
    if found:
        raise refusals(found)
    return assignment


def examine(catalog: Catalog, assignment_id: str, grader: Grader, *, sensitive: bool = False) -> Examination:
    """Grade the solution, the starter and every wrong file of one assignment.

    Args:
        catalog: where the assignment is.
        assignment_id: its id.
        grader: grades the files.
        sensitive: also find out from which error on each item loses credit (a few seconds).

    Raises:
        GraderError: the assignment cannot be read, or the grader failed.
    """
    record_reference(catalog, assignment_id, grader)
    assignment = fitting(catalog, assignment_id)
    path = catalog.own_file(assignment, "solution")
    job = GradingJob(file_name=path.name, source=path.read_bytes(), assignment=assignment)
    solution = grader.grade(job)
    report = solution.report
    runs = _replayable_runs(assignment, solution)
    problems = [] if _all_passed(report) else [_lost(report)]
    problems += _lax(assignment, runs)
    findings = [_finding(assignment, path.name, report, join(problems, _AND))]
    findings += _others(catalog, assignment, grader)
    return Examination(
        findings=findings,
        margins=margins(assignment, report),
        sensitivity={run.case: sensitivities(assignment, run) for run in runs} if sensitive else {},
    )


def margins(assignment: Assignment, report: GradeReport) -> list[Margin]:
    """Return how far each measured item of `report` lies from the nearest edge of its band."""
    specs = {spec.id: spec for spec in assignment.items}
    return [
        Margin(
            item=item.id,
            measured=item.measured,
            margin=_margin(specs[_plain(item)], item.measured),
            unit=item.unit,
        )
        for item in report.items
        if item.measured is not None
    ]


def _margin(spec: ItemSpec, measured: float) -> float:
    edges = []
    if spec.low is not None:
        edges.append(measured - spec.low)
    if spec.high is not None:
        edges.append(spec.high - measured)
    return min(edges)


def _plain(item: RubricItem) -> str:
    """Return an item's id without its case."""
    return item.id.rpartition("/")[2]


def _replayable_runs(assignment: Assignment, solution: GradingResult) -> list[Run]:
    """Return the solution's runs whose commands alone determine the motion: without feedback and services."""
    if assignment.calls:
        return []
    runs = [
        Run(
            trajectory=decode_trajectory(solution.trajectories[run.case]),
            outcome=run.outcome,
            case=run.case,
        )
        for run in solution.report.runs
    ]
    return [run for run in runs if not _listens(run) and replayable(assignment, run)]


def _listens(run: Run) -> bool:
    """Whether the script may have steered by what it heard: an error in its commands would have been corrected."""
    return any(each.kind == "subscription" for each in run.outcome.endpoints)


def _lax(assignment: Assignment, runs: list[Run]) -> Iterator[Text]:
    """Yield the lax items of each case, after the name of the case when there are several."""
    for run in runs:
        several = len(assignment.cases) > 1
        where = Text(zh=f"场景 {run.case}：", en=f"case {run.case}: ") if several else EMPTY
        for problem in lax(assignment, run):
            yield join([where, problem], EMPTY)


def _others(catalog: Catalog, assignment: Assignment, grader: Grader) -> Iterator[Finding]:
    path = catalog.own_file(assignment, "starter")
    job = GradingJob(file_name=path.name, source=path.read_bytes(), assignment=assignment)
    starter = grader.grade(job).report
    gift = _GIFT if _all_passed(starter) else EMPTY
    yield _finding(assignment, path.name, starter, gift)
    for attempt in catalog.wrong_attempts(assignment.id):
        path = catalog.folder(assignment.id) / "wrong" / attempt.file
        job = GradingJob(file_name=path.name, source=path.read_bytes(), assignment=assignment)
        report = grader.grade(job).report
        yield _finding(assignment, f"wrong/{attempt.file}", report, _unexpected(attempt, report))


def _all_passed(report: GradeReport) -> bool:
    """Whether no points were lost; points that a person has still to give are not lost."""
    if report.status is GradeStatus.NEEDS_MANUAL:
        return all(item.status is not ItemStatus.FAILED for item in report.items)
    return report.score == report.max_score


def _finding(assignment: Assignment, script: str, report: GradeReport, problem: Text) -> Finding:
    return Finding(
        assignment=assignment.id,
        script=script,
        score=report.score,
        max_score=report.max_score,
        problem=problem,
    )


def _lost(report: GradeReport) -> Text:
    items = ", ".join(item.id for item in report.items if item.status is not ItemStatus.PASSED)
    return Text(zh=f"误扣：答案在 {items} 上丢分", en=f"false fail: loses credit for {items}")


def _unexpected(attempt: WrongAttempt, report: GradeReport) -> Text:
    score = report.score or 0.0
    problems = []
    if report.score == report.max_score:
        problems.append(Text(zh="误给：得了满分", en="false pass: full marks"))
    elif not attempt.low <= score <= attempt.high:
        band = f"[{written(attempt.low)}, {written(attempt.high)}]"
        problems.append(
            Text(zh=f"得分 {written(score)} 不在 {band} 内", en=f"score {written(score)} is outside {band}")
        )
    lost = (item for item in report.items if item.status in (ItemStatus.FAILED, ItemStatus.PARTIAL))
    if attempt.fails not in [_plain(item) for item in lost]:
        problems.append(Text(zh=f"评分项 {attempt.fails} 没有丢分", en=f"item {attempt.fails} loses nothing"))
    if attempt.mistake and attempt.mistake not in report.mistakes[:1]:
        seen = ", ".join(report.mistakes)
        problems.append(
            Text(
                zh=f"认出的错误是 {seen or '（无）'}，应当是 {attempt.mistake}",
                en=f"recognised {seen or 'nothing'} instead of {attempt.mistake}",
            )
        )
    return join(problems, _AND)


def _table(language: Language, *headings: Text) -> Table:
    table = Table(box=None)
    for heading in headings:
        table.add_column(heading.get(language), overflow="fold")
    return table


def _print_details(assignment_id: str, examination: Examination, language: Language) -> None:
    table = _table(language, _ITEM, _SOLUTION, _MARGIN)
    for each in examination.margins:
        table.add_row(each.item, f"{each.measured:g} {each.unit}", f"{each.margin:.3g} {each.unit}")
    console().print(f"\n{assignment_id}{_INSIDE.get(language)}", table)
    for case, found_ones in examination.sensitivity.items():
        table = _table(language, _ERROR_IN, _ITEM, _COSTS, _NOTHING_LEFT)
        for found in found_ones:
            name = found.perturbation.name.get(language)
            table.add_row(name, found.item, _size(found, found.starts), _size(found, found.zero))
        where = f" ({case})" if len(examination.sensitivity) > 1 else ""
        console().print(f"\n{assignment_id}{where}{_WHICH_COSTS.get(language)}", table)


def _size(found: Sensitivity, error: float | None) -> str:
    if error is None:
        return "—"
    return f"{error * found.perturbation.full:+.0f} {found.perturbation.unit}"
