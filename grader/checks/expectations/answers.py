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
OWN_TYPES: Final = ("rcl_interfaces/", "lifecycle_msgs/", "action_msgs/")
SEND_GOAL: Final = "/_action/send_goal"


def answer(expectation: Expectation, evidence: Evidence) -> Verdict:
    """Judge the answers to the calls of a step."""
    step, exchanges = evidence.step(expectation.target), evidence.exchanges(expectation.target)
    good, row = 0, None
    for exchange in exchanges:
        names = evidence.said(exchange, exchange.answered_ns, out=exchange.answer)
        wanted = None if expectation.values is None else wanted_of(expectation.values, names)
        fits = _answered(expectation, exchange) and (
            expectation.values is None or equals(wanted, exchange.answer, expectation.within)
        )
        fits = fits and holds(expectation.that, names)
        good += fits
        if not fits and row is None:
            row = (exchange, wanted)
    share = good / max(len(exchanges), 1)
    if row is None:
        return Verdict(share=share)
    exchange, wanted = row
    parts = [plain(readable(wanted))] if wanted is not None else []
    parts += [plain(clip(expectation.that))] if expectation.that else []
    parts += (
        [say("expected.within", time=number(expectation.within_s, "s"))]
        if expectation.within_s is not None
        else []
    )
    told = join(parts, _AND) if parts else say("expected.an_answer")
    came = _came(expectation, exchange, exchange.answer, expectation.values)
    why = partial(_unanswered, step, exchanges, evidence)
    return Verdict(share=share, sent=shown(exchange.values), wanted=told, came=came, why=why)


def _answered(expectation: Expectation, exchange: Sent) -> bool:
    if exchange.answered_ns is None or exchange.sent_ns is None or exchange.answer is None:
        return False
    return (
        expectation.within_s is None
        or exchange.answered_ns - exchange.sent_ns <= expectation.within_s * NS_PER_S
    )


def _came(expectation: Expectation, exchange: Sent, values: Any, wanted: Any) -> Text:
    if exchange.sent_ns is None:
        return say("expected.not_there")
    if exchange.answered_ns is None:
        return say("expected.no_answer")
    if values is None:
        return say("expected.unreadable")
    told = plain(shown(only(wanted, values) if wanted else values))
    if expectation.within_s is not None:
        took = number((exchange.answered_ns - exchange.sent_ns) / NS_PER_S, "s", 3)
        return join([told, say("expected.after", time=took)], _AND)
    return told


def _unanswered(step: Step, exchanges: Sequence[Sent], evidence: Evidence) -> Mistake | None:
    """Return why a call was not answered."""
    missing = [exchange for exchange in exchanges if exchange.answered_ns is None]
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
    times = sorted(exchange.answered_ns for exchange in exchanges if exchange.answered_ns is not None)
    gaps = [b - a for a, b in itertools.pairwise(times)]
    first = [
        exchange.answered_ns - (exchange.sent_ns or 0)
        for exchange in exchanges
        if exchange.answered_ns is not None
    ]
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
        f"{party.name} ({party.type})"
        for party in evidence.parties("service")
        if not party.type.startswith(OWN_TYPES) and "/_action/" not in party.name and party.name not in others
    ]
    if own:
        return mistake("other_name", used=named(own), name=name)
    return mistake("no_service", service=name, type=kind)


def goal(expectation: Expectation, evidence: Evidence) -> Verdict:
    """Judge what became of the goals of a step."""
    step, exchanges = evidence.step(expectation.target), evidence.exchanges(expectation.target)
    share, row = 0.0, None
    for exchange in exchanges:
        parts = list(_goal_parts(expectation, evidence, exchange))
        degree = min((part[0] for part in parts), default=1.0)
        share += degree / max(len(exchanges), 1)
        if degree < 1.0 and row is None:
            row = (exchange, min(parts, key=lambda part: part[0]))
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


def _goal_parts(
    expectation: Expectation, evidence: Evidence, goal: Sent
) -> list[tuple[float, Text, Text, Reason]]:
    """Return for each part of what is wanted of a goal: how much is met, what was wanted, what came, why."""
    if goal.sent_ns is None or goal.accepted is None:
        came = say("expected.not_there") if goal.sent_ns is None else say("expected.no_answer")
        return [(0.0, say("expected.accepted"), came, unknown)]
    parts: list[tuple[float, Text, Text, Reason]] = []
    if expectation.accepted is not None:
        word = {True: "accepted", False: "rejected"}
        why = unknown if expectation.accepted else because("goal_not_rejected", sent=shown(goal.values))
        told = say(f"expected.{word[expectation.accepted]}"), say(f"expected.{word[goal.accepted]}")
        parts.append((float(goal.accepted is expectation.accepted), *told, why))
    if not goal.accepted and expectation.accepted is None:
        parts.append((0.0, say("expected.accepted"), say("expected.rejected"), unknown))
    if goal.accepted:
        parts += [
            _state(expectation, evidence, goal),
            *_result(expectation, evidence, goal),
            *_feedback(expectation, evidence, goal),
        ]
    return parts


