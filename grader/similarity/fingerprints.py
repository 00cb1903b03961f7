"""Fingerprints of a script, which are compared with those of others ("winnowing").

Each run of `GRAM_TOKENS` tokens is hashed, and of each `WINDOW` neighbouring runs the smallest hash is kept. Which
one that is depends on these runs alone, so passages that are alike in two scripts give the same hashes.
"""

from dataclasses import dataclass
from hashlib import blake2b
from typing import Final

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from grader.similarity.tokens import SourceTokens

GRAM_TOKENS: Final = 12
"""Tokens in a run; common passages of fewer tokens are not found."""

WINDOW: Final = 8
"""Runs of which one hash is kept, so that any common passage of 19 tokens (12 + 8 - 1) is found."""

_HASH_BYTES = 8
Hashes = NDArray[np.uint64]
Lines = NDArray[np.int32]


@dataclass(frozen=True, slots=True, eq=False)
class Fingerprints:
    """The hashes that were kept of one script, in its order; all arrays have the same length.

    Attributes:
        hashes: may repeat.
        first_lines, last_lines: lines of the first and last token of each hashed run.
        cut: whether the script is longer than the part that was read.
    """

    hashes: Hashes
    first_lines: Lines
    last_lines: Lines
    cut: bool

    def __len__(self) -> int:
        return len(self.hashes)


def grams(tokens: SourceTokens) -> Hashes:
    """Return the hash of every run of `GRAM_TOKENS` tokens; it does not depend on the process or on Python."""
    codes = tokens.codes.encode("ascii")
    digests = (
        blake2b(codes[i : i + GRAM_TOKENS], digest_size=_HASH_BYTES).digest()
        for i in range(len(codes) - GRAM_TOKENS + 1)
    )
    return np.frombuffer(b"".join(digests), dtype="<u8").astype(np.uint64)


def fingerprints(tokens: SourceTokens) -> Fingerprints:
    """Return the smallest hash of each `WINDOW` neighbouring runs; of equal ones the last."""
    every = grams(tokens)
    if len(every):
        windows = sliding_window_view(every, min(WINDOW, len(every)))
        last_smallest = windows.shape[1] - 1 - windows[:, ::-1].argmin(axis=1)
        chosen = np.unique(last_smallest + np.arange(len(windows)))
    else:
        chosen = np.zeros(0, dtype=np.intp)
    lines = np.array(tokens.lines, dtype=np.int32)
    return Fingerprints(every[chosen], lines[chosen], lines[chosen + GRAM_TOKENS - 1], tokens.cut)
