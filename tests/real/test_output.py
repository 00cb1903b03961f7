"""Every script that was recorded says here what it says on the real rclpy, or `differences.yaml` says why not."""

import re
from pathlib import Path

import pytest

from grader.contracts.grading import Grader
from tests.real.output import differences, ours, reason, scripts, stale, table
from tests.rows import slow_but

FIDELITY = Path(__file__).parents[2] / "docs" / "fidelity.md"


@pytest.mark.parametrize("name", slow_but(60, scripts()))
def test_a_script_says_what_it_says_at_home(grader: Grader, name: str) -> None:
    found = differences(name, ours(grader, name))
    assert [one for one in found if reason(name, one) is None] == []
    assert stale(name, found) == []


def test_every_reason_is_given_for_a_script_that_was_recorded() -> None:
    rows = table()["differences"]
    assert rows.keys() <= set(scripts())
    assert {row["why"] for name in rows for row in rows[name]} == table()["reasons"].keys()


def test_the_counts_in_the_document_are_those_of_the_comparison() -> None:
    """That test fails unless a script outside the table says the same."""
    named = len(table()["differences"])
    told = re.search(r"(\d+) scripts say the same, (\d+) differ", FIDELITY.read_text("utf-8"))
    assert told
    assert [int(number) for number in told.groups()] == [len(scripts()) - named, named]
