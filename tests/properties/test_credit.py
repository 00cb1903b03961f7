"""Credit over all bands and all values."""

from hypothesis import given
from hypothesis import strategies as st

from grader.checks.scoring import band_error, credit, earned_points
from grader.contracts.assignment import ItemSpec
from grader.contracts.text import EMPTY

finite = st.floats(-1e6, 1e6)
edges = st.none() | finite


@st.composite
def specs(draw: st.DrawFn) -> ItemSpec:
    low, high = draw(edges), draw(edges)
    if low is not None and high is not None and low > high:
        low, high = high, low
    return ItemSpec(
        id="x",
        title=EMPTY,
        points=draw(st.floats(0.01, 1000.0)),
        measure="m",
        low=low,
        high=high,
        ramp=draw(st.floats(0.0, 1e6)),
    )


@given(specs(), st.floats(allow_nan=True, allow_infinity=True))
def test_earned_points_lie_between_nothing_and_all(spec: ItemSpec, value: float) -> None:
    part = credit(spec, value)
    assert 0.0 <= part <= 1.0
    assert 0.0 <= earned_points(spec.points, part) <= spec.points


@given(specs(), finite, finite)
def test_credit_falls_with_the_error(spec: ItemSpec, one: float, other: float) -> None:
    near, far = sorted((one, other), key=lambda value: band_error(spec, value))
    near_part, far_part = credit(spec, near), credit(spec, far)
    assert near_part >= far_part - 1e-12
    assert earned_points(spec.points, near_part) >= earned_points(spec.points, far_part) - 0.01


@given(specs(), finite, st.floats(0.0, 1.0))
def test_credit_has_no_steps_but_the_end_of_a_band_without_ramp(
    spec: ItemSpec, value: float, fraction: float
) -> None:
    """A smoothstep is nowhere steeper than 1.5 per ramp."""
    if spec.ramp < 1e-3:
        return
    step = fraction * spec.ramp / 1000.0
    change = abs(credit(spec, value + step) - credit(spec, value))
    assert change <= 1.5 * fraction / 1000.0 + 1e-6


@given(specs())
def test_the_edges_of_the_band_earn_all(spec: ItemSpec) -> None:
    for edge in (spec.low, spec.high):
        if edge is not None:
            assert credit(spec, edge) == 1.0
