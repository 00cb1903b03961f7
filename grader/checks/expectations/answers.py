"""Expectations of services, actions and parameters: what the script answered to what a step asked."""

import itertools
from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any, Final

from grader.checks.expectations.verdict import (
    NS_PER_S,
    Evidence,
    Reason,
    Verdict,
    because,
    counted,
    equals,
    holds,
    in_count,
    named,
    only,
    plain,
    readable,
    unknown,
    wanted_of,
)
from grader.checks.measure import Mistake, mistake
from grader.checks.mistakes import error_caught
from grader.contracts.conversation import Expectation, Sent, Step, clip, plain_parameter, shown
from grader.contracts.outcome import RunStatus
from grader.contracts.text import EMPTY, Text
from grader.messages import join, say
from grader.messages.quantity import number

_AND = Text(zh="；", en="; ")
_OWN_TYPES: Final = ("rcl_interfaces/", "lifecycle_msgs/", "action_msgs/")
_SEND_GOAL: Final = "/_action/send_goal"


def answer(one: Expectation, evidence: Evidence) -> Verdict:
    """Judge the answers to the calls of a step."""
    step, exchanges = evidence.step(one.target), evidence.exchanges(one.target)
    good, row = 0, None
    for exchange in exchanges:
        names = evidence.said(exchange, exchange.answered_ns, out=exchange.answer)
        wanted = None if one.values is None else wanted_of(one.values, names)
        fits = _answered(one, exchange) and (
            one.values is None or equals(wanted, exchange.answer, one.within)
        )
        fits = fits and holds(one.that, names)
        good += fits
        if not fits and row is None:
            row = (exchange, wanted)
    share = good / max(len(exchanges), 1)
    if row is None:
        return Verdict(share=share)
    exchange, wanted = row
    parts = [plain(readable(wanted))] if wanted is not None else []
    parts += [plain(clip(one.that))] if one.that else []
    parts += [say("expected.within", time=number(one.within_s, "s"))] if one.within_s is not None else []
    told = join(parts, _AND) if parts else say("expected.an_answer")
    came = _came(one, exchange, exchange.answer, one.values)

    def why() -> Mistake | None:
        return _unanswered(step, exchanges, evidence) or _late(one, step, exchanges)

    return Verdict(share=share, sent=shown(exchange.values), wanted=told, came=came, why=why)


def _answered(one: Expectation, exchange: Sent) -> bool:
    if exchange.answered_ns is None or exchange.sent_ns is None or exchange.answer is None:
        return False
    return one.within_s is None or exchange.answered_ns - exchange.sent_ns <= one.within_s * NS_PER_S


def _came(one: Expectation, exchange: Sent, values: Any, wanted: Any) -> Text:
    if exchange.sent_ns is None:
        return say("expected.not_there")
    if exchange.answered_ns is None:
        return say("expected.no_answer")
    if values is None:
        return say("expected.unreadable")
    told = plain(shown(only(wanted, values) if wanted else values))
    if one.within_s is not None:
        took = number((exchange.answered_ns - exchange.sent_ns) / NS_PER_S, "s", 3)
        return join([told, say("expected.after", time=took)], _AND)
    return told


def _late(one: Expectation, step: Step, exchanges: Sequence[Sent]) -> Mistake | None:
    """Return that answers came late: something in a callback takes long."""
    if one.within_s is None:
        return None
    late = [
        each.answered_ns - each.sent_ns
        for each in exchanges
        if each.answered_ns is not None
        and each.sent_ns is not None
        and each.answered_ns - each.sent_ns > one.within_s * NS_PER_S
    ]
    if not late:
        return None
    took, most = number(min(late) / NS_PER_S, "s", 2), number(one.within_s, "s", 2)
    return mistake(
        "answers_late", name=step.target, took=took, most=most, late=len(late), count=len(exchanges)
    )


