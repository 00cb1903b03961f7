"""The thread that compares scripts, what it found lately, and what it tells.

A class that is compared must not take the threads that uploads need; what has not changed is not compared again.
"""

import asyncio
from collections import OrderedDict
from collections.abc import Callable, Hashable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Generic, TypeVar

from grader.similarity.commands import SentCommands
from grader.similarity.fingerprints import Fingerprints, Hashes
from grader.similarity.ranking import Pair
from grader.store.scripts import HandedIn, Scripts

_CLASSES, _FILES, _DRIVES, _COURSES = 32, 4_000, 20_000, 4
_Value = TypeVar("_Value")


@dataclass(frozen=True, slots=True)
class SimilarPair:
    """Two students' scripts with something in common; `found` says what, and where."""

    first: HandedIn
    second: HandedIn
    found: Pair


@dataclass(frozen=True, slots=True, kw_only=True)
class Similar:
    """What the scripts of a class have in common at one assignment: of each student the one that counts.

    Attributes:
        compared: scripts. not_compared: of a very large class, the others.
        few: the most students who may share a place that still counts.
        too_little: students whose scripts have too little of their own to be compared.
        pairs: whoever shares most and rarest places first. left_out: how many more there are.
        same_drives: with texts that have little in common, but the same commands at the same times.
    """

    assignment: str
    compared: int
    not_compared: int
    few: int
    too_little: tuple[str, ...]
    pairs: tuple[SimilarPair, ...]
    left_out: int
    same_drives: tuple[SimilarPair, ...]


class _Kept(Generic[_Value]):
    """The last values made, by key."""

    def __init__(self, entries: int) -> None:
        self._entries = entries
        self._values: OrderedDict[Hashable, _Value] = OrderedDict()

    def find(self, key: Hashable) -> _Value | None:
        """Return a value that is still kept, or None."""
        value = self._values.get(key)
        if value is not None:
            self._values.move_to_end(key)
        return value

    def keep(self, key: Hashable, value: _Value) -> _Value:
        """Keep a value in place of the one that was least asked for; return it."""
        self._values[key] = value
        while len(self._values) > self._entries:
            self._values.popitem(last=False)
        return value


class Comparer:
    """One thread that compares, and what it found out lately. `scripts`: reads what was handed in."""

    def __init__(self, scripts: Scripts) -> None:
        self.scripts = scripts
        self.results: _Kept[Similar] = _Kept(_CLASSES)
        self.grams: _Kept[Hashes] = _Kept(_COURSES)
        self.fingerprints: _Kept[Fingerprints] = _Kept(_FILES)
        self.drives: _Kept[SentCommands] = _Kept(_DRIVES)
        self._thread = ThreadPoolExecutor(max_workers=1, thread_name_prefix="grader-similar")

    async def run(self, work: Callable[[], _Value]) -> _Value:
        """Do `work` in the thread, after what was asked for before."""
        return await asyncio.wrap_future(self._thread.submit(work))

    def close(self) -> None:
        """Compare nothing more."""
        self._thread.shutdown(wait=True, cancel_futures=True)
