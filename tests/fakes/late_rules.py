"""Late rules of every kind: one of each to look at, and any for hypothesis to draw.

What is drawn follows from `LATE_PARAMETERS` and from the kinds of the fields, so a new kind of late rule is drawn
as soon as it is there; its example has to be written.
"""

from collections.abc import Mapping
from typing import Any, Final

from hypothesis import strategies as st

from grader.contracts import fields
from grader.contracts.fields import FieldKind, kinds_of
from grader.contracts.rules import LATE_PARAMETERS, LateKind, LateRule, LateStep

EXAMPLES: Final[Mapping[LateKind, LateRule]] = {
    "none": LateRule(),
    "linear": LateRule(kind="linear", per_day=0.1),
    "steps": LateRule(
        kind="steps", steps=(LateStep(after_s=3600, keep=0.9), LateStep(after_s=7200, keep=0.5))
    ),
}
assert EXAMPLES.keys() == LATE_PARAMETERS.keys(), "a new kind of late rule has its example here"

_LONGEST_S = 900_000
_LEAST_SHARE = 0.01


@st.composite
def late_rules(draw: st.DrawFn) -> LateRule:
    """Draw a rule of any kind with any values of its fields."""
    kind = draw(st.sampled_from(list(LATE_PARAMETERS)))
    values = {name: draw(_values(kinds_of(LateRule)[name])) for name in LATE_PARAMETERS[kind]}
    return LateRule(kind=kind, **values)


def _values(kind: FieldKind) -> st.SearchStrategy[Any]:
    match kind:
        case fields.Share():
            return st.floats(_LEAST_SHARE if kind.positive else 0.0, 1.0).map(lambda share: round(share, 6))
        case fields.Count() | fields.Seconds():
            return st.integers(1 if kind.positive else int(kind.low), min(int(kind.high), _LONGEST_S))
        case fields.Table() if kind.of is LateStep:
            return _steps()
    raise NotImplementedError(f"say how values of {kind} are drawn")


@st.composite
def _steps(draw: st.DrawFn) -> tuple[LateStep, ...]:
    step = kinds_of(LateStep)
    after_s = sorted(draw(st.sets(_values(step["after_s"]), min_size=1, max_size=4)))
    keep = sorted((draw(_values(step["keep"])) for _ in after_s), reverse=True)
    return tuple(LateStep(after_s=one, keep=share) for one, share in zip(after_s, keep, strict=True))
