"""Ticks of a timer: what they count, and how long that takes."""

import itertools
import math
import re
from collections.abc import Iterator
from typing import Final, NamedTuple

from grader.checks.causes.counts import counted_each_tick
from grader.checks.causes.searched import LOGS, Searched, itself, sets
from grader.checks.measure import Mistake, mistake
from grader.checks.mistakes import motions_of
from grader.contracts.outcome import RunStatus
from grader.messages.arithmetic import value_of
from grader.messages.quantity import number
from grader.messages.script import ScriptText

_EARLY_S: Final = 1.0  # a motion of more was counted in ticks, and has another fault
_FEW_TICKS: Final = 10
_TICKS_OFF: Final = 3  # what a timer's first tick and the tick that changes the command may add
_ABOUT: Final = 1.3  # times what is wanted: 2 s for a turn of 90 degrees at 1 rad/s
_LONG_S: Final = 5.0
_PAUSE_S: Final = 0.2


class _Timer(NamedTuple):
    """The only timer of a script: its callback, where that begins, and its period."""

    callback: str
    begins: int
    period_s: float


class _Limit(NamedTuple):
    """A condition on a count of ticks: the line, the count's name, its limit, and the timer's period."""

    line: int
    name: str
    ticks: float
    period_s: float

    @property
    def took_s(self) -> float:
        """How long that many ticks take."""
        return self.ticks * self.period_s

    def fits(self, lasted_ns: int) -> bool:
        """Whether a motion that lasted so long may have been ended by this limit."""
        return abs(lasted_ns - self.took_s * 1e9) <= _TICKS_OFF * self.period_s * 1e9


def _timer(script: ScriptText) -> _Timer | None:
    timers = script.callbacks("timer")
    if len(timers) != 1:
        return None
    written = script.arguments(timers[0].created, "create_timer")[:1]
    period_s = value_of(written[0], script) if written else None
    return _Timer(timers[0].name, timers[0].begins, period_s) if period_s and period_s > 0.0 else None


def _limits(script: ScriptText) -> Iterator[_Limit]:
    """Yield the conditions in the only timer's callback that compare a count of its ticks with a known number."""
    timer = _timer(script)
    if timer is None:
        return
    for line, text in enumerate(script.block(timer.begins), start=timer.begins):
        found = re.search(r"\bif ([\w.]+) ?(?:<=?|>=?|==) ?([\w.]+) ?:", text)
        count = value_of(found[2], script) if found and counted_each_tick(found[1], script) else None
        if found and count and count >= 1.0:
            yield _Limit(line, found[1], count, timer.period_s)


def counts_ticks(seen: Searched) -> Mistake | None:
    """Find a count of a timer's ticks whose limit is the number of seconds that the motion should take."""
    for limit in _limits(seen.script):
        early = limit.period_s < 1.0 and (limit.took_s <= _EARLY_S or limit.ticks <= _FEW_TICKS)
        if early and not _only_logs(limit, seen.script) and _meant_seconds(limit, seen):
            return _told("counts_ticks", limit)
    return None


def _told(code: str, limit: _Limit) -> Mistake:
    values = {"count": f"{limit.ticks:g}", "took": number(limit.took_s, "s")}
    return mistake(code, line=limit.line, name=limit.name, period=number(limit.period_s, "s", 4), **values)


def _meant_seconds(limit: _Limit, seen: Searched) -> bool:
    """Whether a motion lasted for a count of ticks, and would have been right as long as that many seconds.

    True where that is not known: no motion was commanded, or the check has no such measure.
    """
    measures = [("corner_deg", True), ("turned_deg", True), ("advance_m", False)]
    items = [(seen.assignment.item_on(name), turns) for name, turns in measures]
    item, turns = next(((item, turns) for item, turns in items if item is not None), (None, False))
    motions = [one for one in motions_of(seen.run.trajectory) if (one[0].w_radps if turns else one[0].v_mps)]
    if not motions or item is None or item.low is None:
        return True
    ended = [first for first, lasted_ns in motions if limit.fits(lasted_ns)]
    amounts = [abs(math.degrees(one.w_radps) if turns else one.v_mps) * limit.ticks for one in ended]
    most = math.inf if item.high is None else _ABOUT * item.high
    return any(item.low / _ABOUT <= amount <= most for amount in amounts)


def _only_logs(limit: _Limit, script: ScriptText) -> bool:
    """Whether what a count leads to is only shown: nothing moves or stops because of it."""
    shown = rf"(?:.*{LOGS}|print\()|{re.escape(limit.name)} ?= ?0$"
    body = script.body(limit.line)
    return bool(body) and all(re.match(shown, text) for _, text in body)


