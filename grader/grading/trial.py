"""Looks for a change of a script that gains marks, by grading it: the change is then proven, not guessed.

Everything is graded like the script itself, in the same jail under the same limits. How much is tried is counted
in runs and in what they simulated, never in time, so the same script gets the same explanation on any machine.
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

from grader.contracts.assignment import Assignment
from grader.contracts.errors import ProtocolError
from grader.contracts.explanation import ChangedText, Explanation, ProvenChange, StatedCause
from grader.contracts.outcome import RunOutcome, RunStatus
from grader.contracts.rubric import ItemStatus, RubricItem, summed
from grader.contracts.text import Text
from grader.edits.causes import stated_cause
from grader.edits.proposals import Candidate, candidates, syntax_candidates
from grader.edits.received import received_ledger, received_script
from grader.edits.situation import Proposal, Situation, WantedSizes
from grader.edits.tree import changed_lines
from grader.messages import join, say
from grader.messages.quantity import number, points

MOST_TRIALS: Final = 24
MOST_WORK_S: Final = 1.5
MOST_CHANGES: Final = 3
_RUN_S: Final = 0.025
_COMMAND_S: Final = 0.000_01
_MANY_COMMANDS: Final = 5_000
_FURTHER_COMMAND_S: Final = 0.000_2
_STEP_S: Final = 0.000_005
_SPOILT_S: Final = 0.5
"""Counted work: of any run, of a command and of a physics step in it, and of a run that reached a limit."""
_LATER_S: Final = 2.37
"""A change that is told also gains when Ctrl+C comes this much later: it does not only fit the horizon's phase."""
_STEP_DEG: Final = 15.0
_STEP_M: Final = 0.1
"""What is wanted at least is told as the next number of these steps that people use."""
_PLAUSIBLE: Final = 1.0
_LEAST_SHARE: Final = 0.1
_LEAST_POINTS: Final = 3.0
"""A change explains what it gains: of the missing points this share and so many. Less is a side effect of it."""
_SPACE: Final = Text(zh="", en=" ")
_SPOILT: Final = (RunStatus.CPU_LIMIT, RunStatus.STALLED, RunStatus.MEMORY_LIMIT, RunStatus.OUTPUT_LIMIT)


@dataclass(frozen=True)
class Graded:
    """What grading one text came to.

    Attributes:
        items: with their points. outcome, case: of the first run that failed an item, else of the first one.
        tree, ledger: of that run, if it was traced.
    """

    items: tuple[RubricItem, ...]
    outcome: RunOutcome
    case: str
    work_s: float
    tree: bytes = b""
    ledger: bytes = b""

    @property
    def score(self) -> float:
        """The sum of the points."""
        return summed(item.earned for item in self.items)

    @property
    def is_full(self) -> bool:
        """Whether nothing is lost."""
        return all(item.status is ItemStatus.PASSED for item in self.items)

    def gained_on(self, other: "Graded") -> tuple[str, ...]:
        """Return the ids of the items that have more points than in `other`."""
        earned = {item.id: item.earned for item in other.items}
        return tuple(item.id for item in self.items if item.earned > earned.get(item.id, 0.0))

    def gains_on(self, other: "Graded") -> bool:
        """Whether this has more points than `other`, and no item has fewer."""
        earned = {item.id: item.earned for item in other.items}
        return self.score > other.score and all(
            item.earned >= earned.get(item.id, 0.0) for item in self.items
        )

    def explains(self, other: "Graded") -> bool:
        """Whether this has full marks or another item passed, or a sizeable part of what `other` misses."""
        passed = {item.id for item in other.items if item.status is ItemStatus.PASSED}
        if any(item.status is ItemStatus.PASSED and item.id not in passed for item in self.items):
            return True
        missing = summed(item.points for item in other.items) - other.score
        return self.score - other.score >= max(_LEAST_POINTS, _LEAST_SHARE * missing)


GradeText = Callable[[str, Assignment, bool], Graded]
"""Grades a text for an assignment; traced, if the last argument says so."""


def run_work_s(commands: int, steps: int, status: RunStatus) -> float:
    """Return the counted work of one run."""
    further = max(commands - _MANY_COMMANDS, 0)  # of a script that makes more and more of something
    return (
        _RUN_S
        + commands * _COMMAND_S
        + further * _FURTHER_COMMAND_S
        + steps * _STEP_S
        + (_SPOILT_S if status in _SPOILT else 0.0)
    )


