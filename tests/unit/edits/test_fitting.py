"""Figures that are too large for the field or too slow for the time, and drives that use no pose."""

import math

import pytest

from grader.contracts.outcome import RunStatus
from grader.edits.causes import stated_cause
from grader.edits.fitting import fitting_changes, too_large
from grader.edits.received import Ledger, Motion
from grader.edits.situation import Situation, Stated, WantedSizes
from grader.edits.tree import ParsedScript, applied
from tests.unit.checks.trajectories import drive, run_of

TEXT = "SIDE = {side}\nSPEED = {speed}\nmove(SPEED, 0.0, SIDE)\nmove(0.0, 1.57, 1.0)\np.publish(m)\n"


def _seen(side_m: float, speed: float = 1.0, turn_deg: float = 90.0, **stated: bool) -> Situation:
    """Return what is known of a square that is driven as far as a minute goes."""
    motions, at_ns = [], 0
    for i in range(8):
        size_s = side_m / speed if i % 2 == 0 else 1.0
        v, w = (speed, 0.0) if i % 2 == 0 else (0.0, math.radians(turn_deg))
        line = 3 + i % 2
        until_ns = at_ns + round(size_s * 1e9)
        motions.append(
            Motion(
                v=v, w=w, line=line, t=at_ns, until=until_ns, times=9, topic="", stack=((line, "main", {}),)
            )
        )
        at_ns = until_ns
    motions.append(Motion(v=0.0, w=0.0, line=5, t=at_ns, until=at_ns, times=1, topic=""))
    track = drive([(1.0, 1.0, 0.0), (59.0, 0.0, 0.0)])
    outcome = run_of(track, RunStatus.INTERRUPTED).outcome
    text = TEXT.format(side=side_m, speed=speed)
    within = tuple(one for one in motions if one.t < outcome.duration_ns)
    return Situation(
        script=ParsedScript.parsed(text),
        ledger=Ledger(ran=frozenset(range(1, 6)), motions=within),
        outcome=outcome,
        wanted=WantedSizes((90.0,), (), (4,)),
        asked=Stated(**stated),
    )


def test_a_figure_that_leaves_the_field_is_told_what_fits() -> None:
    seen = _seen(6.0)
    large = too_large(seen)
    assert large is not None
    assert large.fits_m == pytest.approx(5.544, abs=0.01)
    assert any("SIDE = 5.5\n" in applied(seen.script.text, one.edits) for one in fitting_changes(seen))
    cause = stated_cause(seen)
    assert cause is not None
    assert (cause.code, cause.line) == ("too_large", 3)


@pytest.mark.parametrize(
    "seen", [_seen(5.0), _seen(6.0, turn_deg=60.0)], ids=["it fits", "its turns are wrong"]
)
def test_no_other_figure_is_too_large(seen: Situation) -> None:
    assert too_large(seen) is None
    assert not list(fitting_changes(seen))


def test_a_figure_that_is_too_slow_is_told_how_long_it_takes() -> None:
    seen = _seen(3.0, speed=0.15)
    cause = stated_cause(seen)
    assert cause is not None
    assert (cause.code, cause.line) == ("too_slow", 3)
    assert float(str(cause.values["needed"])) == pytest.approx(84.0, abs=2.0)


def test_a_car_that_slips_is_not_to_be_driven_by_time_alone() -> None:
    cause = stated_cause(_seen(2.0, slips=True))
    assert cause is not None
    assert cause.code == "open_loop"