def _unanswered(step: Step, exchanges: Sequence[Sent], evidence: Evidence) -> Mistake | None:
    """Return why a call was not answered."""
    missing = [each for each in exchanges if each.answered_ns is None]
    if not missing:
        return None
    if missing[0].sent_ns is None:
        return not_offered(step.target, step.type, evidence)
    outcome = evidence.run.outcome
    if outcome.status is RunStatus.FINISHED:
        return mistake("not_spinning", ended=number(outcome.duration_ns / 1e9, "s"))
    if len(missing) < len(exchanges):
        done = len(exchanges) - len(missing)
        return mistake(
            "answers_missing", name=step.target, count=len(exchanges), done=done, took=_pace(exchanges)
        )
    return mistake("service_silent", service=step.target)


def _pace(exchanges: Sequence[Sent]) -> str:
    """Return how long one answer takes: the time from one to the next, or of the only one."""
    times = sorted(each.answered_ns for each in exchanges if each.answered_ns is not None)
    gaps = [b - a for a, b in itertools.pairwise(times)]
    first = [each.answered_ns - (each.sent_ns or 0) for each in exchanges if each.answered_ns is not None]
    return number(min(gaps or first) / NS_PER_S, "s", 2)


def not_offered(name: str, kind: str, evidence: Evidence) -> Mistake:
    """Return why a service was never there to be called."""
    same = evidence.parties("service", name)
    if same and same[0].type != kind:
        return mistake("other_type", name=name, type=same[0].type, wanted=kind)
    ended = number(evidence.run.outcome.duration_ns / 1e9, "s")
    if same:
        return mistake("not_spinning", ended=ended)
    if kind.startswith("lifecycle_msgs/"):  # rclpy offers it, under the node's name
        nodes, own_node = evidence.run.outcome.nodes, name.rpartition("/")[0]
        if nodes and own_node not in nodes:
            return mistake("node_name", node=own_node, used=named(nodes))
        return mistake("not_lifecycle", node=own_node)
    others = {step.target for step in evidence.assignment.steps}  # which the script is to offer as well
    own = [
        f"{each.name} ({each.type})"
        for each in evidence.parties("service")
        if not each.type.startswith(_OWN_TYPES) and "/_action/" not in each.name and each.name not in others
    ]
    if own:
        return mistake("other_name", used=named(own), name=name)
    return mistake("no_service", service=name, type=kind)


def goal(one: Expectation, evidence: Evidence) -> Verdict:
    """Judge what became of the goals of a step."""
    step, exchanges = evidence.step(one.target), evidence.exchanges(one.target)
    share, row = 0.0, None
    for exchange in exchanges:
        parts = list(_goal_parts(one, evidence, exchange))
        degree = min((each[0] for each in parts), default=1.0)
        share += degree / max(len(exchanges), 1)
        if degree < 1.0 and row is None:
            row = (exchange, min(parts, key=lambda each: each[0]))
    if row is None:
        return Verdict(share=1.0 if exchanges else 0.0)
    exchange, (_, wanted, came, why) = row
    sent = shown(exchange.values)
    return Verdict(
        share=share,
        sent=sent,
        wanted=wanted,
        came=came,
        why=lambda: _without_action(step, exchange, evidence) or _raised(exchange, evidence) or why(),
    )


def _raised(goal: Sent, evidence: Evidence) -> Mistake | None:
    """Return the exception that left the callback of a goal: rclpy catches it, and aborts the goal."""
    return error_caught(evidence.run) if goal.status.lower() == "aborted" else None


def _goal_parts(one: Expectation, evidence: Evidence, goal: Sent) -> list[tuple[float, Text, Text, Reason]]:
    """Return for each part of what is wanted of a goal: how much is met, what was wanted, what came, why."""
    if goal.sent_ns is None or goal.accepted is None:
        came = say("expected.not_there") if goal.sent_ns is None else say("expected.no_answer")
        return [(0.0, say("expected.accepted"), came, unknown)]
    parts: list[tuple[float, Text, Text, Reason]] = []
    rejected = because("goal_rejected", name=evidence.step(one.target).target)
    if one.accepted is not None:
        word = {True: "accepted", False: "rejected"}
        why = rejected if one.accepted else because("goal_not_rejected", sent=shown(goal.values))
        told = say(f"expected.{word[one.accepted]}"), say(f"expected.{word[goal.accepted]}")
        parts.append((float(goal.accepted is one.accepted), *told, why))
    if not goal.accepted and one.accepted is None:
        parts.append((0.0, say("expected.accepted"), say("expected.rejected"), rejected))
    if goal.accepted:
        parts += [_state(one, evidence, goal), *_result(one, evidence, goal), *_feedback(one, evidence, goal)]
    return parts