class Search:
    """One search for changes, within its budget."""

    def __init__(self, assignment: Assignment, grade: GradeText) -> None:
        self._assignment = assignment
        self._later = replace(assignment, horizon_s=assignment.horizon_s + _LATER_S)
        self._grade = grade
        self._tried = 0
        self._work_s = 0.0

    def explanation(self, text: str) -> Explanation:
        """Return the proven changes of a script."""
        changes: list[ProvenChange] = []
        now = self._traced(text)
        while len(changes) < MOST_CHANGES and not now.is_full and self._has_budget:
            found = self._next_change(text, now)
            if found is None:
                break
            candidate, after = found
            if not changes and not after.is_full and self._is_contended(text, now):
                break  # what gains beside two lines that overrule each other is not why
            changes.append(_proven(candidate, text, now, after))
            text = candidate.text
            now = after if after.is_full else self._traced(text)
        cause = None if changes or now.is_full else self._cause(text, now)
        return Explanation(changes=tuple(changes), tried=self._tried, cause=cause)

    @property
    def _has_budget(self) -> bool:
        return self._tried < MOST_TRIALS and self._work_s < MOST_WORK_S

    def _traced(self, text: str) -> Graded:
        graded = self._grade(text, self._assignment, True)
        self._work_s += graded.work_s
        return graded

    def _next_change(
        self, text: str, now: Graded, *, is_second: bool = False
    ) -> tuple[Candidate, Graded] | None:
        """Return the first proposal that gains all, or mends an error; else of those that gain the best one."""
        gaining: list[tuple[Candidate, Graded]] = []
        further: Candidate | None = None
        for candidate in self._candidates(text, now):
            if not self._has_budget:
                break
            self._tried += 1
            after = self._grade(candidate.text, self._assignment, False)
            self._work_s += after.work_s
            if not after.gains_on(now):
                if further is None and _is_further(now.outcome, after.outcome):
                    further = candidate
                continue
            whole = after.is_full or _is_mended(now.outcome, after.outcome, candidate.proposal)
            if not whole and not after.explains(now):
                continue
            if whole and not _goes_on(now.outcome, after.outcome) and self._gains_later(text, candidate.text):
                return candidate, after
            gaining.append((candidate, after))
        # stable: of equal ones the more plausible, and first those that end as the script did
        gaining.sort(key=lambda one: (-one[1].score, _goes_on(now.outcome, one[1].outcome)))
        best = next((one for one in gaining[:3] if self._gains_later(text, one[0].text)), None)
        if best is None and further is not None and self._has_budget and not is_second:
            return self._with_next(text, now, further)
        return best

    def _with_next(self, text: str, now: Graded, first: Candidate) -> tuple[Candidate, Graded] | None:
        """Return a change that gains nothing alone together with the next one, if both gain."""
        second = self._next_change(first.text, self._traced(first.text), is_second=True)
        if second is None or not second[1].gains_on(now):
            return None
        (candidate, after), proposal = second, first.proposal
        both = Proposal(proposal.code, proposal.cost, (), {**proposal.values, "then": candidate.proposal})
        return Candidate(both, candidate.text), after

    def _candidates(self, text: str, now: Graded) -> Iterator[Candidate]:
        error = now.outcome.error
        if now.outcome.status is RunStatus.SYNTAX_ERROR and error is not None:
            return syntax_candidates(text, error)
        seen = self._situation(text, now)
        return iter(()) if seen is None else candidates(seen)

    def _cause(self, text: str, now: Graded) -> StatedCause | None:
        seen = self._situation(text, now)
        cause = None if seen is None else stated_cause(seen)
        if cause is None:
            return None
        values = dict(cause.values)
        if "unit" in values:
            for name in ("size", "wanted"):
                values[name] = number(float(str(values[name])), values["unit"])  # type: ignore[arg-type]
            values["seconds"] = number(float(str(values["seconds"])), "s")
        return StatedCause(
            code=cause.code, line=cause.line, text=say(f"cause.{cause.code}", line=cause.line, **values)
        )

    def _is_contended(self, text: str, now: Graded) -> bool:
        cause = self._cause(text, now)
        return cause is not None and cause.code == "contended"

    def _situation(self, text: str, now: Graded) -> Situation | None:
        """Return what the traced run of a text told; None without a tree, and of a script that tells tales."""
        try:
            script = received_script(text, now.tree)
            ledger = received_ledger(now.ledger)
        except ProtocolError:
            return None
        if script is None:
            return None
        lost = frozenset(
            spec.measure
            for spec in self._assignment.items
            for item in now.items
            if item.id.rpartition("/")[2] == spec.id and item.status is not ItemStatus.PASSED
        )
        return Situation(
            script=script,
            ledger=ledger,
            outcome=now.outcome,
            wanted=wanted_of(self._assignment.in_case(now.case), lost),
            topic=self._assignment.world.cmd_vel_topic,
            lost=lost,
        )

    def _gains_later(self, before: str, after: str) -> bool:
        """Whether a change also gains at another horizon."""
        old, new = (self._grade(text, self._later, False) for text in (before, after))
        self._work_s += old.work_s + new.work_s
        return new.gains_on(old)


