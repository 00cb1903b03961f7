"""Where two scripts are alike: ranges of lines on both sides."""

from collections import defaultdict
from collections.abc import Set
from dataclasses import dataclass
from typing import Final

from grader.similarity.fingerprints import Fingerprints

MOST_PLACES: Final = 50


@dataclass(frozen=True, slots=True)
class Range:
    """Lines of a file, from 1, both included."""

    first_line: int
    last_line: int

    def joined(self, other: "Range") -> "Range | None":
        """Return both as one; None where lines lie between them."""
        if other.first_line > self.last_line + 1 or self.first_line > other.last_line + 1:
            return None
        return Range(min(self.first_line, other.first_line), max(self.last_line, other.last_line))


@dataclass(frozen=True, slots=True)
class Place:
    """What two scripts have in common at one place of each."""

    first: Range
    second: Range

    def joined(self, other: "Place") -> "Place | None":
        """Return both as one; None where on either side lines lie between them."""
        first, second = self.first.joined(other.first), self.second.joined(other.second)
        return None if first is None or second is None else Place(first, second)


def places(first: Fingerprints, second: Fingerprints, rare: Set[int]) -> tuple[Place, ...]:
    """Return the first `MOST_PLACES` places where two scripts share `rare` hashes, in order of `first`."""
    ours, theirs = _ranges(first, rare), _ranges(second, rare)
    met = [
        Place(*both)
        for shared in sorted(ours.keys() & theirs.keys())
        for both in zip(ours[shared], theirs[shared], strict=False)
    ]
    places: list[Place] = []
    for one in sorted(met, key=lambda place: (place.first.first_line, place.second.first_line)):
        joined = places[-1].joined(one) if places else None
        if joined is None:
            places.append(one)
        else:
            places[-1] = joined
    return tuple(places[:MOST_PLACES])


def _ranges(one: Fingerprints, rare: Set[int]) -> dict[int, list[Range]]:
    ranges: dict[int, list[Range]] = defaultdict(list)
    lines = zip(one.hashes.tolist(), one.first_lines.tolist(), one.last_lines.tolist(), strict=True)
    for shared, first_line, last_line in lines:
        if shared in rare:
            ranges[shared].append(Range(first_line, last_line))
    return ranges
