"""What all functions that look for a cause in a script share."""

import re
from typing import Final, NamedTuple

from grader.checks.measure import Findings, Mistake
from grader.contracts.assignment import Assignment, Case
from grader.contracts.scoring import Run
from grader.messages.script import ScriptText

CLOCK: Final = r"(?:time\.(?:time|monotonic|perf_counter)\(\)|(?:[\w.]+\(\)\.)?now\(\)(?:\.nanoseconds)?)"
LOGS: Final = r"\.(?:info|debug|warn|warning)\("
SHOWS: Final = rf"\bprint\(|{LOGS}"
"""A line that logs, and one that logs or prints: what it uses is only shown."""


class Searched(NamedTuple):
    """A run with its script, and what was measured and recognised in it."""

    assignment: Assignment
    run: Run
    script: ScriptText
    findings: Findings
    mistake: Mistake

    @property
    def case(self) -> Case | None:
        """The case of the assignment that was run; None if it has no such case."""
        return next((case for case in self.assignment.cases if case.id == self.run.case), None)

    @property
    def corner_deg(self) -> tuple[float, float] | None:
        """The worst corner and the middle of its item's band; None where either is not known."""
        corner, item = self.findings.measures.get("corner_deg"), self.assignment.item_on("corner_deg")
        if corner is None or item is None or item.low is None or item.high is None:
            return None
        return corner.value, (item.low + item.high) / 2.0


def is_repeated(line: int, script: ScriptText) -> bool:
    """Whether a line stands in a loop of its function."""
    return any(re.match(r"[ \t]*(for|while)\b", head) for head in script.conditions_around(line))


def sets(name: str, line: int, script: ScriptText) -> bool:
    """Whether the block that a line begins assigns a name, itself or by a function that it calls."""
    blocks = (script.block(first)[1:] for first in script.reached_from([line]))
    return any(re.match(rf"[ \t]*{re.escape(name)} ?=(?!=)", text) for block in blocks for text in block)


def itself(name: str) -> str:
    """Return the pattern of a name that is no part of another one, nor an attribute of something."""
    return rf"(?<![\w.]){re.escape(name)}(?![\w.])"
