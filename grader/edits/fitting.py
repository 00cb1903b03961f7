"""A figure whose turns are right and that leaves the field: its sides are too long for where it begins."""

import math
from collections.abc import Iterator
from typing import Final, NamedTuple

from grader.contracts.assignment import WINDOW_M
from grader.edits.situation import OFF_SHARE, Driven, Proposal, Situation, replacing
from grader.edits.slices import numbers_behind

_START_M: Final = WINDOW_M / 2.0
_STEP: Final = 0.5


class TooLarge(NamedTuple):
    """The longest drive, and the length that would fit."""

    drive: Driven
    fits_m: float

    @property
    def most(self) -> str:
        """The length that would fit in m, as it is told."""
        return f"{math.floor(self.fits_m * 10.0) / 10.0:g}"


def too_large(seen: Situation) -> TooLarge | None:
    """Return by what a figure of right turns is too large for the field; None where it is not."""
    turns = [one for one in seen.driven if one.is_turn]
    drives = [one for one in seen.driven if one.is_drive and not seen.is_part(one)]
    wanted = seen.wanted.turns_deg
    right = all(any(abs(abs(one.angle_deg) - each) <= OFF_SHARE * each for each in wanted) for one in turns)
    if not turns or not drives or not right or seen.wanted.lengths_m or seen.outcome.hears:
        return None
    share = min((_START_M / reach_m for reach_m in _reaches(seen)), default=1.0)
    longest = max(drives, key=lambda one: abs(one.length_m))
    return TooLarge(longest, share * abs(longest.length_m)) if share < 1.0 else None


def _reaches(seen: Situation) -> Iterator[float]:
    """Yield how far from its start, along either axis, the commanded motions lead."""
    x_m = y_m = heading_rad = 0.0
    for one in seen.driven:
        if one.is_drive:
            x_m += one.length_m * math.cos(heading_rad)
            y_m += one.length_m * math.sin(heading_rad)
        heading_rad += math.radians(one.angle_deg)
        yield max(abs(x_m), abs(y_m), 1e-9)


def fitting_changes(seen: Situation) -> Iterator[Proposal]:
    """Yield a number for the sides with which the figure fits."""
    large = too_large(seen)
    if large is None:
        return
    longest_m = abs(large.drive.length_m)
    for use in numbers_behind(seen.script, large.drive.motion.lines):
        is_size = any(abs(use.value - one) <= OFF_SHARE * one for one in (longest_m, large.drive.seconds))
        new = math.floor(use.value * large.fits_m / longest_m / _STEP) * _STEP
        if is_size and new > 0.0:
            cost = 1.0 + 0.1 * use.steps
            yield replacing(seen.script, "fits", cost, use.node, f"{new:.1f}", most=large.most)