def _state(expectation: Expectation, evidence: Evidence, goal: Sent) -> tuple[float, Text, Text, Reason]:
    status, name = goal.status.lower(), evidence.step(expectation.target).target
    if expectation.status is None:
        return 1.0, EMPTY, EMPTY, unknown
    came = plain(goal.status) if status else say("expected.no_result")
    why = unknown
    if status and goal.cancelled_ns is not None and expectation.status == "canceled":
        why = because("cancel_ignored", name=name, status=goal.status)
    elif status == "aborted" and expectation.status == "succeeded":
        why = because("goal_aborted", name=name)
    return float(status == expectation.status), plain(expectation.status.upper()), came, why


def _result(
    expectation: Expectation, evidence: Evidence, goal: Sent
) -> list[tuple[float, Text, Text, Reason]]:
    names = evidence.said(goal, goal.answered_ns, out=goal.answer)
    parts: list[tuple[float, Text, Text, Reason]] = []
    came = say("expected.no_result") if goal.answer is None else plain(shown(goal.answer))
    if expectation.values is not None:
        wanted = wanted_of(expectation.values, names)
        fits = goal.answer is not None and equals(wanted, goal.answer, expectation.within)
        parts.append((float(fits), plain(shown(wanted)), came, unknown))
    if expectation.that is not None:
        fits = goal.answer is not None and holds(expectation.that, names)
        parts.append((float(fits), plain(clip(expectation.that)), came, unknown))
    if expectation.within_s is not None:
        took_s = None if goal.answered_ns is None else (goal.answered_ns - (goal.sent_ns or 0)) / NS_PER_S
        told = came if took_s is None else say("expected.after", time=number(took_s, "s", 2))
        in_time = took_s is not None and took_s <= expectation.within_s
        parts.append(
            (float(in_time), say("expected.within", time=number(expectation.within_s, "s", 2)), told, unknown)
        )
    return parts


def _feedback(
    expectation: Expectation, evidence: Evidence, goal: Sent
) -> list[tuple[float, Text, Text, Reason]]:
    parts: list[tuple[float, Text, Text, Reason]] = []
    if expectation.feedback_count is not None:
        count = len(goal.feedback)
        told = (
            say("expected.feedback", count=counted(expectation.feedback_count)),
            say("expected.came", count=count),
        )
        parts.append((in_count(count, expectation.feedback_count), *told, unknown))
    if expectation.feedback is not None or expectation.feedback_that is not None:
        parts.append(_feedback_values(expectation, evidence, goal))
    return parts


def _feedback_values(
    expectation: Expectation, evidence: Evidence, goal: Sent
) -> tuple[float, Text, Text, Reason]:
    before: Mapping[str, Any] | None = None
    good, bad = 0, None
    for n, each in enumerate(goal.feedback):
        names = {**evidence.said(goal, each.t_ns), "n": n, "out": each.values, "before": before}
        wanted = None if expectation.feedback is None else wanted_of(expectation.feedback, names)
        fits = expectation.feedback is None or equals(wanted, each.values, expectation.within)
        fits = fits and (
            (before is None and "before" in (expectation.feedback_that or ""))
            or holds(expectation.feedback_that, names)
        )
        good += fits
        bad = (wanted, each.values) if not fits and bad is None else bad
        before = each.values
    wanted_text = clip(expectation.feedback_that or "") or readable(
        expectation.feedback if bad is None else bad[0]
    )
    came = say("expected.no_feedback") if not goal.feedback else plain("" if bad is None else shown(bad[1]))
    return good / max(len(goal.feedback), 1), plain(wanted_text), came, unknown


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
        party.name.removesuffix(SEND_GOAL): party.type.removesuffix("_SendGoal")
        for party in evidence.parties("service")
        if party.name.endswith(SEND_GOAL)
    }
    if name in servers:
        if servers[name] != kind:
            return mistake("other_type", name=name, type=servers[name], wanted=kind)
        return mistake("not_spinning", ended=number(evidence.run.outcome.duration_ns / 1e9, "s"))
    if servers:
        return mistake("other_name", name=name, used=named(servers))
    return mistake("no_action", action=name, type=kind)


