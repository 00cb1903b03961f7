"""Expectations of the graph and of the turtles: nodes, endpoints, where a turtle is, its pen."""

import math
from functools import partial

from grader.checks.expectations.answers import OWN_TYPES, SEND_GOAL, no_action, not_asked, not_offered
from grader.checks.expectations.topics import fits_quality, not_heard, quality_of, wanted_quality
from grader.checks.expectations.verdict import (
    NS_PER_S,
    Evidence,
    Reason,
    Verdict,
    because,
    holds,
    named,
    plain,
    unknown,
)
from grader.checks.measure import Mistake
from grader.contracts.conversation import Expectation, TurtleSample, clip
from grader.contracts.text import Text
from grader.geometry import exact
from grader.messages import say


def node(expectation: Expectation, evidence: Evidence) -> Verdict:
    """Judge whether there is a node of that name."""
    nodes = evidence.run.outcome.nodes
    if expectation.target in nodes:
        return Verdict(share=1.0)
    why = because("node_name", node=expectation.target, used=named(nodes)) if nodes else unknown
    return Verdict(share=0.0, wanted=plain(expectation.target), came=plain(named(nodes)), why=why)


def endpoint(expectation: Expectation, evidence: Evidence) -> Verdict:
    """Judge whether there is such a subscription, service, client or action."""
    kind = {"listener": "subscription", "service": "service", "client": "client", "action": "service"}[
        expectation.kind
    ]
    name, type_ = expectation.target, expectation.type
    if expectation.kind == "action":
        name, type_ = f"{name}{SEND_GOAL}", f"{type_}_SendGoal"
    there = [] if _gone_before(expectation, evidence) else evidence.parties(kind, name)
    same = [each for each in there if each.type == type_]
    good = [
        each for each in same if expectation.node in (None, each.node) and fits_quality(expectation, each)
    ]
    if good:
        return Verdict(share=1.0)
    own = [party for party in evidence.parties(kind) if not party.type.startswith(OWN_TYPES)]
    came = plain(
        named(f"{each.name.removesuffix(SEND_GOAL)} ({each.type.removesuffix('_SendGoal')})" for each in own)
    )
    wanted = plain(clip(f"{expectation.target} ({expectation.type})"))
    why: Reason = unknown if same else partial(_absent, expectation, evidence)
    if same and expectation.node is not None and all(each.node != expectation.node for each in same):
        wanted, came = plain(expectation.node), plain(named(each.node for each in same))
    elif same:
        wanted, came = plain(wanted_quality(expectation)), plain(quality_of(same[0]))
    return Verdict(share=0.0, wanted=wanted, came=came, why=why)


def _gone_before(expectation: Expectation, evidence: Evidence) -> bool:
    """Whether a service was there, and no longer when it was to be called for the first time."""
    calls = [
        step.id
        for step in evidence.assignment.steps
        if (step.kind, step.target) == ("call", expectation.target)
    ]
    sent = [exchange.sent_ns for step_id in calls for exchange in evidence.exchanges(step_id)]
    return expectation.kind == "service" and bool(sent) and all(sent_ns is None for sent_ns in sent)


def _absent(expectation: Expectation, evidence: Evidence) -> Mistake:
    kind = expectation.type or ""
    if expectation.kind == "listener":
        return not_heard(expectation.target, kind, evidence)
    if expectation.kind == "service":
        return not_offered(expectation.target, kind, evidence)
    if expectation.kind == "action":
        return no_action(expectation.target, kind, evidence)
    return not_asked(expectation.target, kind, evidence)


def turtle(expectation: Expectation, evidence: Evidence) -> Verdict:
    """Judge where a turtle is at a time, or in the end, and its pen; or what holds all the time."""
    samples = [
        each
        for each in evidence.talk.turtles.get(expectation.target, ())
        if evidence.looks_at(expectation, each.t_ns)
    ]
    if not samples:
        used = named(evidence.talk.turtles)
        why = because("turtle_missing", turtle=expectation.target, used=used)
        return Verdict(share=0.0, wanted=plain(expectation.target), came=plain(used), why=why)
    if expectation.that is not None:
        good = [holds(expectation.that, evidence.names(each.t_ns)) for each in samples]
        share = sum(good) / len(good)
        last = samples[-1] if all(good) else samples[len(good) - 1 - good[::-1].index(False)]
        return Verdict(
            share=share, wanted=plain(clip(expectation.that)), came=_turtle_text(expectation, last)
        )
    at_ns = samples[-1].t_ns if expectation.at_s is None else round(expectation.at_s * NS_PER_S)
    sample = evidence.turtle(expectation.target, at_ns) or samples[-1]
    wanted = ", ".join(
        f"{name} = {value}"
        for name in ("x", "y", "heading_deg", "pen", "pen_off")
        if (value := getattr(expectation, name)) is not None
    )
    return Verdict(
        share=_there(expectation, sample), wanted=plain(wanted), came=_turtle_text(expectation, sample)
    )


def _turtle_text(expectation: Expectation, sample: TurtleSample) -> Text:
    heading = math.degrees(sample.heading_rad)
    pen = (
        f", pen = {sample.pen}{' (off)' if sample.pen_off else ''}"
        if expectation.pen or expectation.pen_off is not None
        else ""
    )
    return say(
        "expected.turtle",
        name=expectation.target,
        x=f"{sample.x:.2f}",
        y=f"{sample.y:.2f}",
        heading=f"{heading:.0f}",
        time=f"{sample.t_ns / NS_PER_S:.1f}",
        pen=pen,
    )


def _there(expectation: Expectation, sample: TurtleSample) -> float:
    off = [abs(sample.x - expectation.x)] if expectation.x is not None else []
    off += [abs(sample.y - expectation.y)] if expectation.y is not None else []
    share = 1.0
    if off:
        distance = round(exact.length(off), 6)
        share = (
            1.0
            if distance <= expectation.within
            else max(0.0, 1.0 - distance / (10.0 * max(expectation.within, 0.1)))
        )
    if expectation.heading_deg is not None:
        error = abs(math.remainder(math.degrees(sample.heading_rad) - expectation.heading_deg, 360.0))
        share = min(share, 1.0 if error <= expectation.within_deg else 0.0)
    if expectation.pen is not None and tuple(expectation.pen) != tuple(sample.pen):
        share = 0.0
    if expectation.pen_off is not None and expectation.pen_off is not sample.pen_off:
        share = 0.0
    return share
