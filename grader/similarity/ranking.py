"""Ranking pairs of scripts by the passages that they share: many, and such that few others have, come first.

Nothing here says that anybody copied: it says where a person should look.
"""

import math
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from grader.similarity.commands import SentCommands
from grader.similarity.fingerprints import Fingerprints, Hashes
from grader.similarity.places import Place, places

FEWEST_OWN: Final = 12
"""Fingerprints of one's own below which a script has too little to be compared."""

FEWEST_SHARED: Final = 6
LEAST_SHARE: Final = 0.4
"""Of the own fingerprints of one of both that the other has; independent solutions have less in common."""

MOST_PAIRS: Final = 100
FEWEST_CHANGES: Final = 6
"""Changes of the commanded velocity from which an equal drive says something; a square has eight."""

_FEW, _FEW_SHARE = 8, 0.25


@dataclass(frozen=True, slots=True, eq=False)
class Script:
    """One student's script. `sha256`: of its bytes. `drive`: None where nothing was recorded."""

    sha256: str
    fingerprints: Fingerprints
    drive: SentCommands | None = None


@dataclass(frozen=True, slots=True)
class Pair:
    """Two scripts with something in common, by their positions.

    Attributes:
        shared: fingerprints that both have and few others. weight: their sum, each the more the fewer have it.
        first_share, second_share: how much that is of each one's own.
        same_file: the files are equal byte by byte. same_drive: they sent the same commands at the same times.
        places: where; the first ones of many.
    """

    first: int
    second: int
    shared: int
    weight: float
    first_share: float
    second_share: float
    same_file: bool
    same_drive: bool
    places: tuple[Place, ...]


@dataclass(frozen=True, slots=True)
class Ranking:
    """What a class has in common.

    Attributes:
        few: the most students who may share a place that still counts.
        too_little: positions of scripts with too little of their own to be compared.
        pairs: those that share most and rarest first. left_out: how many more there are.
        same_drives: pairs whose texts have little in common, but which drove alike.
    """

    few: int
    too_little: tuple[int, ...]
    pairs: tuple[Pair, ...]
    left_out: int
    same_drives: tuple[Pair, ...]


def rank(scripts: Sequence[Script], given: Hashes, known_drives: frozenset[str] = frozenset()) -> Ranking:
    """Compare the scripts of a class, one of each student.

    `given`: every run of tokens in the code that all students were given; `known_drives`: digests of its drives.
    """
    few = max(_FEW, int(len(scripts) * _FEW_SHARE))
    own = _Own(scripts, given, few)
    compared = np.flatnonzero(own.counts >= FEWEST_OWN)
    too_little = np.flatnonzero(own.counts < FEWEST_OWN)
    shared = own.shared(compared)
    most = shared.counts / np.maximum(np.minimum.outer(own.counts, own.counts), 1)
    chosen = np.argwhere(np.triu((shared.counts >= FEWEST_SHARED) & (most >= LEAST_SHARE), 1))
    ranked = sorted(
        ((int(i), int(j)) for i, j in chosen),
        key=lambda pair: (scripts[pair[0]].sha256 != scripts[pair[1]].sha256, -shared.weights[pair], pair),
    )
    drives = _same_drives(scripts, set(compared.tolist()), few, known_drives)
    listed, alike = ranked[:MOST_PAIRS], sorted(drives - set(ranked))[:MOST_PAIRS]
    return Ranking(
        few=few,
        too_little=tuple(too_little.tolist()),
        pairs=tuple(_pair(scripts, own, shared, *pair, same_drive=pair in drives) for pair in listed),
        left_out=len(ranked) - len(listed),
        same_drives=tuple(_pair(scripts, own, shared, *pair, same_drive=True) for pair in alike),
    )


class _Own:
    """The fingerprints of each script that are neither given nor in many others."""

    def __init__(self, scripts: Sequence[Script], given: Hashes, few: int) -> None:
        self._students = len(scripts)
        different = [np.unique(script.fingerprints.hashes) for script in scripts]
        hashes = np.concatenate([np.zeros(0, dtype=np.uint64), *different])
        owners = np.repeat(np.arange(len(scripts)), [len(lines) for lines in different])
        unknown = ~np.isin(hashes, given)
        order = np.argsort(hashes[unknown], kind="stable")
        self._owners = owners[unknown][order]
        unique, self._starts, self._having = np.unique(
            hashes[unknown][order], return_index=True, return_counts=True
        )
        self._rare = self._having <= few
        self.rare: frozenset[int] = frozenset(unique[self._rare].tolist())
        rare_rows = np.repeat(self._rare, self._having)
        self.counts: NDArray[np.int64] = np.bincount(self._owners[rare_rows], minlength=len(scripts))

    def shared(self, compared: NDArray[np.intp]) -> "_Shared":
        """Return what each two of the scripts `compared` share."""
        counts = np.zeros((self._students, self._students), dtype=np.int32)
        weights = np.zeros((self._students, self._students))
        for i in np.flatnonzero(self._rare & (self._having > 1)):
            start, having = int(self._starts[i]), int(self._having[i])
            owners = self._owners[start : start + having]
            both = np.ix_(owners, owners)
            counts[both] += 1
            weights[both] += math.log((self._students + 1) / having)
        left_out = np.setdiff1d(np.arange(self._students), compared)
        counts[left_out, :] = counts[:, left_out] = 0
        return _Shared(counts, weights)


class _Shared(NamedTuple):
    """For each two scripts, how many rare fingerprints they share, and what these weigh."""

    counts: NDArray[np.int32]
    weights: NDArray[np.float64]


def _pair(  # noqa: PLR0913
    scripts: Sequence[Script], own: _Own, shared: _Shared, i: int, j: int, *, same_drive: bool
) -> Pair:
    first, second, count = scripts[i], scripts[j], int(shared.counts[i, j])
    return Pair(
        first=i,
        second=j,
        shared=count,
        weight=round(float(shared.weights[i, j]), 2),
        first_share=round(count / int(own.counts[i]), 4),
        second_share=round(count / int(own.counts[j]), 4),
        same_file=first.sha256 == second.sha256,
        same_drive=same_drive,
        places=places(first.fingerprints, second.fingerprints, own.rare),
    )


def _same_drives(
    scripts: Sequence[Script], compared: set[int], few: int, given_drives: frozenset[str]
) -> set[tuple[int, int]]:
    """Return the pairs that drove alike, in a way that neither many nor the given code drive.

    Whoever has hardly anything of their own drives as the given code does.
    """
    by_digest: dict[str, list[int]] = defaultdict(list)
    for i, one in enumerate(scripts):
        if (
            one.drive is not None
            and one.drive.changes >= FEWEST_CHANGES
            and one.drive.digest not in given_drives
        ):
            by_digest[one.drive.digest].append(i)
    groups = (group for group in by_digest.values() if len(group) <= few and compared.issuperset(group))
    return {pair for group in groups for pair in combinations(group, 2)}
