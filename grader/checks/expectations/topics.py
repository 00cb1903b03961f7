"""Expectations of topics and logs: how many messages, how often, of which quality, with what in them."""

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

from grader.checks.expectations.verdict import (
    NS_PER_S,
    Evidence,
    Reason,
    Verdict,
    because,
    closeness,
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
from grader.contracts.conversation import Expectation, Message, Party, Sent, clip, shown
from grader.contracts.text import EMPTY, Text
from grader.geometry.path import median
from grader.messages import join, say
from grader.messages.quantity import number

_AND = Text(zh="；", en="; ")
_HIDDEN = ("/rosout", "/parameter_events", "/transition_event")  # which nodes publish by themselves


def topic(expectation: Expectation, evidence: Evidence) -> Verdict:
    """Judge what came on a topic."""
    messages = evidence.messages(expectation)
    lost = evidence.talk.lost.get(expectation.target, 0)
    if expectation.step:
        return _answers(expectation, evidence, messages)
    if not messages and (expectation.count is None or expectation.count[0] > 0):
        wanted, came = _wanted_text(expectation), say("expected.no_messages")
        return Verdict(share=0.0, wanted=wanted, came=came, why=lambda: _silence(expectation, evidence))
    quantity = _quantity(expectation, evidence, [m.t_ns for m in messages], lost)
    parts = [
        (*quantity, join(_wanted_quantity(expectation), _AND)),
        (*_quality(expectation, evidence, messages), plain(wanted_quality(expectation))),
        _values(expectation, evidence, messages),
    ]
    share, came, why, wanted = min(parts, key=lambda part: part[0])
    return Verdict(share=share, wanted=wanted, came=came, why=why)


def log(expectation: Expectation, evidence: Evidence) -> Verdict:
    """Judge the log messages of a text."""
    records = [
        record
        for record in evidence.run.outcome.logs
        if evidence.looks_at(expectation, record.t_ns)
        and (expectation.level is None or record.level_name.lower() == expectation.level)
        and (expectation.node is None or record.name == expectation.node.strip("/").replace("/", "."))
    ]
    messages = [Message(record.t_ns, {"text": record.message}) for record in records]
    if expectation.step:
        return _logged_for(expectation, evidence, messages)
    fitting = [
        each.t_ns
        for n, each in enumerate(messages)
        if equals(
            wanted_of(expectation.target, evidence.names(each.t_ns, n=n)),
            (each.values or {})["text"],
            expectation.within,
        )
    ]
    share, came, why = _quantity(expectation, evidence, fitting, 0)
    wanted = join([say("expected.log", text=readable(expectation.target)), _wanted_text(expectation)], _AND)
    if fitting or share >= 1.0:
        return Verdict(share=share, wanted=wanted, came=came, why=why)
    heard = say("expected.logged", texts=named(clip(record.message) for record in records[:2]))
    came = heard if records else say("expected.no_logs")
    return Verdict(
        share=0.0,
        wanted=wanted,
        came=came,
        why=lambda: _unlogged(expectation, evidence, wanted_of(expectation.target, {"n": 0})),
    )


def _unlogged(expectation: Expectation, evidence: Evidence, text: object) -> Mistake | None:
    """Return why no log message fits: it was printed, or has another level."""
    outcome = evidence.run.outcome
    fits = [record for record in outcome.logs if equals(text, record.message, 0.0)]
    if expectation.level is not None and fits:
        return mistake("log_level", level=fits[0].level_name, wanted=expectation.level.upper())
    printed = [line for line in outcome.stdout.text.splitlines()[:200] if equals(text, line, 0.0)]
    if printed or (not outcome.logs and outcome.stdout.text.strip()):
        return mistake("printed")
    return None


def _wanted_text(expectation: Expectation) -> Text:
    """Say what is wanted of each message and of all of them."""
    parts = [plain(expectation.type)] if expectation.type and expectation.kind == "topic" else []
    parts += _wanted_quantity(expectation)
    parts += [plain(quality)] if (quality := wanted_quality(expectation)) else []
    parts += [] if expectation.values is None else [plain(readable(expectation.values))]
    parts += _wanted_besides(expectation)
    if expectation.within_s is not None:
        parts.append(say("expected.within", time=number(expectation.within_s, "s")))
    return join(parts, _AND)


def _wanted_quantity(expectation: Expectation) -> list[Text]:
    """Say how many messages are wanted, how often."""
    parts = []
    if expectation.count is not None or expectation.rate_hz is None:
        parts.append(say("expected.messages", count=counted(expectation.count)))
    if expectation.rate_hz is not None:
        parts.append(plain(f"{number(expectation.rate_hz, 'Hz')} ± {number(expectation.tolerance_pct, '%')}"))
    if expectation.least_s is not None:
        parts.append(say("expected.apart", time=number(expectation.least_s, "s")))
    if expectation.from_s or expectation.until_s is not None:
        until = "…" if expectation.until_s is None else number(expectation.until_s, "s")
        parts.append(plain(f"{number(expectation.from_s, 's')} – {until}"))
    if expectation.joins_s is not None:
        parts.append(say("expected.joins", time=number(expectation.joins_s, "s")))
    return parts


def wanted_quality(expectation: Expectation) -> str:
    """Return the quality that is wanted as ROS writes it, empty where any will do."""
    named_ones = [policy.upper() for policy in (expectation.reliability, expectation.durability) if policy]
    return ", ".join([*named_ones, *([f"depth {expectation.depth}"] if expectation.depth else [])])


def _wanted_besides(expectation: Expectation) -> list[Text]:
    """Say what is wanted of each message besides its values."""
    parts = [] if expectation.that is None else [plain(clip(expectation.that))]
    return (
        parts
        if expectation.increasing is None
        else [*parts, say("expected.increasing", field=expectation.increasing)]
    )


def _quantity(
    expectation: Expectation, evidence: Evidence, times_ns: Sequence[int], lost: int
) -> tuple[float, Text, Reason]:
    """Return how well number and rate fit, and what they are."""
    shares = [in_count(len(times_ns) + lost, expectation.count)]
    came, why = say("expected.came", count=len(times_ns) + lost), unknown
    if expectation.rate_hz is not None:
        rate_hz = _rate_hz(times_ns, evidence.until_s(expectation))
        shares.append(closeness(rate_hz, expectation.rate_hz, expectation.tolerance_pct))
        if shares[-1] < 1.0:
            measured, wanted = number(rate_hz, "Hz"), number(expectation.rate_hz, "Hz")
            why = because(
                "rate_off",
                topic=expectation.target,
                rate=measured,
                wanted=wanted,
                period=f"{1 / expectation.rate_hz:g}",
            )
        came = join([came, plain(number(rate_hz, "Hz"))], _AND)
    if expectation.least_s is not None:
        gaps_s = [(b - a) / NS_PER_S for a, b in itertools.pairwise(times_ns)]
        short = sum(gap < expectation.least_s - 1e-6 for gap in gaps_s)
        shares.append(1.0 - short / max(len(gaps_s), 1))
    return min(shares), came, why


def _rate_hz(times_ns: Sequence[int], until_s: float) -> float:
    """Return how often messages came: by the usual time between two, and over all of the time that was left."""
    if len(times_ns) < 2:
        return 0.0
    gaps_s = [(b - a) / NS_PER_S for a, b in itertools.pairwise(times_ns)]
    usual_s = median(gaps_s)
    span_s = (times_ns[-1] - times_ns[0]) / NS_PER_S
    silent_s = until_s - times_ns[-1] / NS_PER_S
    if silent_s > 3.0 * max(usual_s, span_s / len(gaps_s)) + 0.5:
        span_s += silent_s
    if span_s <= 0.0:
        return 0.0
    mean_hz = len(gaps_s) / span_s
    uneven = usual_s <= 0.0 or not 0.5 < mean_hz * usual_s < 2.0
    return mean_hz if not uneven else min(mean_hz, 1.0 / usual_s if usual_s > 0.0 else 0.0)


def fits_quality(expectation: Expectation, party: Party) -> bool:
    """Whether an endpoint has the quality that is wanted."""
    return (
        expectation.reliability in (None, "reliable" if party.reliable else "best_effort")
        and expectation.durability in (None, "transient_local" if party.transient_local else "volatile")
        and expectation.depth in (None, party.depth)
    )


def quality_of(party: Party) -> str:
    """Return the quality of an endpoint as ROS writes it."""
    reliability = "RELIABLE" if party.reliable else "BEST_EFFORT"
    durability = "TRANSIENT_LOCAL" if party.transient_local else "VOLATILE"
    return f"{reliability}, {durability}, depth {party.depth}"


def _quality(
    expectation: Expectation, evidence: Evidence, messages: Sequence[Message]
) -> tuple[float, Text, Reason]:
    heard = {message.party for message in messages}
    parties = [party for party in evidence.parties("publisher", expectation.target) if party.id in heard]
    wrong = [party for party in parties if not fits_quality(expectation, party)]
    if not wrong:
        return 1.0, EMPTY, unknown
    return 0.0, plain(quality_of(wrong[0])), unknown


def _values(
    expectation: Expectation, evidence: Evidence, messages: Sequence[Message]
) -> tuple[float, Text, Reason, Text]:
    """Return which share of the messages has what is wanted in it, the first that has not, and what it lacks."""
    if expectation.values is None and expectation.that is None and expectation.increasing is None:
        return 1.0, EMPTY, unknown, EMPTY
    good, first, before, lacks = 0, EMPTY, None, EMPTY
    for n, each in enumerate(messages):
        names = evidence.names(each.t_ns, n=n, out=each.values, before=before)
        wanted = None if expectation.values is None else wanted_of(expectation.values, names)
        alike = each.values is not None and (
            expectation.values is None or equals(wanted, each.values, expectation.within)
        )
        fits = alike and (
            (before is None and "before" in (expectation.that or "")) or holds(expectation.that, names)
        )
        fits = fits and _grows(expectation.increasing, before, each.values)
        good += fits
        if not fits and first == EMPTY:
            told = shown(only(expectation.values, each.values) if expectation.values else each.values)
            first = say("expected.message", n=n + 1, time=number(each.t_ns / NS_PER_S, "s"), values=told)
            lacks = (
                join(_wanted_besides(expectation), _AND)
                if alike
                else plain(readable(wanted or expectation.values))
            )
        before = each.values
    return good / max(len(messages), 1), first, unknown, lacks


def _grows(field: str | None, before: Mapping[str, Any] | None, after: Mapping[str, Any] | None) -> bool:
    if field is None or before is None or after is None:
        return True
    return bool(_at(field, before) < _at(field, after))


def _at(field: str, values: Any) -> Any:
    for name in field.split("."):
        values = values.get(name, 0) if isinstance(values, Mapping) else 0
    return values if isinstance(values, int | float) else 0


def _answers(expectation: Expectation, evidence: Evidence, messages: list[Message]) -> Verdict:
    """Judge whether each message of a step had an answer on the topic: of those that came in time the first."""
    exchanges, left = evidence.exchanges_looked_at(expectation), list(messages)
    good, row = 0, None
    for exchange in exchanges:
        reached = _in_time(expectation, exchange, exchanges, left)
        fitting = next(
            (message for message in reached if _fits(expectation, evidence, exchange, message)), None
        )
        chosen = fitting or (reached[0] if reached else None)
        if chosen is not None:
            left.remove(chosen)
        good += fitting is not None
        names = evidence.said(exchange, None)
        wanted = None if expectation.values is None else wanted_of(expectation.values, names)
        if fitting is None and row is None:
            row = (exchange, wanted, chosen)
    share = good / max(len(exchanges), 1)
    if row is None:
        return Verdict(share=share)
    exchange, wanted, chosen = row
    came = (
        say("expected.no_answer") if chosen is None else plain(shown(only(expectation.values, chosen.values)))
    )
    why = unknown if chosen is not None else partial(_unanswered, expectation, evidence, exchanges, messages)
    told = _wanted_text(expectation) if wanted is None else plain(readable(wanted))
    return Verdict(share=share, sent=shown(exchange.values), wanted=told, came=came, why=why)


def _in_time(
    expectation: Expectation, exchange: Sent, exchanges: Sequence[Sent], left: Sequence[Message]
) -> list[Message]:
    """Return the messages that may answer: within the time for it, or else before the next one was sent."""
    if exchange.sent_ns is None:
        return []
    sent_ns = exchange.sent_ns
    if expectation.within_s is not None:
        until_ns = sent_ns + expectation.within_s * NS_PER_S
    else:
        later = [each.sent_ns for each in exchanges if each.sent_ns is not None and each.sent_ns > sent_ns]
        until_ns = min([sent_ns + NS_PER_S, *(next_ns - 1 for next_ns in later)])
    return [message for message in left if sent_ns <= message.t_ns <= until_ns]


def _fits(expectation: Expectation, evidence: Evidence, exchange: Sent, message: Message) -> bool:
    names = evidence.said(exchange, message.t_ns, out=message.values)
    if message.values is None or not holds(expectation.that, names):
        return False
    return expectation.values is None or equals(
        wanted_of(expectation.values, names), message.values, expectation.within
    )


def _logged_for(expectation: Expectation, evidence: Evidence, messages: list[Message]) -> Verdict:
    """Judge whether each message of a step was logged."""
    exchanges, left = evidence.exchanges_looked_at(expectation), list(messages)
    good, row = 0, None
    for exchange in exchanges:
        text = wanted_of(expectation.target, evidence.said(exchange, None))
        reached = _in_time(expectation, exchange, exchanges, left)
        fitting = next(
            (message for message in reached if equals(text, (message.values or {})["text"], 0.0)), None
        )
        if fitting is not None:
            good += 1
            left.remove(fitting)
        elif row is None:
            row = Verdict(
                share=0.0,
                sent=shown(exchange.values),
                wanted=say("expected.log", text=readable(text)),
                came=plain(shown((reached[0].values or {})["text"])) if reached else say("expected.no_logs"),
                why=partial(_why_not_logged, expectation, evidence, exchanges, text),
            )
    share = good / max(len(exchanges), 1)
    return Verdict(share=share) if row is None else replace(row, share=share)


def _why_not_logged(
    expectation: Expectation, evidence: Evidence, exchanges: Sequence[Sent], text: object
) -> Mistake | None:
    return _unanswered(expectation, evidence, exchanges, ()) or _unlogged(expectation, evidence, text)


def _unanswered(
    expectation: Expectation, evidence: Evidence, exchanges: Sequence[Sent], messages: Sequence[Message]
) -> Mistake | None:
    """Return why what was published had no answer."""
    step = evidence.step(expectation.step)
    if step.kind != "publish":
        return None
    if all(exchange.sent_ns is None for exchange in exchanges):
        return not_heard(step.target, step.type, evidence)
    if not messages and expectation.kind == "topic":
        return _silence(expectation, evidence)
    return None


def not_heard(name: str, kind: str, evidence: Evidence) -> Mistake:
    """Return why nobody hears what is published on a topic."""
    same = evidence.parties("subscription", name)
    if same and same[0].type != kind:
        return mistake("other_type", name=name, type=same[0].type, wanted=kind)
    if same:
        return mistake("listens_other_quality", topic=name, quality=quality_of(same[0]))
    others = [party.name for party in evidence.parties("subscription") if not party.name.endswith(_HIDDEN)]
    if others:
        return mistake("other_name", name=name, used=named(others))
    return mistake("listens_nowhere", topic=name, type=kind)


def _silence(expectation: Expectation, evidence: Evidence) -> Mistake | None:
    """Return why nothing came on a topic."""
    same = evidence.parties("publisher", expectation.target)
    if same and all(endpoint.type != expectation.type for endpoint in same):
        return mistake("other_type", name=expectation.target, type=same[0].type, wanted=expectation.type)
    if same and expectation.joins_s is not None:
        return None  # what came before was not kept: its quality tells
    own = {endpoint.id for endpoint in same if expectation.node in (None, endpoint.node)}
    if times_ns := [
        message.t_ns for message in evidence.talk.heard.get(expectation.target, ()) if message.party in own
    ]:
        times = {"first": times_ns[0], "last": times_ns[-1]}
        told = {name: number(t_ns / NS_PER_S, "s") for name, t_ns in times.items()}
        start, end = number(expectation.from_s, "s"), number(evidence.until_s(expectation), "s")
        return mistake("publishes_at_other_times", topic=expectation.target, start=start, end=end, **told)
    if same:
        return mistake("publishes_nothing", topic=expectation.target)
    others = [party.name for party in evidence.parties("publisher") if not party.name.endswith(_HIDDEN)]
    if others:
        return mistake("other_name", name=expectation.target, used=named(others))
    return mistake("publishes_nowhere", topic=expectation.target, type=expectation.type)