def _state(one: Expectation, evidence: Evidence, goal: Sent) -> tuple[float, Text, Text, Reason]:
    status, name = goal.status.lower(), evidence.step(one.target).target
    if one.status is None:
        return 1.0, EMPTY, EMPTY, unknown
    came = plain(goal.status) if status else say("expected.no_result")
    why = unknown
    if not status:
        why = because("goal_endless", name=name)
    elif goal.cancelled_ns is not None and one.status == "canceled":
        why = because("cancel_ignored", name=name, status=goal.status)
    elif status == "aborted" and one.status == "succeeded":
        why = because("goal_aborted", name=name)
    return float(status == one.status), plain(one.status.upper()), came, why


def _result(one: Expectation, evidence: Evidence, goal: Sent) -> list[tuple[float, Text, Text, Reason]]:
    names = evidence.said(goal, goal.answered_ns, out=goal.answer)
    parts: list[tuple[float, Text, Text, Reason]] = []
    came = say("expected.no_result") if goal.answer is None else plain(shown(goal.answer))
    if one.values is not None:
        wanted = wanted_of(one.values, names)
        fits = goal.answer is not None and equals(wanted, goal.answer, one.within)
        parts.append((float(fits), plain(shown(wanted)), came, unknown))
    if one.that is not None:
        fits = goal.answer is not None and holds(one.that, names)
        parts.append((float(fits), plain(clip(one.that)), came, unknown))
    if one.within_s is not None:
        took_s = None if goal.answered_ns is None else (goal.answered_ns - (goal.sent_ns or 0)) / NS_PER_S
        told = came if took_s is None else say("expected.after", time=number(took_s, "s", 2))
        in_time = took_s is not None and took_s <= one.within_s
        parts.append(
            (float(in_time), say("expected.within", time=number(one.within_s, "s", 2)), told, unknown)
        )
    return parts


def _feedback(one: Expectation, evidence: Evidence, goal: Sent) -> list[tuple[float, Text, Text, Reason]]:
    parts: list[tuple[float, Text, Text, Reason]] = []
    name = evidence.step(one.target).target
    if one.feedback_count is not None:
        count = len(goal.feedback)
        why = unknown if count else because("no_feedback", name=name)
        told = say("expected.feedback", count=counted(one.feedback_count)), say("expected.came", count=count)
        parts.append((in_count(count, one.feedback_count), *told, why))
    if one.feedback is not None or one.feedback_that is not None:
        parts.append(_feedback_values(one, evidence, goal))
    return parts


def _feedback_values(one: Expectation, evidence: Evidence, goal: Sent) -> tuple[float, Text, Text, Reason]:
    before: Mapping[str, Any] | None = None
    good, bad = 0, None
    for n, each in enumerate(goal.feedback):
        names = {**evidence.said(goal, each.t_ns), "n": n, "out": each.values, "before": before}
        wanted = None if one.feedback is None else wanted_of(one.feedback, names)
        fits = one.feedback is None or equals(wanted, each.values, one.within)
        fits = fits and (
            (before is None and "before" in (one.feedback_that or "")) or holds(one.feedback_that, names)
        )
        good += fits
        bad = (wanted, each.values) if not fits and bad is None else bad
        before = each.values
    wanted_text = clip(one.feedback_that or "") or readable(one.feedback if bad is None else bad[0])
    came = say("expected.no_feedback") if not goal.feedback else plain("" if bad is None else shown(bad[1]))
    why = unknown if goal.feedback else because("no_feedback", name=evidence.step(one.target).target)
    return good / max(len(goal.feedback), 1), plain(wanted_text), came, why


def _without_action(step: Step, exchange: Sent, evidence: Evidence) -> Mistake | None:
    """Return why a goal could not be sent, or was never answered."""
    if exchange.sent_ns is None:
        return no_action(step.target, step.type, evidence)
    if exchange.accepted is None:
        return mistake("service_silent", service=step.target)
    return None


