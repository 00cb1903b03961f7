"""Expectations of motion: what the car did from something that was said to the script until the next thing."""

import math
from collections.abc import Iterator, Sequence
from typing import Any, Final

import numpy as np

from grader.checks.expectations.answers import not_offered
from grader.checks.expectations.verdict import Evidence, Verdict, plain, wanted_of
from grader.checks.fit import is_number
from grader.checks.measure import Mistake, mistake
from grader.contracts.conversation import Expectation, Sent, shown
from grader.contracts.record import Record
from grader.contracts.scoring import Run
from grader.contracts.trajectory import COMMAND_LIFE_NS, Trajectory
from grader.geometry import exact
from grader.messages import say
from grader.messages.quantity import number

_OTHER: Final = 0.25  # of the wanted motion: what is off by so much more than is allowed, is another motion


class _Motion(Record):
    """What the car did from `exchange` on: ahead and aside of where it looked then, and the turn to the left."""

    exchange: Sent
    end_ns: int
    wanted_m: float | None
    wanted_deg: float | None
    ahead_m: float
    aside_m: float
    turned_deg: float

    def share(self, expectation: Expectation) -> float:
        """Return how much of what is wanted was done."""
        if self.exchange.sent_ns is None:
            return 0.0
        share = 1.0
        if self.wanted_m is not None:
            off_m = exact.hypot(self.ahead_m - self.wanted_m, self.aside_m)
            share = _credit(off_m, expectation.within, self.wanted_m)
        if self.wanted_deg is not None:
            share = min(
                share,
                _credit(abs(self.turned_deg - self.wanted_deg), expectation.within_deg, self.wanted_deg),
            )
        return share


def moved(expectation: Expectation, evidence: Evidence) -> Verdict:
    """Judge whether the car did what each call, message or goal of a step asks for."""
    motions = list(_motions(expectation, evidence))
    shares = [motion.share(expectation) for motion in motions]
    share = sum(shares) / max(len(shares), 1)
    worst = next((motion for motion, part in zip(motions, shares, strict=True) if part < 1.0), None)
    if worst is None:
        return Verdict(share=share)
    return Verdict(
        share=share,
        sent=shown(worst.exchange.values),
        wanted=plain(_said(expectation, worst.wanted_m, worst.wanted_deg)),
        came=plain(_said(expectation, worst.ahead_m, worst.turned_deg))
        if worst.exchange.sent_ns is not None
        else say("expected.not_there"),
        why=lambda: _why(expectation, evidence, motions),
    )


def _credit(off: float, within: float, wanted: float) -> float:
    """Return what is left of a motion that is off; where none is wanted, nothing at twice what is allowed."""
    beyond, ramp = round(off - within, 9), _OTHER * abs(wanted) or within
    if beyond <= 0.0:
        return 1.0
    return max(0.0, 1.0 - beyond / ramp) if ramp else 0.0


def _said(expectation: Expectation, way_m: float | None, turn_deg: float | None) -> str:
    parts = [number(way_m or 0.0, "m")] if expectation.ahead_m is not None else []
    parts += [number(turn_deg or 0.0, "deg")] if expectation.turned_deg is not None else []
    return ", ".join(parts)


def _motions(expectation: Expectation, evidence: Evidence) -> Iterator[_Motion]:
    track = evidence.run.trajectory
    sent = sorted(each.sent_ns for each in evidence.talk.exchanges if each.sent_ns is not None)
    for exchange in evidence.exchanges(expectation.target):
        begin_ns = exchange.sent_ns or 0
        end_ns = next((t_ns for t_ns in sent if t_ns > begin_ns), track.end_ns)
        names = evidence.said(exchange, exchange.sent_ns)
        begin, end = _place(track, begin_ns), _place(track, end_ns)
        x, y = end[0] - begin[0], end[1] - begin[1]
        cos, sin = exact.cos_sin(begin[2])
        yield _Motion(
            exchange=exchange,
            end_ns=end_ns,
            wanted_m=_wanted_value(expectation.ahead_m, names),
            wanted_deg=_wanted_value(expectation.turned_deg, names),
            ahead_m=x * cos + y * sin,
            aside_m=y * cos - x * sin,
            turned_deg=math.degrees(end[2] - begin[2]),
        )


def _wanted_value(value: float | str | None, names: dict[str, Any]) -> float | None:
    """Return a number that is wanted, 0 where its formula gives none; None where none is."""
    wanted = wanted_of(value, names)
    return None if value is None else float(wanted) if is_number(wanted) else 0.0


def _place(track: Trajectory, t_ns: int) -> tuple[float, float, float]:
    """Return x, y and heading at `t_ns`: a resting car is sampled when it comes to rest and when it leaves."""
    index = max(int(np.searchsorted(track.t_ns, t_ns, side="right")) - 1, 0)
    return float(track.x_m[index]), float(track.y_m[index]), float(track.heading_rad[index])


def _why(expectation: Expectation, evidence: Evidence, motions: Sequence[_Motion]) -> Mistake | None:
    """Return why the car moved otherwise than it was asked to."""
    step = evidence.step(expectation.target)
    if any(motion.exchange.sent_ns is None for motion in motions):
        return not_offered(step.target, step.type, evidence) if step.kind == "call" else None
    return _single_commands(evidence.run, motions)


def _single_commands(run: Run, motions: Sequence[_Motion]) -> Mistake | None:
    """Recognise motions that ended because one command acts for a second only."""
    driven = [(command.t_ns, command.v_mps, command.w_radps) for command in run.trajectory.commands]
    silences = []
    for motion in motions:
        sent_ns = motion.exchange.sent_ns or 0
        begun = [t_ns for t_ns, *twist in driven if sent_ns <= t_ns < motion.end_ns and any(twist)]
        if len(begun) != 1:
            return None
        silences.append(
            next((t_ns for t_ns, *_ in driven if t_ns > begun[0]), run.trajectory.end_ns) - begun[0]
        )
    if not silences or max(silences) <= COMMAND_LIFE_NS:
        return None
    return mistake("published_once", times=len(silences), silence=number(max(silences) / 1e9, "s"))
