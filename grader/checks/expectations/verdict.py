"""What an expectation is judged by, and the judgement: how much of it is met, what was sent and what came."""

import bisect
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, Final

from grader.checks.measure import Mistake, mistake
from grader.contracts.assignment import Assignment
from grader.contracts.conversation import (
    FORMULA_MARK,
    PATTERN_MARK,
    Conversation,
    Expectation,
    Message,
    Party,
    Sent,
    Step,
    TurtleSample,
    shown,
)
from grader.contracts.formula import FormulaError, formula, matches
from grader.contracts.record import Record
from grader.contracts.scoring import Run
from grader.contracts.text import EMPTY, Text

NS_PER_S: Final = 1e9
_PRECISE: Final = 9  # decimals that count: more of them differ between processors


Reason = Callable[[], Mistake | None]
"""Looks for the reason why something is not met. It is called when the points are final."""


def unknown() -> Mistake | None:
    """Return no reason."""
    return None


def because(code: str, /, **values: object) -> Reason:
    """Return a reason that is known already."""
    return lambda: mistake(code, **values)


class Verdict(Record):
    """How much of an expectation is met.

    Attributes:
        share: from 0 to 1.
        sent: what the script was told, empty where it was told nothing. wanted, came: what was to come, and did.
        why: looks for the reason.
    """

    share: float
    sent: str = ""
    wanted: Text = EMPTY
    came: Text = EMPTY
    why: Reason = unknown


class Evidence:
    """One run with its conversation, as the judges of expectations look at it."""

    def __init__(self, assignment: Assignment, run: Run) -> None:
        self.assignment = assignment
        self.run = run
        self.talk = run.conversation or Conversation()
        self.horizon_s = assignment.horizon_s
        self._parties = {party.id: party for party in self.talk.parties}
        self._times = {
            name: [sample.t_ns for sample in samples] for name, samples in self.talk.turtles.items()
        }

    def step(self, step_id: str) -> Step:
        """Return a step of the assignment."""
        return next(step for step in self.assignment.steps if step.id == step_id)

    def exchanges(self, step_id: str) -> list[Sent]:
        """Return what a step's messages, calls or goals came to."""
        return [exchange for exchange in self.talk.exchanges if exchange.step == step_id]

    def exchanges_looked_at(self, expectation: Expectation) -> list[Sent]:
        """Return what a step came to in the time that is looked at: each is to have an answer."""
        exchanges = self.exchanges(expectation.step)
        return [
            exchange
            for exchange in exchanges
            if exchange.sent_ns is None or self.looks_at(expectation, exchange.sent_ns)
        ]

    def messages(self, expectation: Expectation) -> list[Message]:
        """Return the messages on the expectation's topic that it looks at."""
        found = [
            heard
            for heard in self.talk.heard.get(expectation.target, ())
            if self.looks_at(expectation, heard.t_ns)
        ]
        if expectation.node is not None:
            found = [heard for heard in found if self._parties[heard.party].node == expectation.node]
        return [
            heard
            for heard in found
            if expectation.joins_s is None or self._reaches(expectation, heard, found)
        ]

    def _reaches(self, expectation: Expectation, message: Message, found: Sequence[Message]) -> bool:
        """Whether a message reaches a listener that comes late: later ones do, earlier ones if they are kept."""
        joins_ns = (expectation.joins_s or 0.0) * NS_PER_S
        if message.t_ns >= joins_ns:
            return True
        party = self._parties[message.party]
        gone = party.until_ns is not None and party.until_ns < joins_ns
        later = [
            heard for heard in found if heard.party == message.party and message.t_ns < heard.t_ns < joins_ns
        ]
        return party.transient_local and not gone and len(later) < party.depth

    def looks_at(self, expectation: Expectation, t_ns: int) -> bool:
        """Whether an instant lies in what the expectation looks at."""
        return expectation.from_s * NS_PER_S <= t_ns <= self.until_s(expectation) * NS_PER_S

    def until_s(self, expectation: Expectation) -> float:
        """Return the end of what the expectation looks at."""
        return self.horizon_s if expectation.until_s is None else expectation.until_s

    def parties(self, kind: str, name: str | None = None) -> list[Party]:
        """Return the script's endpoints of a kind, and of that name."""
        return [party for party in self.talk.parties if party.kind == kind and name in (None, party.name)]

    def names(self, t_ns: int | None, **others: Any) -> dict[str, Any]:
        """Return what a formula is given: the time, the turtles' poses then, and `others`."""
        if t_ns is None:
            return others
        turtles = {name: self.turtle(name, t_ns) for name in self.talk.turtles}
        poses = {name: _pose(sample) for name, sample in turtles.items() if sample is not None}
        return {"t": t_ns / NS_PER_S, **poses, **others}

    def said(self, exchange: Sent, t_ns: int | None, **others: Any) -> dict[str, Any]:
        """Return what a formula is given about something that was sent, and all that was sent up to then."""
        sent = [earlier.values for earlier in self.exchanges(exchange.step)[: exchange.n + 1]]
        return self.names(t_ns, n=exchange.n, in_=exchange.values, sent=sent, **others)

    def turtle(self, name: str, t_ns: int) -> TurtleSample | None:
        """Return where a turtle was, between two samples by their mean; None before it came."""
        samples, times = self.talk.turtles.get(name, ()), self._times.get(name, [])
        after = bisect.bisect_left(times, t_ns)
        if after == len(times):
            return samples[-1] if samples else None
        if times[after] == t_ns or after == 0:
            return samples[after] if times[after] <= t_ns + 200_000_000 else None
        return _between(samples[after - 1], samples[after], t_ns)