def no_action(name: str, kind: str, evidence: Evidence) -> Mistake:
    """Return why an action was never there."""
    servers = {
        each.name.removesuffix(_SEND_GOAL): each.type.removesuffix("_SendGoal")
        for each in evidence.parties("service")
        if each.name.endswith(_SEND_GOAL)
    }
    if name in servers:
        if servers[name] != kind:
            return mistake("other_type", name=name, type=servers[name], wanted=kind)
        return mistake("not_spinning", ended=number(evidence.run.outcome.duration_ns / 1e9, "s"))
    if servers:
        return mistake("other_name", name=name, used=named(servers))
    return mistake("no_action", action=name, type=kind)


def settings(one: Expectation, evidence: Evidence) -> Verdict:
    """Judge whether the parameters of a step could be set, and what was said of those that could not."""
    exchanges, good, row = evidence.exchanges(one.target), 0, None
    for exchange in exchanges:
        results = (exchange.answer or {}).get("results", [])
        fits = bool(results) and all(
            one.successful in (None, each["successful"])
            and (one.reason is None or equals(one.reason, each["reason"], 0.0))
            for each in results
        )
        good += fits
        if not fits and row is None:
            row = exchange
    if row is None:
        return Verdict(share=1.0 if exchanges else 0.0)
    results = (row.answer or {}).get("results", [])
    node = evidence.step(one.target).target
    why = unknown
    if row.sent_ns is None:
        why = partial(_no_node, node, evidence)
    elif not results:
        why = because("service_silent", service=f"{node}/set_parameters")
    elif one.successful is False and results[0]["successful"]:
        why = because("setting_taken", sent=shown(row.values), node=node)
    came = plain(shown(results[0])) if results else _came(one, row, row.answer, None)
    told = {"successful": one.successful, "reason": one.reason}
    wanted = plain(readable({name: each for name, each in told.items() if each is not None}))
    share = good / max(len(exchanges), 1)
    return Verdict(share=share, sent=shown(row.values), wanted=wanted, came=came, why=why)


def parameter(one: Expectation, evidence: Evidence) -> Verdict:
    """Judge a parameter, as a step got it, or as its node declared and set it."""
    if one.node is not None:
        return _parameter_told(one, evidence)
    exchange = next(iter(evidence.exchanges(one.step)), None)
    node = evidence.step(one.step).target
    if exchange is None or exchange.sent_ns is None:
        return Verdict(
            share=0.0,
            wanted=plain(one.target),
            came=say("expected.not_there"),
            why=partial(_no_node, node, evidence),
        )
    came = (exchange.answer or {}).get(one.target) or {}
    if exchange.answer is None:
        why = because("service_silent", service=f"{node}/get_parameters")
        return Verdict(share=0.0, wanted=plain(one.target), came=say("expected.no_answer"), why=why)
    if "type" not in came:
        others = sorted(each for each, told in (exchange.answer or {}).items() if told)
        why = because("declared_missing", name=one.target, node=node, others=named(others))
        return Verdict(share=0.0, wanted=plain(one.target), came=say("expected.not_declared"), why=why)
    return _parameter_fits(one, came)


def _parameter_told(one: Expectation, evidence: Evidence) -> Verdict:
    """Judge a parameter by what its node told on /parameter_events, which needs nobody who spins."""
    declared: dict[str, Mapping[str, Any]] = {}
    for message in evidence.talk.heard.get("/parameter_events", ()):
        event = message.values or {}
        if event.get("node") == one.node:
            for each in (*event["new_parameters"], *event["changed_parameters"]):
                declared[each["name"]] = each["value"]
    told = plain_parameter(declared[one.target]) if one.target in declared else None
    if told is None:
        node = one.node or ""
        if node not in evidence.run.outcome.nodes:
            why: Reason = because("node_name", node=node, used=named(evidence.run.outcome.nodes))
        else:
            others = named(each for each in declared if each != "use_sim_time")
            why = because("declared_missing", name=one.target, node=node, others=others)
        return Verdict(share=0.0, wanted=plain(one.target), came=say("expected.not_declared"), why=why)
    return _parameter_fits(one, {"type": told[0], "value": told[1]})


