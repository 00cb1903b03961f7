"""Whether an assignment fits its check: what is wrong with which field, in both languages."""

from collections.abc import Collection, Iterator, Mapping
from typing import TypeGuard

from grader.checks.measure import Check, Kind, Option, Options
from grader.contracts.assignment import BY_PERSON, Assignment
from grader.contracts.text import Text
from grader.messages.quantity import is_unit

_NO_PACKAGE = Text(
    zh="只有 `input: package` 才用得上：删掉，或者改写 input",
    en="only `input: package` uses this; remove it, or change the input",
)


Misfit = tuple[str, Text]
"""A field (``items.2.measure``), and what is wrong with it and what to do."""


def misfits(assignment: Assignment, check: Kind) -> Iterator[Misfit]:
    """Yield all that does not fit `check`."""
    wanted = ("script", "package") if isinstance(check, Check) else ("text",)
    if assignment.input not in wanted:
        yield "input", _other_input(check, wanted[0])
    if assignment.package is not None and assignment.input != "package":
        yield "package", _NO_PACKAGE
    for i, case in enumerate(assignment.cases):
        options = {**assignment.options, **case.options}
        where = "options" if not case.options else f"cases.{i}.options"
        yield from _in_options(check, options, where)
    for i, item in enumerate(assignment.items):
        if item.measure in check.measures:
            unit = check.measures[item.measure].unit
            if not is_unit(unit):
                yield f"items.{i}.measure", _no_unit(check, item.measure, unit)
        elif item.measure != BY_PERSON:
            yield f"items.{i}.measure", _no_measure(check, item.measure)
    yield from _unlooked_at(assignment, check)
    yield from check.consult(assignment)


def is_number(value: object) -> TypeGuard[int | float]:
    """Whether a value is a number; true and false are none."""
    return isinstance(value, int | float) and not isinstance(value, bool)


def unmet(assignment: Assignment, *needs: tuple[Collection[str], bool, Text]) -> Iterator[Misfit]:
    """Yield the items whose measures need what is not there. A need: measures, whether it is met, what to say."""
    for i, item in enumerate(assignment.items):
        for measures, is_met, told in needs:
            if item.measure in measures and not is_met:
                yield f"items.{i}.measure", told


def _unlooked_at(assignment: Assignment, check: Kind) -> Iterator[Misfit]:
    """Yield what the assignment gives for another kind of check."""
    if assignment.answers and "correct" not in check.measures:
        yield "answers", _unused(check, "number", zh="不比较数值", en="compares no numbers")
    if assignment.path is not None and check.kind != "path":
        yield "path", _unused(check, "path", zh="不看路径", en="looks at no path")
    if assignment.places is not None and check.kind != "places":
        yield "places", _unused(check, "places", zh="不看地点", en="looks at no places")


def _in_options(check: Kind, options: Mapping[str, Option], where: str) -> Iterator[Misfit]:
    known: Options = {**check.options, **check.optional}
    for name in options:
        if name not in known:
            yield f"{where}.{name}", _no_option(check, known)
    for name, problem_with in known.items():
        if name in options:
            if (problem := problem_with(options[name])) is not None:
                yield f"{where}.{name}", problem
        elif name in check.options:
            yield f"{where}.{name}", _missing(check)


def _other_input(check: Kind, wanted: str) -> Text:
    return Text(
        zh=f"检查 {check.kind!r} 要写 `input: {wanted}`",
        en=f"the check {check.kind!r} scores a {wanted}; write `input: {wanted}`",
    )


def _no_measure(check: Kind, name: str) -> Text:
    known = ", ".join((*check.measures, BY_PERSON))
    return Text(
        zh=f"检查 {check.kind!r} 没有测量值 {name!r}，可用：{known}",
        en=f"{name!r} is no measure of {check.kind!r}; use one of {known}",
    )


def _no_unit(check: Kind, name: str, unit: object) -> Text:
    return Text(
        zh=f"检查 {check.kind!r} 的测量值 {name!r} 用了未知的单位 {unit!r}：在检查的代码里改正",
        en=f"the check {check.kind!r} has {name!r} in the unknown unit {unit!r}; correct it in the check's code",
    )


def _unused(check: Kind, other: str, *, zh: str, en: str) -> Text:
    return Text(
        zh=f"检查 {check.kind!r} {zh}：删掉，或者改用 {other!r}",
        en=f"the check {check.kind!r} {en}; remove this or use {other!r}",
    )


def _no_option(check: Kind, known: Options) -> Text:
    if not known:
        return Text(
            zh=f"检查 {check.kind!r} 没有选项：请删掉",
            en=f"the check {check.kind!r} has no options; remove it",
        )
    names = ", ".join(known)
    return Text(
        zh=f"检查 {check.kind!r} 没有这个选项，只有：{names}",
        en=f"the check {check.kind!r} has only the options {names}; correct it or remove it",
    )


def _missing(check: Kind) -> Text:
    return Text(
        zh=f"缺少：检查 {check.kind!r} 需要它，请加上",
        en=f"missing; the check {check.kind!r} needs it: add it",
    )