def ticks_too_long(seen: Searched) -> Mistake | None:
    """Find a count of ticks that takes longer than the run, or as long as the longest motion in it."""
    ended = seen.run.outcome
    motions = motions_of(seen.run.trajectory)  # the last one may be held for longer than the run
    longest_ns = max((min(lasted_ns, ended.duration_ns - one.t_ns) for one, lasted_ns in motions), default=0)
    for limit in _limits(seen.script):
        beyond = ended.status is RunStatus.INTERRUPTED and limit.took_s * 1e9 > ended.duration_ns
        last = re.search(r"\b(SystemExit|exit\(|shutdown\()", str(seen.script.body(limit.line)))  # of the run
        too_long = (beyond and not last) or (limit.fits(longest_ns) and limit.took_s >= _LONG_S)
        if too_long and not _only_logs(limit, seen.script):
            return _told("ticks_too_long", limit)
    return None


def sleeps_in_callback(seen: Searched) -> Mistake | None:
    """Find a pause in a timer's callback that drives step by step: each tick takes as long as the pause."""
    timer = _timer(seen.script)
    if timer is None:
        return None
    pauses = [text for text in seen.script.block(timer.begins) if re.search(r"\bsleep\(", text)]
    if len(pauses) != 1 or _drives_in_loop(timer, seen.script):
        return None
    for line, text in seen.script.body(timer.begins):
        slept = re.match(r"(?:time\.)?sleep\((.+)\)$", text)
        pause_s = value_of(slept[1], seen.script) if slept else None
        if pause_s is not None and (pause_s >= _PAUSE_S or pause_s > 2.0 * timer.period_s):
            values = {"callback": timer.callback, "pause": number(pause_s, "s")}
            return mistake("sleeps_in_callback", line=line, **values)
    return None


def _drives_in_loop(timer: _Timer, script: ScriptText) -> bool:
    """Whether a callback drives the whole way in a loop of its own: then its pauses are meant."""
    inside = script.span(timer.begins)
    loops = [line for line in script.lines_with(r"^[ \t]*(while|for)\b") if line in inside]
    return any("publish(" in text for line in loops for text in script.block(line))


def count_not_reset(seen: Searched) -> Mistake | None:
    """Find a branch that ends a motion at a count and leaves the count, which another branch sets to 0.

    If that one comes at a higher count, both may be meant as instants on one scale.
    """
    limits = list(_limits(seen.script))
    for limit in limits:
        same = [other for other in limits if other.name == limit.name]
        zeroed = [other for other in same if sets(limit.name, other.line, seen.script)]
        ended = any(limit.fits(lasted_ns) for _, lasted_ns in motions_of(seen.run.trajectory))
        block = seen.script.block(limit.line)[1:]
        goes_on = limit not in zeroed and any(re.match(r"[ \t]*self\.\w+ ?=(?!=)", text) for text in block)
        if ended and goes_on and zeroed and all(other.ticks <= limit.ticks for other in zeroed):
            return mistake("count_not_reset", line=limit.line, name=limit.name)
    return None


def sum_not_reset(seen: Searched) -> Mistake | None:
    """Find a sum of time or way that ends one motion after the other, and that nothing ever sets back to 0.

    One of the next motions then ends at once.
    """
    timer = _timer(seen.script)
    lasted = [lasted_ns / 1e9 for _, lasted_ns in motions_of(seen.run.trajectory)]
    if timer is None or (len(lasted) > 2 and min(lasted[1:4]) > _TICKS_OFF * timer.period_s):
        return None
    block = seen.script.block(timer.begins)
    for line, text in enumerate(block, start=timer.begins):
        found = re.match(r"[ \t]*(?:if|elif) (self\.(\w+)) ?>=? ?([\w.]+) ?:$", text)
        if found is None or not seen.script.lines_with(rf"{re.escape(found[1])} ?\+=(?! ?1$)"):
            continue
        if _runs_on(found[1], found[3], seen.script) or _is_schedule(found[1], block, seen.script):
            continue
        given = seen.script.lines_with(rf"{re.escape(found[1])}\b[^=+*/<>!]{{0,80}}=(?!=)")
        goes_on = any(re.match(r"[ \t]*self\.\w+ ?\+?=(?!=)", one) for one in seen.script.block(line)[1:])
        if goes_on and all(seen.script.function_around(at) == "__init__" for at in given):
            return mistake("sum_not_reset", line=line, name=found[1])
    return None


def _runs_on(name: str, limit: str, script: ScriptText) -> bool:
    """Whether a sum is meant to grow on: its limit grows, too, or what it was before is taken off."""
    return bool(script.lines_with(rf"{itself(limit)} ?[-+]=|{itself(name)} ?-(?!=)"))


def _is_schedule(name: str, block: list[str], script: ScriptText) -> bool:
    """Whether a sum is compared with three or more numbers that rise, or fall: instants, and not durations."""
    found = [re.match(rf"[ \t]*(?:if|elif) {re.escape(name)} ?>=? ?([\w.]+) ?:$", text) for text in block]
    values = [value_of(one[1], script) for one in found if one is not None]
    known = [value for value in values if value is not None]
    in_order = [one < other for one, other in itertools.pairwise(known)]
    return len(known) == len(values) > 2 and len(set(in_order)) == 1
