"""Facts of a traced run: taken where they were asked for, the tree only before the script runs."""

import pytest

from grader.sim.driving import Car
from grader.sim.episode import MAX_FACTS_BYTES
from tests.fakes import jail
from tests.unit.sim.playing import play

TREE, LEDGER = b"\x32\x01", b"\x32\x02"
STARTED = jail.note("started", "")


def test_pieces_are_kept_in_order(car: Car) -> None:
    frames = [TREE + b"[1", TREE + b",2]", STARTED, LEDGER + b"{", LEDGER + b"}", jail.ended(0)]
    result = play(car, frames, facts=True)
    assert (result.violation, result.tree, result.ledger) == (None, b"[1,2]", b"{}")


@pytest.mark.parametrize(
    "frames",
    [
        [STARTED, TREE + b"[]"],
        [b"\x32\x03[]"],
        [b"\x32"],
        [LEDGER + b"x" * 60_000] * (MAX_FACTS_BYTES // 60_000 + 1),
    ],
    ids=["a tree from the script", "an unknown kind", "cut off", "too much"],
)
def test_anything_else_breaks_the_run_that_looks_for_words(car: Car, frames: list[bytes]) -> None:
    result = play(car, frames, facts=True)
    assert result.violation is not None
    assert "FACTS" in result.violation


def test_nothing_is_taken_where_nobody_asked(car: Car) -> None:
    result = play(car, [STARTED, LEDGER + b"{}"])
    assert result.violation == "FACTS.what came where nobody asked for it"
    assert result.ledger == b""
