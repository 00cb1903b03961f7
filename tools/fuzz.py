"""Fuzz the decoders on both sides of the jail's border for a while: ``python -m tools.fuzz --seconds 600``.

Two engines: ``mutate`` changes well-formed inputs at random, from a seed, with nothing but the standard
library; ``atheris`` (``pip install atheris``) is guided by coverage and finds its own way into the branches.
A finding is printed with its input in hexadecimal, and the exit code is 1.
"""

from __future__ import annotations

import argparse
import importlib
import random
import sys
import tempfile
import time
import traceback
from collections.abc import Callable
from pathlib import Path
from typing import Any, Final

_PER_LOOK: Final = 256
"""Inputs between two looks at the clock."""

_INTERESTING: Final = (
    b"\x00", b"\x01", b"\x7f", b"\x80", b"\xff", b"\x00\x00", b"\xff\xff", b"\x00\x00\x00\x00",
    b"\xff\xff\xff\xff", b"\xff\xff\xff\x7f", b"\x00\x00\x00\x80", b"\x01\x00\x00\x00", b"\x00\x10\x00\x00",
    b"\x01\x10\x00\x00", b"\x00\x00\x00\x00\x00\x00\xf0\x7f", b"\x00\x00\x00\x00\x00\x00\xf8\x7f",
    b"\xff\xff\xff\xff\xff\xff\xff\x7f", b"\xc3\x28", b"\xed\xa0\x80", b"\xf4\x90\x80\x80", b"\xef\xbb\xbf",
)  # fmt: skip


class Mutator:
    """Makes inputs out of others: a repeatable sequence for each seed."""

    def __init__(self, corpus: list[bytes], seed: int) -> None:
        self._corpus = corpus
        self._random = random.Random(seed)  # noqa: S311 - repeatable on purpose

    def next(self) -> bytes:
        """Return the next input."""
        data = bytearray(self._random.choice(self._corpus))
        for _ in range(self._random.choice((0, 1, 1, 1, 2, 3, 8))):
            self._random.choice(self._STEPS)(self, data)
        return bytes(data)

    def keep(self, data: bytes) -> None:
        """Build on `data` as well, as far as there is room."""
        if len(self._corpus) < 4096 and len(data) < 4096:
            self._corpus.append(data)

    def _at(self, data: bytearray) -> int:
        return self._random.randrange(len(data) + 1)

    def _flip(self, data: bytearray) -> None:
        if data:
            data[self._random.randrange(len(data))] ^= 1 << self._random.randrange(8)

    def _overwrite(self, data: bytearray) -> None:
        at, new = self._at(data), self._random.choice(_INTERESTING)
        data[at : at + len(new)] = new

    def _insert(self, data: bytearray) -> None:
        at = self._at(data)
        data[at:at] = self._random.randbytes(self._random.randrange(1, 9))

    def _cut(self, data: bytearray) -> None:
        at = self._at(data)
        del data[at : at + self._random.randrange(1, 9)]

    def _truncate(self, data: bytearray) -> None:
        del data[self._at(data) :]

    def _repeat(self, data: bytearray) -> None:
        at = self._at(data)
        data[at:at] = data[at : at + self._random.randrange(1, 65)]

    def _join(self, data: bytearray) -> None:
        other = self._random.choice(self._corpus)
        data[self._at(data) :] = other[self._random.randrange(len(other) + 1) :]

    _STEPS: tuple[Callable[[Mutator, bytearray], None], ...] = (
        _flip, _overwrite, _overwrite, _insert, _cut, _truncate, _repeat, _join,
    )  # fmt: skip


class Tally:
    """Feeds one target and counts.

    Attributes:
        inputs: how many were tried. accepted: how many the decoder took for well-formed.
    """

    def __init__(self, name: str, target: Callable[[bytes], bool]) -> None:
        self.name = name
        self._target = target
        self.inputs = 0
        self.accepted = 0

    def feed(self, data: bytes) -> bool:
        """Try `data`; return whether it was accepted.

        Raises:
            Exception: the finding, with the input in a note.
        """
        self.inputs += 1
        try:
            accepted = self._target(data)
        except Exception as error:
            error.add_note(f"input of {self.name}: {data.hex()}")
            raise
        self.accepted += accepted
        return accepted


def mutate(name: str, *, seed: int, inputs: int | None = None, seconds: float | None = None) -> Tally:
    """Fuzz one target with changed seeds, for a number of inputs or for a while.

    Raises:
        Exception: the first finding.
    """
    from tools.fuzz_targets import TARGETS, seeds

    tally, mutator = Tally(name, TARGETS[name]), Mutator(seeds(name), seed)
    deadline_s = None if seconds is None else time.monotonic() + seconds
    while (inputs is None or tally.inputs < inputs) and (deadline_s is None or time.monotonic() < deadline_s):
        for _ in range(_PER_LOOK):
            data = mutator.next()
            if tally.feed(data):
                mutator.keep(data)
    return tally


def with_atheris(name: str, seconds: int, seed: int) -> None:
    """Fuzz one target guided by coverage; libFuzzer prints the figures and ends the process."""
    atheris: Any = importlib.import_module("atheris")  # an option, not a dependency

    with atheris.instrument_imports(include=["grader.sim", "grader.jail.jail", "rclpy"]):
        from tools.fuzz_targets import TARGETS, seeds

    tally = Tally(name, TARGETS[name])
    with tempfile.TemporaryDirectory() as folder:
        for number, data in enumerate(seeds(name)):
            (Path(folder) / f"seed{number}").write_bytes(data)
        options = [f"-max_total_time={seconds}", f"-seed={seed + 1}", "-max_len=4096", "-print_final_stats=1"]
        atheris.Setup([sys.argv[0], *options, folder], lambda data: tally.feed(data) and None)
        atheris.Fuzz()


def main() -> int:
    """Fuzz every target, or one, and print how many inputs each has seen."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--seconds", type=int, default=60, help="in all (default: 60)")
    parser.add_argument("--target", help="only this one (atheris needs one)")
    parser.add_argument("--engine", choices=("mutate", "atheris"), default="mutate")
    parser.add_argument("--seed", type=int, default=0)
    arguments = parser.parse_args()
    if arguments.engine == "atheris":
        if arguments.target is None:
            parser.error("--engine atheris needs --target")
        with_atheris(arguments.target, arguments.seconds, arguments.seed)
    from tools.fuzz_targets import TARGETS

    names = [arguments.target] if arguments.target else list(TARGETS)
    for name in names:
        try:
            tally = mutate(name, seed=arguments.seed, seconds=arguments.seconds / len(names))
        except Exception:
            traceback.print_exc()
            return 1
        print(f"{name}: {tally.inputs} inputs, {tally.accepted} of them well-formed, no finding", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
