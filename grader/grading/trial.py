"""Looks for a change of a script that gains marks, by grading it: the change is then proven, not guessed.

Everything is graded like the script itself, in the same jail under the same limits. How much is tried is counted
in runs and in what they simulated, never in time, so the same script gets the same explanation on any machine.
"""

import itertools
import math
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

from grader.contracts.assignment import Assignment
from grader.contracts.errors import ProtocolError
from grader.contracts.explanation import ChangedText, Explanation, ProvenChange, StatedCause
from grader.contracts.outcome import RunOutcome, RunStatus, StudentError
from grader.contracts.rubric import ItemStatus, RubricItem, summed
from grader.contracts.text import Text
from grader.edits.asked import asked_of
from grader.edits.causes import stated_cause
from grader.edits.proposals import Candidate, candidates, syntax_candidates
from grader.edits.received import received_ledger, received_script
from grader.edits.situation import OFF_SHARE, Cause, Proposal, Situation, WantedSizes
from grader.edits.slices import calls_of
from grader.edits.tree import changed_lines
from grader.formats.interfaces import standard_entries, structures_of
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
_DELAYED_AT: Final = re.compile(r"^(?=import |from (?!__future__))", re.MULTILINE)
_DELAY: Final = "__import__('time').sleep(0.107)\n"
"""What is told also ends at full marks when Ctrl+C comes later, and when the script begins later, by so many
seconds: it does not only fit the phase of the horizon, or of turtlesim's updates and a robot's scans."""
_NO_FIELD: Final = re.compile(r"'(\w+)' object has no attribute ")
_FITTED: Final = frozenset(("count", "scaled"))
"""Kinds of change whose number is computed from what was wanted: that it has full marks proves little."""
_GUESSED: Final = _FITTED | {"comparison", "converted", "exchanged", "operator", "removed", "sign"}
"""Kinds of change that may gain by chance, because they make up for what is wrong elsewhere."""
_TURNED: Final = frozenset(("comparison", "exchanged"))
"""Kinds of change after which a car that only got stops may drive for ever, for what ended it never comes."""
_UNLIKELY: Final = 4.0  # of cost: what is less plausible is told only where it suffices alone
_AS_LIKELY: Final = 0.5  # of cost: proposals that are no further apart are taken to be equally likely
_SPINS: Final = (
    "await",
    "brackets",
    "call",
    "class",
    "spin",
    "spin_once",
    "spun_early",
    "spun_once",
    "start",
)
"""Changes after which a node runs on, as it is meant to."""
_MOST_BRANCHES: Final = 2
_SHARE_OF_STEP: Final = 0.25
_STEP_DEG: Final = 15.0
_STEP_M: Final = 0.1
"""What is wanted at least is told as the next number of these steps that people use."""
_SIZES: Final = frozenset(("advance_m", "corner_deg", "distance_m", "turned_deg"))
_PLAUSIBLE: Final = 1.0
_LEAST_SHARE: Final = 0.1
_LEAST_POINTS: Final = 3.0
"""A change explains what it gains: of the missing points this share and so many. Less is a side effect of it."""
_SPACE: Final = Text(zh="", en=" ")
_NOTHING_LOST: Final = (ItemStatus.PASSED, ItemStatus.NEEDS_MANUAL)
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
        """Whether nothing is lost that a run can earn."""
        return all(item.status in _NOTHING_LOST for item in self.items)

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
Step = tuple[Candidate, Graded]
"""A change, and what the script has with it."""


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
        is_asked = any(item.expect for item in assignment.items)  # what is expected is so until the horizon
        later = replace(assignment, horizon_s=assignment.horizon_s + _LATER_S)
        self._later = None if is_asked else later
        self._grade = grade
        self._tried = 0
        self._work_s = 0.0

    def explanation(self, text: str) -> Explanation:
        """Return the changes with which a script has full marks; where none are found, what its run shows."""
        begin = self._traced(text)
        if begin.is_full:
            return Explanation()
        changes: list[ProvenChange] = []
        now, at = begin, text
        for candidate, after in self._chain(text, begin, MOST_CHANGES):
            changes.append(_proven(candidate, at, now, after))
            now, at = after, candidate.text
        cause = None if changes else self._cause(text, begin)
        return Explanation(changes=tuple(changes), tried=self._tried, cause=cause)

    def _has_budget(self, share: float = 1.0) -> bool:
        return self._tried < MOST_TRIALS * share and self._work_s < MOST_WORK_S * share

    def _graded(self, text: str, assignment: Assignment, *, traced: bool = False) -> Graded:
        graded = self._grade(text, assignment, traced)
        self._work_s += graded.work_s
        return graded

    def _traced(self, text: str) -> Graded:
        return self._graded(text, self._assignment, traced=True)

    def _chain(self, text: str, now: Graded, left: int) -> list[Step]:
        """Return up to `left` changes, each on top of those before, with the last of which nothing is lost.

        The first proposal that suffices alone is taken. Else the search goes on from a plausible one after which
        the script comes further, or from those that gain most: a share of the budget is left for that.
        """
        proposed = self._candidates(text, now)
        gaining: list[Step] = []
        further: Candidate | None = None
        ran = self._ran(text, now)
        for step in self._trials(text, now, proposed):
            candidate, after = step
            is_further = _is_further(now.outcome, after.outcome, ran)
            if not after.gains_on(now):
                if further is None and is_further:
                    further = candidate
            elif after.is_full or (is_further and candidate.proposal.cost < _PLAUSIBLE):
                if not self._is_trick(text, now, candidate) and (steps := self._continued(text, step, left)):
                    return self._without_rival(text, now, steps, proposed)
            elif after.explains(now) and candidate.proposal.cost < _UNLIKELY:
                gaining.append(step)
            if gaining and not self._has_budget(1.0 - _SHARE_OF_STEP * (left - 1)):
                break
        gaining.sort(key=lambda step: -step[1].score)  # stable: of equal ones the more plausible
        for step in gaining[:_MOST_BRANCHES]:
            if steps := self._continued(text, step, left):
                return steps
        return [] if further is None or left < MOST_CHANGES else self._with_next(now, further, left)

    def _is_trick(self, text: str, now: Graded, candidate: Candidate) -> bool:
        """Whether a change earns all for another reason than what is wrong.

        It keeps a car moving that had come to rest, or a number that was changed for the sake of turns changes the
        drives as well, or the reverse. Or two arguments that are exchanged make the same motions faster.
        """
        proposal = candidate.proposal
        if now.outcome.error is not None or proposal.code in _SPINS:
            return False
        before, after = (
            self._situation(text, now),
            self._situation(candidate.text, self._traced(candidate.text)),
        )
        if before is None or after is None:
            return False
        at_rest = before.comes_to_rest or (proposal.code in _TURNED and not before.driven)
        if at_rest and after.driven and not after.comes_to_rest:
            return True
        if proposal.code == "exchanged" and not now.outcome.hears:
            if len(after.driven) < len(before.driven):
                return True  # so exchanged, a call does nothing
            return all(before.sizes_beside(one) == after.sizes_beside(one) for one in ("deg", "m"))
        unit = str(proposal.values.get("unit", "")) if proposal.code == "scaled" else ""
        sizes, later = (before.sizes_beside(unit), after.sizes_beside(unit)) if unit else ((), ())
        return any(all(abs(one - other) > OFF_SHARE * one for other in later) for one in sizes)

    def _without_rival(
        self, text: str, now: Graded, steps: list[Step], proposed: Iterator[Candidate]
    ) -> list[Step]:
        """Return `steps` if no change of another kind is as likely as the first one and has full marks as well.

        A change that nothing was fitted for is known better than a fitted number, and is returned in its place. Of
        two others neither is known to be the cause.
        """
        first = steps[0][0].proposal
        rivals = _GUESSED - {first.code} - (set() if first.code in _FITTED else _FITTED)
        likely = itertools.takewhile(lambda one: one.proposal.cost <= first.cost + _AS_LIKELY, proposed)
        others = (one for one in likely if one.proposal.code in rivals)
        for candidate, after in self._trials(text, now, others if first.code in _GUESSED else iter(())):
            if after.is_full and self._holds(candidate.text) and not self._is_trick(text, now, candidate):
                is_known = first.code in _FITTED and candidate.proposal.code not in _FITTED
                return [(candidate, after)] if is_known else []
        return steps

    def _trials(self, text: str, now: Graded, proposed: Iterator[Candidate]) -> Iterator[Step]:
        """Yield proposals with what each came to, within the budget.

        Left out are those with which a script that came to its end never does. Of several cases the one that
        failed is run first, and the others only if that gains.
        """
        alone = self._alone_in(now.case)
        before = None if alone is None else self._graded(text, alone)
        ran = frozenset() if alone is None else self._ran(text, now)
        for candidate in proposed:
            if not self._has_budget():
                return
            self._tried += 1
            if alone is not None and before is not None:
                first = self._graded(candidate.text, alone)
                if first.score <= before.score and not _is_further(now.outcome, first.outcome, ran):
                    continue
            after = self._graded(candidate.text, self._assignment)
            if candidate.proposal.code in _SPINS or not _goes_on(now.outcome, after.outcome):
                yield candidate, after

    def _ran(self, text: str, now: Graded) -> frozenset[int]:
        """Return the lines that ran of a script that an exception ended."""
        begun = None if now.outcome.error is None else self._situation(text, now)
        return frozenset() if begun is None else begun.ledger.ran

    def _alone_in(self, case_id: str) -> Assignment | None:
        """Return the assignment with one of its cases; None where it has but one."""
        cases = tuple(case for case in self._assignment.cases if case.id == case_id)
        return (
            replace(self._assignment, cases=cases) if 0 < len(cases) < len(self._assignment.cases) else None
        )

    def _continued(self, text: str, step: Step, left: int) -> list[Step]:
        """Return a step with those that are needed on top of it; nothing where these do not end at full marks."""
        candidate, after = step
        if after.is_full:
            return [step] if self._holds(candidate.text) else []
        if left == 1 or not self._has_budget():
            return []
        rest = self._chain(candidate.text, self._traced(candidate.text), left - 1)
        if not rest or _is_undone(text, candidate.text, rest[-1][0].text):
            return []
        lines = {line.number for line in changed_lines(text, candidate.text) if line.after is not None}
        removed = (one.proposal.values["line"] for one, _ in rest if one.proposal.code == "removed")
        return [] if lines.intersection(removed) else [step, *rest]  # what is removed need not be changed

    def _with_next(self, now: Graded, first: Candidate, left: int) -> list[Step]:
        """Return a change that gains nothing alone as one step with the next one, if both gain."""
        if not self._has_budget():
            return []
        rest = self._chain(first.text, self._traced(first.text), left - 1)
        if not rest or not rest[0][1].gains_on(now):
            return []
        (candidate, after), proposal = rest[0], first.proposal
        both = Proposal(proposal.code, proposal.cost, (), {**proposal.values, "then": candidate.proposal})
        return [(Candidate(both, candidate.text), after), *rest[1:]]

    def _holds(self, text: str) -> bool:
        """Whether a text has full marks also when Ctrl+C comes later, and when it begins between two updates."""
        if self._later is not None and not self._graded(text, self._later).is_full:
            return False
        delayed = _DELAYED_AT.sub(_DELAY, text, count=1)
        return delayed == text or self._graded(delayed, self._assignment).is_full

    def _candidates(self, text: str, now: Graded) -> Iterator[Candidate]:
        error = now.outcome.error
        if now.outcome.status is RunStatus.SYNTAX_ERROR and error is not None:
            return syntax_candidates(text, error)
        situation = self._situation(text, now)
        return iter(()) if situation is None else candidates(situation)

    def _cause(self, text: str, now: Graded) -> StatedCause | None:
        seen = self._situation(text, now)
        cause = None if seen is None else stated_cause(seen)
        if seen is None or cause is None:
            return None
        if cause.code == "drove" and (line := self._ignored_input(text, now, seen)) is not None:
            cause = Cause("input_ignored", line, {"drive": cause.line, **cause.values})
        values = dict(cause.values)
        if "unit" in values:
            for name in ("size", "wanted"):
                values[name] = number(float(str(values[name])), values["unit"])  # type: ignore[arg-type]
            values["seconds"] = number(float(str(values["seconds"])), "s")
        return StatedCause(
            code=cause.code, line=cause.line, text=say(f"cause.{cause.code}", line=cause.line, **values)
        )

    def _ignored_input(self, text: str, now: Graded, seen: Situation) -> int | None:
        """Return the line that reads what a case gives, where the drives of another case are the same."""
        calls = (one for name in ("input", "get_parameter") for one in calls_of(seen.script, name))
        reading = next(calls, None)
        given = {case.id: (case.stdin, case.args) for case in self._assignment.cases}
        other = next((id_ for id_, one in given.items() if one != given.get(now.case)), None)
        alone = None if reading is None or other is None else self._alone_in(other)
        if reading is None or alone is None:
            return None
        there = self._situation(text, self._graded(text, alone, traced=True))
        same = there is not None and there.sizes_beside("deg") == seen.sizes_beside("deg")
        return reading.lineno if same else None

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
            if item.id.rpartition("/")[2] == spec.id and item.status not in _NOTHING_LOST
        )
        assignment = self._assignment.in_case(now.case)
        return Situation(
            script=script,
            ledger=ledger,
            outcome=now.outcome,
            wanted=wanted_of(assignment, lost),
            topic=self._assignment.world.cmd_vel_topic,
            lost=lost,
            fields=_fields_of(now.outcome.error, self._assignment),
            asked=asked_of(assignment, lost),
        )


