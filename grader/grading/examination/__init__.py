"""Examining an assignment by its own scripts: the solution gets full marks, wrong scripts what they must get.

The scripts come as data: of a folder of the operator's by `grader assignments validate`, of an upload from the
database. Whoever grades them confines them as it confines students' scripts.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from grader.checks import problems as check_problems
from grader.contracts.assignment import SUFFIXES, Assignment, ItemSpec, WrongAttempt
from grader.contracts.grading import Grader, GradingJob, GradingResult
from grader.contracts.notation import written
from grader.contracts.report import GradeReport, GradeStatus
from grader.contracts.rubric import ItemStatus, RubricItem, Unit
from grader.contracts.scoring import Run
from grader.contracts.text import EMPTY, Text
from grader.contracts.trajectory import decode_trajectory
from grader.grading.examination.reference import wants_reference
from grader.grading.examination.sensitivity import Sensitivity, lax, replayable, sensitivities
from grader.messages import join

_AND = Text(zh="；", en="; ")
_BECAUSE = Text(zh="。", en=". ")
_GIFT = Text(zh="起始文件已经满分", en="the starter already has full marks")


@dataclass(frozen=True, slots=True, kw_only=True)
class OwnScript:
    """One of an assignment's own files."""

    name: str
    source: bytes


@dataclass(frozen=True, slots=True, kw_only=True)
class OwnScripts:
    """An assignment with the files that it is examined by; `wrong` with the verdict that each must get."""

    assignment: Assignment
    solution: OwnScript
    starter: OwnScript
    wrong: tuple[tuple[WrongAttempt, OwnScript], ...]


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
    unit: Unit


@dataclass(frozen=True, slots=True, kw_only=True)
class Examination:
    """All that is known about one assignment.

    Attributes:
        idle: expectations that no wrong file shows to test anything, such as ``items.2.expect.0``.
        sensitivity: by case; without those where the solution's motion cannot be driven again without its script.
    """

    findings: list[Finding]
    margins: list[Margin] = field(default_factory=list)
    sensitivity: dict[str, list[Sensitivity]] = field(default_factory=dict)
    idle: tuple[str, ...] = ()


def own_scripts(
    assignment: Assignment, attempts: Iterable[WrongAttempt], scripts: Mapping[str, bytes]
) -> OwnScripts:
    """Return an assignment with its `scripts`, given by their paths in its folder."""
    names = [own + SUFFIXES[assignment.input][0] for own in ("solution", "starter")]
    solution, starter = (OwnScript(name=name, source=scripts[name]) for name in names)
    wrong = tuple(
        (attempt, OwnScript(name=attempt.file, source=scripts[f"wrong/{attempt.file}"]))
        for attempt in attempts
    )
    return OwnScripts(assignment=assignment, solution=solution, starter=starter, wrong=wrong)


def examine(
    own: OwnScripts,
    grader: Grader,
    *,
    sensitive: bool = False,
    before_each: Callable[[], None] = lambda: None,
) -> Examination:
    """Grade the solution, the starter and every wrong file of one assignment.

    `sensitive`: also find out from which error on each item loses credit (a few seconds). `before_each` is called
    before each file is graded; what it raises ends the examination.

    Raises GraderError: the grader failed.
    """
    assignment, solution_file = own.assignment, own.solution
    before_each()
    solution = grader.grade(_job(assignment, solution_file))
    report = solution.report
    runs = _replayable_runs(assignment, solution)
    problems = [] if _all_passed(report) else [_lost(report)]
    problems += _lax(assignment, runs)
    findings = [_finding(assignment, solution_file.name, report, join(problems, _AND))]
    before_each()
    starter = grader.grade(_job(assignment, own.starter)).report
    gift = _GIFT if _all_passed(starter) else EMPTY
    findings.append(_finding(assignment, own.starter.name, starter, gift))
    idle = set(_expectations(assignment))
    for attempt, script in own.wrong:
        before_each()
        graded = grader.grade(_job(assignment, script))
        idle -= _proven(assignment, attempt, graded.unmet)
        problem = _unexpected(attempt, graded.report)
        findings.append(_finding(assignment, f"wrong/{attempt.file}", graded.report, problem))
    return Examination(
        findings=findings,
        margins=margins(assignment, report),
        idle=tuple(sorted(idle)),
        sensitivity={run.case: sensitivities(assignment, run) for run in runs} if sensitive else {},
    )