def settings(expectation: Expectation, evidence: Evidence) -> Verdict:
    """Judge whether the parameters of a step could be set, and what was said of those that could not."""
    exchanges, good, row = evidence.exchanges(expectation.target), 0, None
    for exchange in exchanges:
        results = (exchange.answer or {}).get("results", [])
        fits = bool(results) and all(
            expectation.successful in (None, result["successful"])
            and (expectation.reason is None or equals(expectation.reason, result["reason"], 0.0))
            for result in results
        )
        good += fits
        if not fits and row is None:
            row = exchange
    if row is None:
        return Verdict(share=1.0 if exchanges else 0.0)
    results = (row.answer or {}).get("results", [])
    node = evidence.step(expectation.target).target
    why = unknown
    if row.sent_ns is None:
        why = partial(_no_node, node, evidence)
    elif not results:
        why = because("service_silent", service=f"{node}/set_parameters")
    elif expectation.successful is False and results[0]["successful"]:
        why = because("setting_taken", sent=shown(row.values), node=node)
    came = plain(shown(results[0])) if results else _came(expectation, row, row.answer, None)
    told = {"successful": expectation.successful, "reason": expectation.reason}
    wanted = plain(readable({name: each for name, each in told.items() if each is not None}))
    share = good / max(len(exchanges), 1)
    return Verdict(share=share, sent=shown(row.values), wanted=wanted, came=came, why=why)


def parameter(expectation: Expectation, evidence: Evidence) -> Verdict:
    """Judge a parameter, as a step got it, or as its node declared and set it."""
    if expectation.node is not None:
        return _parameter_told(expectation, evidence)
    exchange = next(iter(evidence.exchanges(expectation.step)), None)
    node = evidence.step(expectation.step).target
    if exchange is None or exchange.sent_ns is None:
        return Verdict(
            share=0.0,
            wanted=plain(expectation.target),
            came=say("expected.not_there"),
            why=partial(_no_node, node, evidence),
        )
    came = (exchange.answer or {}).get(expectation.target) or {}
    if exchange.answer is None:
        why = because("service_silent", service=f"{node}/get_parameters")
        return Verdict(share=0.0, wanted=plain(expectation.target), came=say("expected.no_answer"), why=why)
    if "type" not in came:
        return Verdict(share=0.0, wanted=plain(expectation.target), came=say("expected.not_declared"))
    return _parameter_fits(expectation, came)


def _parameter_told(expectation: Expectation, evidence: Evidence) -> Verdict:
    """Judge a parameter by what its node told on /parameter_events, which needs nobody who spins."""
    declared: dict[str, Mapping[str, Any]] = {}
    for message in evidence.talk.heard.get("/parameter_events", ()):
        event = message.values or {}
        if event.get("node") == expectation.node:
            for each in (*event["new_parameters"], *event["changed_parameters"]):
                declared[each["name"]] = each["value"]
    told = plain_parameter(declared[expectation.target]) if expectation.target in declared else None
    if told is None:
        node, nodes = expectation.node or "", evidence.run.outcome.nodes
        why = unknown if node in nodes else because("node_name", node=node, used=named(nodes))
        return Verdict(
            share=0.0, wanted=plain(expectation.target), came=say("expected.not_declared"), why=why
        )
    return _parameter_fits(expectation, {"type": told[0], "value": told[1]})


def _parameter_fits(expectation: Expectation, came: Mapping[str, Any]) -> Verdict:
    parts = list(_parameter_parts(expectation, came))
    met = sum(fits for fits, *_ in parts)
    bad = next(((wanted, told) for fits, wanted, told in parts if not fits), None)
    if bad is None:
        return Verdict(share=1.0)
    wanted, told = bad
    return Verdict(share=met / len(parts), wanted=plain(f"{expectation.target}: {wanted}"), came=plain(told))


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


def served(expectation: Expectation, evidence: Evidence) -> Verdict:
    """Judge the script's requests to a service that a step serves."""
    step = evidence.step(expectation.target)
    requests = [
        each
        for each in evidence.talk.served
        if each.step == expectation.target and evidence.looks_at(expectation, each.t_ns)
    ]
    count = in_count(len(requests), expectation.count)
    good, bad = 0, None
    for n, each in enumerate(requests):
        names = evidence.names(each.t_ns, n=n, out=each.values)
        wanted = None if expectation.values is None else wanted_of(expectation.values, names)
        fits = (expectation.values is None or equals(wanted, each.values, expectation.within)) and holds(
            expectation.that, names
        )
        good += fits
        bad = each if not fits and bad is None else bad
    share = min(count, good / max(len(requests), 1)) if requests else float(count >= 1.0)
    if share >= 1.0:
        return Verdict(share=1.0)
    wanted_text = say("expected.requests", count=counted(expectation.count))
    if expectation.values is not None or expectation.that is not None:
        wanted_text = join(
            [wanted_text, plain(clip(expectation.that or "") or readable(expectation.values))], _AND
        )
    came = say("expected.came", count=len(requests)) if bad is None else plain(shown(bad.values))
    why = unknown if requests else partial(not_asked, step.target, step.type, evidence)
    return Verdict(share=share, wanted=wanted_text, came=came, why=why)


def not_asked(name: str, kind: str, evidence: Evidence) -> Mistake:
    """Return why nobody calls a service."""
    same = evidence.parties("client", name)
    if same and same[0].type != kind:
        return mistake("other_type", name=name, type=same[0].type, wanted=kind)
    used = [party.name for party in evidence.parties("client") if not party.type.startswith(OWN_TYPES)]
    return mistake("client_missing", service=name, type=kind, used=named(used))
