"""From a measured value to points: full inside the band, a smooth ramp to zero outside."""

import math
from collections.abc import Iterable

from grader.contracts.assignment import Assignment, ItemSpec
from grader.contracts.rubric import ItemStatus

ENOUGH = 0.5  # of the points of what an item needs: from there on it counts in full


def error(spec: ItemSpec, value: float) -> float:
    """Return the distance of `value` from the band of full credit; infinite for NaN."""
    if math.isnan(value):
        return math.inf
    below = 0.0 if spec.low is None else spec.low - value
    above = 0.0 if spec.high is None else value - spec.high
    return max(below, above, 0.0)


def share(spec: ItemSpec, value: float) -> float:
    """Return the share of the points in [0, 1]: falls monotonically and smoothly with the error."""
    distance = error(spec, value)
    if distance <= 0.0:
        return 1.0
    if not distance < spec.ramp:
        return 0.0
    x = distance / spec.ramp
    return 1.0 - x * x * (3.0 - 2.0 * x)


def counted(needed: Iterable[float]) -> float:
    """Return how much of an item counts, given the shares of the points of what it needs: no step at zero."""
    return min((1.0, *(share / ENOUGH for share in needed)))


def fits(assignment: Assignment, measure: str, value: float) -> bool | None:
    """Whether `value` earns full credit; None where the rubric does not judge it or it is unknown."""
    spec = assignment.item_on(measure)
    return None if spec is None or not math.isfinite(value) else error(spec, value) <= 0.0


def earned(points: float, part: float) -> float:
    """Return the points for a share of them, rounded down to hundredths: only a full share earns all."""
    if part >= 1.0:
        return points
    return min(points, math.floor(points * part * 100.0) / 100.0) if part > 0.0 else 0.0


def status(points_earned: float, part: float) -> ItemStatus:
    """Return the state that goes with a share of the points and what it earned."""
    if part >= 1.0:
        return ItemStatus.PASSED
    return ItemStatus.PARTIAL if points_earned > 0.0 else ItemStatus.FAILED
