"""Proposals of scripts that are made to need many of them: bounded, whatever the script."""

import pytest

from grader.contracts.outcome import RunStatus
from grader.edits.proposals import candidates
from grader.edits.received import Ledger, Motion
from grader.edits.situation import Situation, WantedSizes
from grader.edits.tree import ParsedScript
from tests.unit.checks.trajectories import drive, run_of

MANY = {
    "clocks": "".join(
        f"t{i} = time.time()\nwhile time.time() - t{i} < 2:\n    x.publish(m)\n" for i in range(100)
    ),
    "states": "".join(
        f"s{i} = 'turning'\nif s{i} == 'turn':\n    s{i} = 'turned'\n    n += 1\n" for i in range(100)
    ),
    "functions": "".join(f"def f{i}(a, b=90):\n    f{i + 1}(a, 1)\n    x.publish(m)\n" for i in range(100)),
}


@pytest.mark.parametrize("text", MANY.values(), ids=MANY)
def test_a_script_of_many_lines_alike_gets_a_bounded_number_of_proposals(text: str) -> None:
    count = text.count("\n")
    motions = tuple(
        Motion(v=1.0, w=float(i % 2), line=count - i % 5, t=i * 10**9, until=i * 10**9, times=5, topic="")
        for i in range(100)
    )
    seen = Situation(
        script=ParsedScript.parsed(text),
        ledger=Ledger(ran=frozenset(range(1, count + 1)), motions=motions),
        outcome=run_of(drive([(1.0, 1.0, 0.0)]), RunStatus.INTERRUPTED).outcome,
        wanted=WantedSizes((90.0, 45.0), (2.0,), (4,)),
    )
    found = list(candidates(seen))
    assert 0 < len(found) < 2_000
    costs = [one.proposal.cost for one in found]
    assert costs == sorted(costs)
    assert len({one.text for one in found}) == len(found)
