"""Expectations of the graph and of the turtles: nodes, endpoints, where a turtle is, its pen."""

import math
from functools import partial
from typing import Final

from grader.checks.expectations.answers import no_action, not_offered
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
from grader.checks.measure import Mistake, mistake
from grader.contracts.conversation import Expectation, TurtleSample, clip
from grader.contracts.text import Text
from grader.geometry import exact
from grader.messages import say

_SEND_GOAL: Final = "/_action/send_goal"
_OWN_TYPES: Final = ("rcl_interfaces/", "lifecycle_msgs/", "action_msgs/")


def node(one: Expectation, evidence: Evidence) -> Verdict:
    """Judge whether there is a node of that name."""
    nodes = evidence.run.outcome.nodes
    if one.target in nodes:
        return Verdict(share=1.0)
    why = because("node_name", node=one.target, used=named(nodes)) if nodes else unknown
    return Verdict(share=0.0, wanted=plain(one.target), came=plain(named(nodes)), why=why)


def endpoint(one: Expectation, evidence: Evidence) -> Verdict:
    """Judge whether there is such a subscription, service, client or action."""
    kind = {"listener": "subscription", "service": "service", "client": "client", "action": "service"}[
        one.kind
    ]
    name, type_ = one.target, one.type
    if one.kind == "action":
        name, type_ = f"{name}{_SEND_GOAL}", f"{type_}_SendGoal"
    there = [] if _gone_before(one, evidence) else evidence.parties(kind, name)
    same = [each for each in there if each.type == type_]
    good = [each for each in same if one.node in (None, each.node) and fits_quality(one, each)]
    if good:
        return Verdict(share=1.0)
    own = [each for each in evidence.parties(kind) if not each.type.startswith(_OWN_TYPES)]
    came = plain(
        named(f"{each.name.removesuffix(_SEND_GOAL)} ({each.type.removesuffix('_SendGoal')})" for each in own)
    )
    wanted = plain(clip(f"{one.target} ({one.type})"))
    why: Reason = unknown if same else partial(_absent, one, evidence)
    if same and one.node is not None and all(each.node != one.node for each in same):
        wanted, came = plain(one.node), plain(named(each.node for each in same))
    elif same:
        wanted, came = plain(wanted_quality(one)), plain(quality_of(same[0]))
    return Verdict(share=0.0, wanted=wanted, came=came, why=why)


def _gone_before(one: Expectation, evidence: Evidence) -> bool:
    """Whether a service was there, and no longer when it was to be called for the first time."""
    calls = [
        step.id for step in evidence.assignment.steps if (step.kind, step.target) == ("call", one.target)
    ]
    sent = [each.sent_ns for step_id in calls for each in evidence.exchanges(step_id)]
    return one.kind == "service" and bool(sent) and all(sent_ns is None for sent_ns in sent)


def _absent(one: Expectation, evidence: Evidence) -> Mistake:
    kind = one.type or ""
    if one.kind == "listener":
        return not_heard(one.target, kind, evidence)
    if one.kind == "service":
        return not_offered(one.target, kind, evidence)
    if one.kind == "action":
        return no_action(one.target, kind, evidence)
    others = [each.name for each in evidence.parties("client") if not each.type.startswith(_OWN_TYPES)]
    return mistake("client_missing", service=one.target, type=kind, used=named(others))


def turtle(one: Expectation, evidence: Evidence) -> Verdict:
    """Judge where a turtle is at a time, or in the end, and its pen; or what holds all the time."""
    samples = [
        each for each in evidence.talk.turtles.get(one.target, ()) if evidence.looks_at(one, each.t_ns)
    ]
    if not samples:
        used = named(evidence.talk.turtles)
        why = because("turtle_missing", turtle=one.target, used=used)
        return Verdict(share=0.0, wanted=plain(one.target), came=plain(used), why=why)
    if one.that is not None:
        good = [holds(one.that, evidence.names(each.t_ns)) for each in samples]
        share = sum(good) / len(good)
        last = samples[-1] if all(good) else samples[len(good) - 1 - good[::-1].index(False)]
        return Verdict(share=share, wanted=plain(clip(one.that)), came=_told(one, last))
    at_ns = samples[-1].t_ns if one.at_s is None else round(one.at_s * NS_PER_S)
    sample = evidence.turtle(one.target, at_ns) or samples[-1]
    wanted = ", ".join(
        f"{name} = {value}"
        for name in ("x", "y", "heading_deg", "pen", "pen_off")
        if (value := getattr(one, name)) is not None
    )
    return Verdict(share=_there(one, sample), wanted=plain(wanted), came=_told(one, sample))


def _told(one: Expectation, sample: TurtleSample) -> Text:
    heading = math.degrees(sample.heading_rad)
    pen = (
        f", pen = {sample.pen}{' (off)' if sample.pen_off else ''}"
        if one.pen or one.pen_off is not None
        else ""
    )
    return say(
        "expected.turtle", name=one.target, x=f"{sample.x:.2f}", y=f"{sample.y:.2f}", heading=f"{heading:.0f}",
        time=f"{sample.t_ns / NS_PER_S:.1f}", pen=pen,
    )  # fmt: skip


def _there(one: Expectation, sample: TurtleSample) -> float:
    off = [abs(sample.x - one.x)] if one.x is not None else []
    off += [abs(sample.y - one.y)] if one.y is not None else []
    share = 1.0
    if off:
        distance = round(exact.length(off), 6)
        share = 1.0 if distance <= one.within else max(0.0, 1.0 - distance / (10.0 * max(one.within, 0.1)))
    if one.heading_deg is not None:
        error = abs(math.remainder(math.degrees(sample.heading_rad) - one.heading_deg, 360.0))
        share = min(share, 1.0 if error <= one.within_deg else 0.0)
    if one.pen is not None and tuple(one.pen) != tuple(sample.pen):
        share = 0.0
    if one.pen_off is not None and one.pen_off is not sample.pen_off:
        share = 0.0
    return share