def _parameter_fits(one: Expectation, came: Mapping[str, Any]) -> Verdict:
    parts = list(_parameter_parts(one, came))
    met = sum(fits for fits, *_ in parts)
    bad = next(((wanted, told) for fits, wanted, told in parts if not fits), None)
    if bad is None:
        return Verdict(share=1.0)
    wanted, told = bad
    return Verdict(share=met / len(parts), wanted=plain(f"{one.target}: {wanted}"), came=plain(told))


def _parameter_parts(one: Expectation, came: Mapping[str, Any]) -> list[tuple[bool, str, str]]:
    """Return for each part that is wanted of a parameter: whether it is met, what was wanted, what is."""
    descriptor = came.get("descriptor") or {}
    parts = [(True, one.target, one.target)]
    if one.type is not None:
        parts.append((came["type"] == one.type, one.type, str(came["type"])))
    if one.value is not None:
        value = wanted_of(one.value, {})
        parts.append((equals(value, came["value"], one.within), shown(value), shown(came["value"])))
    if one.low is not None or one.high is not None:
        ranges = [*descriptor.get("floating_point_range", ()), *descriptor.get("integer_range", ())]
        ends = (ranges[0]["from_value"], ranges[0]["to_value"]) if ranges else (None, None)
        fits = bool(ranges) and all(
            w is None or equals(w, e, 1e-9) for w, e in zip((one.low, one.high), ends, strict=True)
        )
        told = f"{ends[0]:g} … {ends[1]:g}" if ranges else "—"
        wanted = (
            f"{'' if one.low is None else f'{one.low:g}'} … {'' if one.high is None else f'{one.high:g}'}"
        )
        parts.append((fits, wanted, told))
    if one.read_only is not None:
        is_read_only = bool(descriptor.get("read_only"))
        wanted = "read_only" if one.read_only else "not read_only"
        told = "read_only" if is_read_only else "not read_only"
        parts.append((is_read_only is one.read_only, wanted, told))
    return parts


def _no_node(node: str, evidence: Evidence) -> Mistake:
    nodes = evidence.run.outcome.nodes
    if node in nodes:
        return mistake("service_silent", service=f"{node}/set_parameters")
    return mistake("node_name", node=node, used=named(nodes))


def served(one: Expectation, evidence: Evidence) -> Verdict:
    """Judge the script's requests to a service that a step serves."""
    step = evidence.step(one.target)
    requests = [
        each for each in evidence.talk.served if each.step == one.target and evidence.looks_at(one, each.t_ns)
    ]
    count = in_count(len(requests), one.count)
    good, bad = 0, None
    for n, each in enumerate(requests):
        names = evidence.names(each.t_ns, n=n, out=each.values)
        wanted = None if one.values is None else wanted_of(one.values, names)
        fits = (one.values is None or equals(wanted, each.values, one.within)) and holds(one.that, names)
        good += fits
        bad = each if not fits and bad is None else bad
    share = min(count, good / max(len(requests), 1)) if requests else float(count >= 1.0)
    if share >= 1.0:
        return Verdict(share=1.0)
    wanted_text = say("expected.requests", count=counted(one.count))
    if one.values is not None or one.that is not None:
        wanted_text = join([wanted_text, plain(clip(one.that or "") or readable(one.values))], _AND)
    came = say("expected.came", count=len(requests)) if bad is None else plain(shown(bad.values))
    why = unknown if requests else partial(_never_asked, step, evidence)
    return Verdict(share=share, wanted=wanted_text, came=came, why=why)


def _never_asked(step: Step, evidence: Evidence) -> Mistake:
    same = evidence.parties("client", step.target)
    if same and same[0].type != step.type:
        return mistake("other_type", name=step.target, type=same[0].type, wanted=step.type)
    if same:
        return mistake("client_silent", service=step.target)
    others = [each.name for each in evidence.parties("client") if not each.type.startswith(_OWN_TYPES)]
    return mistake("client_missing", service=step.target, type=step.type, used=named(others))
