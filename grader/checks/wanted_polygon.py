"""The polygon an assignment asks for: its sides, their lengths where they are fixed, and its shape."""

import cmath
import itertools
import math
from collections.abc import Mapping, Sequence

from grader.checks.measure import Option
from grader.contracts.record import positional_record

FULL_TURN_DEG = 360.0


@positional_record
class WantedPolygon:
    """A polygon with equal corners.

    Attributes:
        lengths_m: length of each side, in either sense and from any side on; None: equal, of any length.
    """

    sides: int
    lengths_m: tuple[float, ...] | None = None

    @property
    def corner_deg(self) -> float:
        """Exterior angle."""
        return FULL_TURN_DEG / self.sides

    @property
    def figure(self) -> str:
        """Key of its name in the catalogs."""
        regular = self.lengths_m is None or len(set(self.lengths_m)) == 1
        return f"figure.{self.sides}" if regular else "figure.rectangle"

    def aligned(self, sides_m: Sequence[float]) -> tuple[float, ...]:
        """Return the wanted length of each driven side, beginning at the side that fits them best.

        Reversing a pattern of two alternating lengths is the same as shifting it.
        """
        if self.lengths_m is None or not sides_m:
            return ()
        shifts = (self.lengths_m[i:] + self.lengths_m[:i] for i in range(self.sides))
        patterns = [tuple(itertools.islice(itertools.cycle(shift), len(sides_m))) for shift in shifts]
        return min(patterns, key=lambda pattern: _worst_pct(sides_m, pattern))

    def side_error_pct(self, sides_m: Sequence[float]) -> float:
        """Return the largest deviation of a driven side from its wanted length; NaN without either."""
        wanted = self.aligned(sides_m)
        return _worst_pct(sides_m, wanted) if wanted else math.nan

    def vertices(self, first_length_m: float | None = None) -> list[complex]:
        """Return the corners of the polygon, driven counter-clockwise from the origin.

        Args:
            first_length_m: wanted length of the first side where sides differ.
        """
        lengths = self.lengths_m or (1.0,) * self.sides
        if first_length_m is not None and first_length_m != lengths[0]:
            lengths = lengths[1:] + lengths[:1]
        corner_rad = math.radians(self.corner_deg)
        steps = (length * cmath.exp(1j * corner_rad * i) for i, length in enumerate(lengths))
        return list(itertools.accumulate(steps, initial=0j))[:-1]


def wanted_polygon(options: Mapping[str, Option]) -> WantedPolygon:
    """Return the polygon that a check's options ask for."""
    sides = int(options["sides"])
    if "side_m" not in options:
        return WantedPolygon(sides)
    first = float(options["side_m"])
    second = float(options.get("other_side_m", first))
    return WantedPolygon(sides, tuple(second if i % 2 else first for i in range(sides)))


def _worst_pct(sides_m: Sequence[float], wanted_m: Sequence[float]) -> float:
    return max(100.0 * abs(side - wanted) / wanted for side, wanted in zip(sides_m, wanted_m, strict=True))
