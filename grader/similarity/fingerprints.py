"""What of a script is compared: of every few runs of tokens one hash, the same one wherever they are the same."""

from dataclasses import dataclass
from hashlib import blake2b
from typing import Final

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from grader.similarity.tokens import SourceTokens

GRAM_TOKENS: Final = 12
"""Places with fewer tokens in common are not found."""

WINDOW: Final = 8
"""Of each window of this many runs of tokens one is kept, so that any 19 tokens in common are found."""

_HASH_BYTES = 8
Hashes = NDArray[np.uint64]
Lines = NDArray[np.int32]


@dataclass(frozen=True, slots=True, eq=False)
class Fingerprints:
    """What is compared of one script, in order of the text; all arrays have the same length.

    Attributes:
        hashes: may repeat.
        first_lines, last_lines: of the tokens behind each hash.
        cut: whether the script goes on after what was read of it.
    """

    hashes: Hashes
    first_lines: Lines
    last_lines: Lines
    cut: bool

    def __len__(self) -> int:
        return len(self.hashes)


def grams(tokens: SourceTokens) -> Hashes:
    """Return the hash of every run of `GRAM_TOKENS` tokens: the same in every process and version."""
    codes = tokens.codes.encode("ascii")
    digests = (
        blake2b(codes[i : i + GRAM_TOKENS], digest_size=_HASH_BYTES).digest()
        for i in range(len(codes) - GRAM_TOKENS + 1)
    )
    return np.frombuffer(b"".join(digests), dtype="<u8").astype(np.uint64)


def fingerprints(tokens: SourceTokens) -> Fingerprints:
    """Return the smallest hash of every `WINDOW` neighbouring runs, of equal ones the last."""
    every = grams(tokens)
    if len(every):
        windows = sliding_window_view(every, min(WINDOW, len(every)))
        last_smallest = windows.shape[1] - 1 - windows[:, ::-1].argmin(axis=1)
        chosen = np.unique(last_smallest + np.arange(len(windows)))
    else:
        chosen = np.zeros(0, dtype=np.intp)
    lines = np.array(tokens.lines, dtype=np.int32)
    return Fingerprints(every[chosen], lines[chosen], lines[chosen + GRAM_TOKENS - 1], tokens.cut)


def likeness(first: Fingerprints, second: Fingerprints) -> float:
    """Return how much of two scripts is the same, from 0 to 1 (Dice's coefficient of their different hashes)."""
    hashes, others = np.unique(first.hashes), np.unique(second.hashes)
    together = len(hashes) + len(others)
    return 2 * len(np.intersect1d(hashes, others)) / together if together else 0.0