def _fields_of(error: StudentError | None, assignment: Assignment) -> tuple[str, ...]:
    """Return the fields that a message of ROS has, where an exception says that it lacks one; else none."""
    match = None if error is None else _NO_FIELD.match(error.message)
    if match is None:
        return ()
    entries = (*standard_entries(), *(one.lines for one in assignment.interfaces))
    structures = (one for entry in entries for one in structures_of(entry))
    rows = [members for name, members in structures if name.rpartition("/")[2] == match[1]]
    return tuple(dict.fromkeys(member[0] for members in rows for member in members))


def wanted_of(assignment: Assignment, lost: frozenset[str]) -> WantedSizes:
    """Return the sizes that an assignment names: in its options, its path, and the bands of lost items."""
    from grader.checks.kinds import CHECKS, OLDER_NAMES

    turns, lengths, counts, at_least_m = [], [], [], False
    options: Mapping[str, object] = assignment.options
    sides = options.get("sides")
    if isinstance(sides, int):
        counts.append(sides)
        turns.append(360.0 / sides)
    given = (options.get(name) for name in ("side_m", "other_side_m"))
    lengths += [float(one) for one in given if isinstance(one, int | float)]
    path = assignment.path
    pieces = () if path is None else path.pieces
    for piece in pieces:
        turns += [abs(piece.angle_deg)] if piece.angle_deg else []
        lengths += [abs(piece.length_m)] if piece.length_m else []
    lines = sum(piece.kind == "line" for piece in pieces)
    counts += [lines] if lines else []
    measures = CHECKS[OLDER_NAMES.get(assignment.check, assignment.check)].measures
    for item in assignment.items:
        kind, low, high = measures.get(item.measure), item.low, item.high
        if kind is None or item.measure not in lost or not low or low < 0.0:
            continue
        if kind.form != "count" and (item.measure not in _SIZES or assignment.world.kind == "robot"):
            continue  # a distance to a wall, say, is no way that one motion goes
        middle = None if high is None else (low + high) / 2.0
        if kind.unit == "deg":
            turns.append(middle or _STEP_DEG * math.ceil(low / _STEP_DEG))
        elif kind.unit == "m":
            at_least_m |= high is None and not lengths
            lengths.append(middle or _STEP_M * math.ceil(low * 1.01 / _STEP_M))
        elif kind.form == "count" and low.is_integer():
            counts.append(int(low))
    any_size = path is not None and path.any_scale
    arcs = tuple((0.0 if any_size else one.radius_m, one.angle_deg) for one in pieces if one.kind == "arc")
    return WantedSizes(_distinct(turns), _distinct(lengths), tuple(dict.fromkeys(counts)), arcs, at_least_m)