def wanted_of(assignment: Assignment, lost: frozenset[str]) -> WantedSizes:
    """Return the sizes that an assignment names: in its options, its path, and the bands of lost items."""
    from grader.checks.kinds import CHECKS, OLDER_NAMES

    turns, lengths, counts = [], [], []
    options: Mapping[str, object] = assignment.options
    sides = options.get("sides")
    if isinstance(sides, int):
        counts.append(sides)
        turns.append(360.0 / sides)
    given = (options.get(name) for name in ("side_m", "other_side_m"))
    lengths += [float(one) for one in given if isinstance(one, int | float)]
    for piece in () if assignment.path is None else assignment.path.pieces:
        turns += [abs(piece.angle_deg)] if piece.angle_deg else []
        lengths += [abs(piece.length_m)] if piece.length_m else []
    measures = CHECKS[OLDER_NAMES.get(assignment.check, assignment.check)].measures
    for item in assignment.items:
        kind, low, high = measures.get(item.measure), item.low, item.high
        if kind is None or item.measure not in lost or not low or low < 0.0:
            continue
        middle = None if high is None else (low + high) / 2.0
        if kind.unit == "deg":
            turns.append(middle or _STEP_DEG * math.ceil(low / _STEP_DEG))
        elif kind.unit == "m":
            lengths.append(middle or _STEP_M * math.ceil(low * 1.01 / _STEP_M))
        elif kind.form == "count" and low.is_integer():
            counts.append(int(low))
    return WantedSizes(_distinct(turns), _distinct(lengths), tuple(dict.fromkeys(counts)))


def _distinct(values: Sequence[float]) -> tuple[float, ...]:
    return tuple(dict.fromkeys(round(value, 4) for value in values))


def _proven(candidate: Candidate, text: str, now: Graded, after: Graded) -> ProvenChange:
    return ProvenChange(
        code=candidate.proposal.code,
        text=_told(candidate.proposal, now.score, after.score),
        lines=tuple(
            ChangedText(number=one.number, before=one.before, after=one.after)
            for one in changed_lines(text, candidate.text)
        ),
        before=now.score,
        after=after.score,
        gains=after.gained_on(now),
    )


def _is_mended(before: RunOutcome, after: RunOutcome, proposal: Proposal) -> bool:
    """Whether a plausible change takes an exception away: what else is wrong is looked for on top of it."""
    return before.error is not None and after.error is None and proposal.cost < _PLAUSIBLE


def _goes_on(before: RunOutcome, after: RunOutcome) -> bool:
    """Whether a script that ended by itself does so no more."""
    return before.status is RunStatus.FINISHED and after.status is RunStatus.INTERRUPTED


def _is_further(before: RunOutcome, after: RunOutcome) -> bool:
    """Whether a script that an exception ended comes further: the same one is gone, and none comes sooner."""
    if before.error is None or before.status not in (RunStatus.CRASHED, RunStatus.SYNTAX_ERROR):
        return False
    if after.error is None:
        return after.status in (RunStatus.FINISHED, RunStatus.INTERRUPTED)
    if before.status is after.status:
        return (after.error.line or 0) > (before.error.line or 0)
    return before.status is RunStatus.SYNTAX_ERROR


def _cause_of(proposal: Proposal) -> Text:
    """Return what a proposal changes, and after it what one that follows changes."""
    values = dict(proposal.values)
    then = values.pop("then", None)
    code = str(values.pop("sentence", proposal.code))
    if code == "scaled" and "size" in values:
        code = "scaled_turn" if values["unit"] == "deg" else "scaled_drive"
        for name in ("size", "wanted"):
            values[name] = number(float(str(values[name])), values["unit"])  # type: ignore[arg-type]
    cause = say(f"change.{code}", **values)
    return join([cause, _cause_of(then)], _SPACE) if isinstance(then, Proposal) else cause


def _told(proposal: Proposal, before: float, after: float) -> Text:
    tried = say("change.tried", before=points(before), after=points(after))
    return say("change.whole", cause=_cause_of(proposal), tried=tried)
