"""What a check is made of: named measures, options, and findings in one run."""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Literal

from grader.contracts.assignment import Assignment
from grader.contracts.figure import FigureSketch
from grader.contracts.record import Record, field
from grader.contracts.rubric import Unit
from grader.contracts.scoring import Run
from grader.contracts.text import Text
from grader.messages import say

Option = float | int | str | bool
Form = Literal["quantity", "count", "flag"]
Options = Mapping[str, Callable[[Option], Text | None]]
"""Names of options, with what is wrong about a value (or None)."""


class MeasureKind(Record, kw_only=False):
    """A quantity that a check computes. Its texts are the messages ``<check>.<name>.{name,seen,hint}``.

    Attributes:
        unit: of its values; empty for counts and flags.
        form: how it reads: a number with a unit, a whole number, or yes (1) and no (0).
        of: what its texts begin with instead of the check's kind, where several checks have it.
        text: what they begin with instead of kind and name, where several measures have it.
    """

    unit: Unit = ""
    form: Form = "quantity"
    of: str = ""
    text: str = ""


class Measure(Record, kw_only=False):
    """A measured value. NaN: could not be measured; ``why`` among the details may say what kept it from that.

    `details` fill the ``seen`` sentence. `share` of the value's credit counts; what lowers it is ``why``.
    """

    value: float
    details: Mapping[str, object] = field(default_factory=dict)
    share: float = 1.0


UNMEASURED = Measure(math.nan)

Measures = Mapping[str, Measure]
"""What a check measured in one run, by name. A measure that is absent could not be taken."""


class Mistake(Record, kw_only=False):
    """A recognised mistake.

    Attributes:
        code: stable name; its text is the message ``mistake.<code>``.
        text: what probably happened and the one next step.
        measures: names of the measures it spoils; their items show this text as hint. Empty: all.
    """

    code: str
    text: Text
    measures: tuple[str, ...] = ()

    def explains(self, measure: str) -> bool:
        """Whether an item on `measure` may have failed because of this."""
        return not self.measures or measure in self.measures


def mistake(code: str, measures: tuple[str, ...] = (), /, **values: object) -> Mistake:
    """Return a mistake that spoils `measures`; `values` are what its text names."""
    return Mistake(code, say(f"mistake.{code}", **values), measures)


def first_causes(mistakes: Sequence[Mistake]) -> tuple[Mistake, ...]:
    """Leave out what spoils nothing that an earlier mistake has not spoilt: it follows from that one."""
    kept: list[Mistake] = []
    for each in mistakes:
        if not any(_follows(each, cause) for cause in kept):
            kept.append(each)
    return tuple(kept)


def _follows(later: Mistake, cause: Mistake) -> bool:
    if not cause.measures:
        return True
    return bool(later.measures) and set(later.measures) <= set(cause.measures)


class Findings(Record, kw_only=False):
    """What was measured in one run, and what explains it. `mistakes`: most likely first."""

    measures: Measures = field(default_factory=dict)
    mistakes: tuple[Mistake, ...] = ()


def one_of(names: Iterable[str]) -> Text:
    """Return what is wrong about a value that is none of `names`."""
    known = ", ".join(names)
    return Text(zh=f"只能是这些值之一：{known}", en=f"must be one of {known}")


class Kind(Record):
    """What checks of scripts and of texts have in common.

    Attributes:
        options: those an assignment must give. optional: those it may give.
        consult: returns what else in an assignment does not fit, as (field, problem).
    """

    kind: str
    measures: Mapping[str, MeasureKind]
    options: Options = field(default_factory=dict)
    optional: Options = field(default_factory=dict)
    consult: Callable[[Assignment], Iterable[tuple[str, Text]]] = lambda assignment: ()


class Check(Kind):
    """A check of what a script did: an entry of the table `CHECKS` in `grader.checks.kinds`.

    Each function is given the assignment with the options of the run's case.

    Attributes:
        measure: what is scored. It never raises for what a student did, and does not read the script.
        explain: which mistakes may be the cause, most likely first, given what was measured. It is called when the
            points are final.
        sketch: what a plot of the run shows beside the bare path.
    """

    measure: Callable[[Assignment, Run], Measures]
    explain: Callable[[Assignment, Run, Measures], tuple[Mistake, ...]]
    sketch: Callable[[Assignment, Run], FigureSketch]


def text_id(check: Kind, name: str) -> str:
    """Return what the ids of a measure's texts begin with."""
    measure = check.measures[name]
    return measure.text or f"{measure.of or check.kind}.{name}"


class TextCheck(Kind):
    """A check of a handed-in text: an entry of the table `TEXT_CHECKS` in `grader.checks.kinds`.

    Attributes:
        examine: measures a text and recognises mistakes in it.
    """

    examine: Callable[[Assignment, str], Findings]