def _expectations(assignment: Assignment) -> Iterator[str]:
    """Yield the places of all that items expect."""
    for i, item in enumerate(assignment.items):
        yield from (f"items.{i}.expect.{k}" for k in range(len(item.expect)))


def _proven(assignment: Assignment, attempt: WrongAttempt, unmet: Sequence[str]) -> set[str]:
    """Return the expectations that a wrong attempt shows to test something.

    One that meets no expectation at all shows that only of the item which it is there for.
    """
    if len(unmet) < len(set(_expectations(assignment))):
        return set(unmet)
    item = next(i for i, item in enumerate(assignment.items) if item.id == attempt.fails)
    return {place for place in unmet if place.startswith(f"items.{item}.")}


def misfits(assignment: Assignment) -> list[tuple[str, Text]]:
    """Return which fields do not fit the assignment's check, and why; not that its solution was never recorded."""
    if wants_reference(assignment):
        return []
    return list(check_problems(assignment))


def _job(assignment: Assignment, script: OwnScript) -> GradingJob:
    return GradingJob(file_name=script.name, source=script.source, assignment=assignment)


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
    if assignment.steps:
        return []
    runs = [
        Run(
            trajectory=decode_trajectory(solution.trajectories[run.case]),
            outcome=run.outcome,
            case=run.case,
        )
        for run in solution.report.runs
    ]
    # a script that hears something may steer by it: an error in its commands would have been corrected
    return [run for run in runs if not run.outcome.hears and replayable(assignment, run)]


def _lax(assignment: Assignment, runs: list[Run]) -> Iterator[Text]:
    """Yield the lax items of each case, after the name of the case when there are several."""
    for run in runs:
        several = len(assignment.cases) > 1
        where = Text(zh=f"场景 {run.case}：", en=f"case {run.case}: ") if several else EMPTY
        for problem in lax(assignment, run):
            yield join([where, problem], EMPTY)


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
    """Say what the solution loses points for, and what its author would be told first."""
    items = ", ".join(item.id for item in report.items if item.status is not ItemStatus.PASSED)
    text = Text(zh=f"误扣：答案在 {items} 上丢分", en=f"false fail: loses credit for {items}")
    return text if report.hint == EMPTY else join([text, report.hint], _BECAUSE)


def _earned(report: GradeReport) -> str:
    """Return what each item earned, by its id."""
    return ", ".join(f"{item.id} {written(item.earned)}/{written(item.points)}" for item in report.items)


def _unexpected(attempt: WrongAttempt, report: GradeReport) -> Text:
    score = report.score or 0.0
    problems = []
    if report.score == report.max_score:
        problems.append(Text(zh="误给：得了满分", en="false pass: full marks"))
    elif not attempt.low <= score <= attempt.high:
        band = f"[{written(attempt.low)}, {written(attempt.high)}]"
        problems.append(
            Text(
                zh=f"得分 {written(score)} 不在 {band} 内（{_earned(report)}）",
                en=f"score {written(score)} is outside {band} ({_earned(report)})",
            )
        )
    lost = [_plain(item) for item in report.items if item.status in (ItemStatus.FAILED, ItemStatus.PARTIAL)]
    unchecked = [_plain(item) for item in report.items if item.status is ItemStatus.NOT_CHECKED]
    if attempt.fails in unchecked and attempt.fails not in lost:
        ids = ", ".join(lost)
        zh = f"评分项 {attempt.fails} 没有检查，因为它需要的评分项先丢了分：fails 写 {ids} 中的一个"
        en = f"item {attempt.fails} is not checked, as one that it needs failed: name that in fails ({ids})"
        problems.append(Text(zh=zh, en=en))
    elif attempt.fails not in lost:
        problems.append(Text(zh=f"评分项 {attempt.fails} 没有丢分", en=f"item {attempt.fails} loses nothing"))
    if attempt.mistake and attempt.mistake not in report.mistakes[:1]:
        codes = ", ".join(report.mistakes)
        problems.append(
            Text(
                zh=f"认出的错误是 {codes or '（无）'}，应当是 {attempt.mistake}",
                en=f"recognised {codes or 'nothing'} instead of {attempt.mistake}",
            )
        )
    return join(problems, _AND)
