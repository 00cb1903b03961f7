"""Measures of the files of a package, which every check adds when a package was handed in."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

from grader.checks.measure import Check, Measure, MeasureKind, Measures, Mistake, mistake
from grader.contracts.assignment import Assignment
from grader.contracts.outcome import RunStatus
from grader.contracts.package import AREAS
from grader.contracts.scoring import Run
from grader.messages import say

MEASURES = {area: MeasureKind(form="flag", of="package") for area in AREAS}


def with_package(check: Check, assignment: Assignment) -> Check:
    """Return the check with the measures of packages, if the assignment takes packages."""
    if assignment.input != "package":
        return check
    return replace(check, measures={**check.measures, **MEASURES})


def package_measures(run: Run) -> Measures:
    """Return what is measured of a package's files; nothing of a script."""
    if run.package is None:
        return {}
    spoilt = {problem.area for problem in run.package}
    return {area: Measure(float(area not in spoilt)) for area in AREAS}


def with_package_mistakes(check: Check, mistakes: Sequence[Mistake], run: Run) -> tuple[Mistake, ...]:
    """Return the mistakes behind what is wrong with the package's files, from which they may follow."""
    if run.package is None:
        return tuple(mistakes)
    driven = tuple(name for name in check.measures if name not in MEASURES)
    own = (
        mistake(problem.code, (problem.area, *(driven if problem.fatal else ())), **problem.values)
        for problem in run.package
    )
    return (*own, *_placed(mistakes, run))


def _placed(mistakes: Sequence[Mistake], run: Run) -> Iterator[Mistake]:
    """Yield the mistakes; the one that ended the run names its file."""
    error = run.outcome.error
    has_place = run.outcome.status is RunStatus.CRASHED and error is not None and error.file
    for number, each in enumerate(mistakes):
        if number or error is None or not has_place:
            yield each
        elif each.code == "missing_module":  # whose text speaks of the one file that is handed in otherwise
            package = (*error.file.split("/"), "")[1]
            values = {"file": error.file, "line": error.line, "problem": error.message, "package": package}
            yield replace(each, text=say("package.missing_module", **values))
        else:
            yield replace(each, text=say("package.in_file", file=error.file, said=each.text))
