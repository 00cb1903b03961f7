"""All changes that may be the cause of what went wrong, the most plausible first."""

from collections.abc import Iterator
from typing import NamedTuple

from grader.edits.flow import flow_changes
from grader.edits.names import name_changes
from grader.edits.numbers import number_changes
from grader.edits.situation import Proposal, Situation
from grader.edits.tree import applied

_SOURCES = (name_changes, flow_changes, number_changes)


class Candidate(NamedTuple):
    """A proposal, and the whole text with it."""

    proposal: Proposal
    text: str


def candidates(seen: Situation) -> Iterator[Candidate]:
    """Yield proposals with their texts, each text once, the most plausible first."""
    found = [one for source in _SOURCES for one in source(seen)]
    offered = {seen.script.text}
    for proposal in sorted(found, key=lambda one: one.cost):
        try:
            text = applied(seen.script.text, proposal.edits)
        except ValueError:  # two of its edits touch the same text
            continue
        if text not in offered:
            offered.add(text)
            yield Candidate(proposal, text)
