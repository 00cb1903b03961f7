"""This machine gives the reports that were committed, to the byte."""

import pytest

from grader.contracts.grading import Grader
from tests.digest import GOLDEN, SAMPLED, WHOLE, compared, lines, portable, read
from tests.digest.gradings import gradings, replays


@pytest.mark.skipif(not GOLDEN.exists(), reason="no table is committed: python -m tests.digest --renew")
def test_the_reports_are_the_committed_ones(grader: Grader) -> None:
    committed = read(GOLDEN)
    del committed[WHOLE]
    chosen = gradings()[::SAMPLED]
    table = portable(lines(grader, chosen), replays(chosen))
    differing = [line.id for line in table if committed.get(line.id) != line]
    told = "\n".join([*differing, *compared(committed, table)])
    assert not differing, (
        f"reports differ from {GOLDEN.name}. After a change that is meant: python -m tests.digest --renew. "
        f"Without one this machine computes otherwise: python -m tests.digest.matrix --every 10\n{told}"
    )
    assert list(committed) == [line.id for line in table]
