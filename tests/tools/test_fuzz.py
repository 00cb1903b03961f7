"""A short run of the fuzzer over every decoder; the long ones are `python -m tools.fuzz --seconds 3600`."""

import subprocess
import sys
from pathlib import Path

import pytest

from tests.examples import examples
from tools import fuzz

ROOT = Path(__file__).resolve().parents[2]
TARGETS = ["trusted_frames", "trusted_wire", "trusted_cdr", "jail_wire", "jail_cdr"]
INPUTS = examples(10_000)

# The shim's modules must not be left behind in the tests' process.
PROGRAM = f"""
from tools import fuzz, fuzz_targets
assert list(fuzz_targets.TARGETS) == {TARGETS}
for name in fuzz_targets.TARGETS:
    assert fuzz_targets.seeds(name)
    tally = fuzz.mutate(name, seed=1, inputs={INPUTS})
    assert tally.inputs >= {INPUTS} and 0 < tally.accepted < tally.inputs, (name, vars(tally))
"""


def test_no_decoder_is_surprised() -> None:
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", PROGRAM], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr


def test_inputs_are_the_same_for_a_seed_and_others_for_another() -> None:
    def inputs(seed: int) -> list[bytes]:
        mutator = fuzz.Mutator([b"abc", b"defghi"], seed)
        return [mutator.next() for _ in range(200)]

    assert inputs(1) == inputs(1)
    assert inputs(1) != inputs(2)
    assert len(set(inputs(1))) > 100


def test_a_finding_names_its_input() -> None:
    def fragile(data: bytes) -> bool:
        return 1 // len(data) > 0

    tally = fuzz.Tally("fragile", fragile)
    assert tally.feed(b"x")
    with pytest.raises(ZeroDivisionError) as caught:
        tally.feed(b"")
    assert caught.value.__notes__ == ["input of fragile: "]
    assert (tally.inputs, tally.accepted) == (2, 1)
