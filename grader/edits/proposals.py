"""All changes that may be the cause of what went wrong, the most plausible first."""

from collections.abc import Iterator
from typing import NamedTuple

from grader.contracts.outcome import StudentError
from grader.edits.asked import asked_changes
from grader.edits.calls import call_changes
from grader.edits.counts import count_changes
from grader.edits.directions import direction_changes
from grader.edits.errors import error_changes
from grader.edits.fitting import fitting_changes
from grader.edits.flow import flow_changes
from grader.edits.headings import heading_changes
from grader.edits.names import name_changes
from grader.edits.numbers import number_changes
from grader.edits.situation import Proposal, Situation
from grader.edits.spins import spin_changes
from grader.edits.state import state_changes
from grader.edits.syntax import syntax_changes
from grader.edits.tree import applied

_MOST_PLACES = 6
_EVERYWHERE = 0.05  # behind the change at the one place where it is most plausible
_SOURCES = (
    name_changes,
    error_changes,
    asked_changes,
    direction_changes,
    fitting_changes,
    heading_changes,
    flow_changes,
    spin_changes,
    call_changes,
    state_changes,
    count_changes,
    number_changes,
)
_OF_SIZES = frozenset(("converted", "degrees", "exchanged", "left_over", "scaled", "sign", "stop"))
"""Kinds of change that cannot make up for rounds that are missing."""


def _everywhere(found: list[Proposal]) -> Iterator[Proposal]:
    """Yield the same change at all its places: who makes a mistake in one function makes it in the next."""
    groups: dict[tuple[object, ...], list[Proposal]] = {}
    for one in found:
        key = (one.code, one.values.get("old"), one.values.get("new"), one.values.get("field"))
        groups.setdefault(key, []).append(one)
    for group in groups.values():
        edits = tuple(dict.fromkeys(edit for one in group for edit in one.edits))
        if 1 < len(group) <= _MOST_PLACES:
            first = min(group, key=lambda one: one.cost)
            yield Proposal(first.code, first.cost + _EVERYWHERE, edits, first.values)


class Candidate(NamedTuple):
    """A proposal, and the whole text with it."""

    proposal: Proposal
    text: str


def candidates(seen: Situation) -> Iterator[Candidate]:
    """Yield proposals with their texts, each text once, the most plausible first."""
    found = [one for source in _SOURCES for one in source(seen)]
    if seen.rounds_missing:
        found = [one for one in found if one.code not in _OF_SIZES]
    return _applied(seen.script.text, [*found, *_everywhere(found)])


def syntax_candidates(text: str, error: StudentError) -> Iterator[Candidate]:
    """Yield proposals for a text that Python does not take, as `candidates` does."""
    return _applied(text, list(syntax_changes(text, error)))


def _applied(before: str, proposals: list[Proposal]) -> Iterator[Candidate]:
    offered = {before}
    for proposal in sorted(proposals, key=lambda one: one.cost):
        try:
            text = applied(before, proposal.edits)
        except ValueError:  # two of its edits touch the same text
            continue
        if text not in offered:
            offered.add(text)
            yield Candidate(proposal, text)