def _distinct(values: Sequence[float]) -> tuple[float, ...]:
    return tuple(dict.fromkeys(round(value, 4) for value in values))


def _proven(candidate: Candidate, text: str, now: Graded, after: Graded) -> ProvenChange:
    return ProvenChange(
        code=candidate.proposal.code,
        text=_told(candidate.proposal, now.score, after.score),
        lines=tuple(
            ChangedText(number=line.number, before=line.before, after=line.after)
            for line in changed_lines(text, candidate.text)
        ),
        before=now.score,
        after=after.score,
        gains=after.gained_on(now),
    )


def _goes_on(before: RunOutcome, after: RunOutcome) -> bool:
    """Whether a script that came to its end does so no more.

    To draw a figure again and again earns all, so an endless loop would make up for any count.
    """
    drove = before.status is RunStatus.FINISHED and before.command_count > 0
    return drove and after.status is RunStatus.INTERRUPTED


def _is_undone(before: str, after: str, at_last: str) -> bool:
    """Whether a line that a change has changed is as it was in the end."""
    changed = {line.before for line in changed_lines(before, after)} - {None}
    return bool(changed & {line.after for line in changed_lines(after, at_last)})


def _is_further(before: RunOutcome, after: RunOutcome, ran: frozenset[int]) -> bool:
    """Whether a script that an exception ended comes further: the same one is gone, and none comes sooner.

    `ran`: the lines that ran before; an exception in another line comes later.
    """
    if before.error is None or before.status not in (RunStatus.CRASHED, RunStatus.SYNTAX_ERROR):
        return False
    if after.error is None:
        return after.status in (RunStatus.FINISHED, RunStatus.INTERRUPTED)
    if before.status is after.status:
        line = after.error.line or 0
        return line > (before.error.line or 0) or (before.status is RunStatus.CRASHED and line not in ran)
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