def _between(before: TurtleSample, after: TurtleSample, t_ns: int) -> TurtleSample:
    part = (t_ns - before.t_ns) / (after.t_ns - before.t_ns)
    turn = math.remainder(after.heading_rad - before.heading_rad, math.tau)
    return TurtleSample(
        t_ns,
        before.x + part * (after.x - before.x),
        before.y + part * (after.y - before.y),
        math.remainder(before.heading_rad + part * turn, math.tau),
        pen=before.pen,
        pen_off=before.pen_off,
    )


def _pose(sample: TurtleSample) -> dict[str, float]:
    return {"x": sample.x, "y": sample.y, "theta": sample.heading_rad}


def resolved(wanted: Any, names: Mapping[str, Any]) -> Any:
    """Return what is wanted, with formulas carried out.

    Raises FormulaError: a formula has no value.
    """
    if isinstance(wanted, Mapping):
        return {name: resolved(each, names) for name, each in wanted.items()}
    if isinstance(wanted, list | tuple):
        return [resolved(value, names) for value in wanted]
    if isinstance(wanted, str) and wanted.startswith(FORMULA_MARK):
        return formula(wanted[1:]).value(names)
    return wanted


def equals(wanted: Any, came: Any, within: float) -> bool:
    """Whether what came is what is wanted: texts may be patterns, fields that are not named may be anything."""
    if isinstance(wanted, Mapping):
        return isinstance(came, Mapping) and all(
            name in came and equals(each, came[name], within) for name, each in wanted.items()
        )
    if isinstance(came, bytes):
        came = list(came)
    if isinstance(wanted, list | tuple):
        return (
            isinstance(came, list)
            and len(came) == len(wanted)
            and all(equals(each, other, within) for each, other in zip(wanted, came, strict=True))
        )
    if isinstance(wanted, str) and isinstance(came, str):
        return matches(wanted[1:], came) if wanted.startswith(PATTERN_MARK) else wanted == came
    if isinstance(wanted, int | float) and isinstance(came, int | float):
        if isinstance(came, bool) or isinstance(wanted, bool):
            return wanted == came
        return wanted == came or round(abs(wanted - came), _PRECISE) <= max(within, _float32(wanted))
    return bool(wanted == came)


def _float32(wanted: float) -> float:
    """Return how far a number may be off because its field has only 32 bits: 24 binary digits."""
    return abs(wanted) * 2.0**-23 if isinstance(wanted, float) else 0.0


def holds(condition: str | None, names: Mapping[str, Any]) -> bool:
    """Whether a condition is true; one without a value is not."""
    if condition is None:
        return True
    try:
        return bool(formula(condition).value(names))
    except FormulaError:
        return False


def wanted_of(wanted: Any, names: Mapping[str, Any]) -> Any:
    """Return what is wanted; None where a formula has no value."""
    try:
        return resolved(wanted, names)
    except FormulaError:
        return None


def closeness(measured: float, wanted: float, tolerance_pct: float = 0.0) -> float:
    """Return 1 within the tolerance, and else how many times one is in the other."""
    if abs(measured - wanted) <= wanted * tolerance_pct / 100.0 + 1e-9:
        return 1.0
    if measured <= 0.0 or wanted <= 0.0:
        return 0.0
    return min(measured / wanted, wanted / measured)


def in_count(number: int, count: tuple[int, int | None] | None) -> float:
    """Return 1 for a number within the bounds, and else how near it comes; without bounds one is enough."""
    least, most = count or (1, None)
    if number < least:
        return number / least
    return 1.0 if most is None or number <= most else most / number


def only(wanted: Any, came: Any) -> Any:
    """Return the fields of what came that something was wanted of."""
    if isinstance(wanted, Mapping) and isinstance(came, Mapping):
        return {name: only(each, came.get(name)) for name, each in wanted.items()}
    return came


def readable(wanted: Any) -> str:
    """Return what is wanted as a row shows it: of a pattern ``<n>`` for a number and ``…`` for any text."""
    return shown(_without_marks(wanted))


def _without_marks(wanted: Any) -> Any:
    if isinstance(wanted, Mapping):
        return {name: _without_marks(each) for name, each in wanted.items()}
    if isinstance(wanted, list | tuple):
        return [_without_marks(value) for value in wanted]
    if isinstance(wanted, str) and wanted.startswith(PATTERN_MARK):
        return wanted[1:].replace("#", "<n>").replace("*", "…")
    return wanted


def plain(text: str) -> Text:
    """Return a text that is the same in both languages."""
    return Text(zh=text, en=text)


def counted(count: tuple[int, int | None] | None) -> str:
    """Return the bounds of a number as they are said: ``3``, ``2–4``, ``≥ 2``."""
    least, most = count or (1, None)
    if most is None:
        return f"≥ {least}"
    return str(least) if least == most else f"{least}–{most}"


def named(found: Iterable[str], most: int = 4) -> str:
    """Return some names as they stand in a sentence."""
    return ", ".join(list(dict.fromkeys(found))[:most]) or "—"
