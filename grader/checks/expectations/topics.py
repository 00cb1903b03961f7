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


def topic(one: Expectation, evidence: Evidence) -> Verdict:
    """Judge what came on a topic."""
    messages = evidence.messages(one)
    lost = evidence.talk.lost.get(one.target, 0)
    if one.step:
        return _answers(one, evidence, messages)
    if not messages and (one.count is None or one.count[0] > 0):
        wanted, came = _wanted(one), say("expected.no_messages")
        return Verdict(share=0.0, wanted=wanted, came=came, why=lambda: _silence(one, evidence))
    quantity = _quantity(one, evidence, [m.t_ns for m in messages], lost)
    parts = [
        (*quantity, join(_wanted_quantity(one), _AND)),
        (*_quality(one, evidence, messages), plain(wanted_quality(one))),
        _values(one, evidence, messages),
    ]
    share, came, why, wanted = min(parts, key=lambda each: each[0])
    return Verdict(share=share, wanted=wanted, came=came, why=why)


def log(one: Expectation, evidence: Evidence) -> Verdict:
    """Judge the log messages of a text."""
    records = [
        each
        for each in evidence.run.outcome.logs
        if evidence.looks_at(one, each.t_ns)
        and (one.level is None or each.level_name.lower() == one.level)
        and (one.node is None or each.name == one.node.strip("/").replace("/", "."))
    ]
    messages = [Message(each.t_ns, {"text": each.message}) for each in records]
    if one.step:
        return _logged_for(one, evidence, messages)
    fitting = [
        each.t_ns
        for n, each in enumerate(messages)
        if equals(
            wanted_of(one.target, evidence.names(each.t_ns, n=n)), (each.values or {})["text"], one.within
        )
    ]
    share, came, why = _quantity(one, evidence, fitting, 0)
    wanted = join([say("expected.log", text=readable(one.target)), _wanted(one)], _AND)
    if fitting or share >= 1.0:
        return Verdict(share=share, wanted=wanted, came=came, why=why)
    heard = say("expected.logged", texts=named(clip(each.message) for each in records[:2]))
    came = heard if records else say("expected.no_logs")
    return Verdict(
        share=0.0,
        wanted=wanted,
        came=came,
        why=lambda: _unlogged(one, evidence, wanted_of(one.target, {"n": 0})),
    )


def _unlogged(one: Expectation, evidence: Evidence, text: object) -> Mistake | None:
    """Return why no log message fits: it was printed, or has another level."""
    outcome = evidence.run.outcome
    fits = [each for each in outcome.logs if equals(text, each.message, 0.0)]
    if one.level is not None and fits:
        return mistake("log_level", level=fits[0].level_name, wanted=one.level.upper())
    printed = [line for line in outcome.stdout.text.splitlines()[:200] if equals(text, line, 0.0)]
    if printed or (not outcome.logs and outcome.stdout.text.strip()):
        return mistake("printed")
    return None


def _wanted(one: Expectation) -> Text:
    """Say what is wanted of each message and of all of them."""
    parts = [plain(one.type)] if one.type and one.kind == "topic" else []
    parts += _wanted_quantity(one)
    parts += [plain(quality)] if (quality := wanted_quality(one)) else []
    parts += [] if one.values is None else [plain(readable(one.values))]
    parts += _wanted_besides(one)
    if one.within_s is not None:
        parts.append(say("expected.within", time=number(one.within_s, "s")))
    return join(parts, _AND)


def _wanted_quantity(one: Expectation) -> list[Text]:
    """Say how many messages are wanted, how often."""
    parts = []
    if one.count is not None or one.rate_hz is None:
        parts.append(say("expected.messages", count=counted(one.count)))
    if one.rate_hz is not None:
        parts.append(plain(f"{number(one.rate_hz, 'Hz')} ± {number(one.tolerance_pct, '%')}"))
    if one.least_s is not None:
        parts.append(say("expected.apart", time=number(one.least_s, "s")))
    if one.from_s or one.until_s is not None:
        until = "…" if one.until_s is None else number(one.until_s, "s")
        parts.append(plain(f"{number(one.from_s, 's')} – {until}"))
    if one.joins_s is not None:
        parts.append(say("expected.joins", time=number(one.joins_s, "s")))
    return parts


def wanted_quality(one: Expectation) -> str:
    """Return the quality that is wanted as ROS writes it, empty where any will do."""
    named_ones = [each.upper() for each in (one.reliability, one.durability) if each]
    return ", ".join([*named_ones, *([f"depth {one.depth}"] if one.depth else [])])


def _wanted_besides(one: Expectation) -> list[Text]:
    """Say what is wanted of each message besides its values."""
    parts = [] if one.that is None else [plain(clip(one.that))]
    return parts if one.increasing is None else [*parts, say("expected.increasing", field=one.increasing)]


def _quantity(
    one: Expectation, evidence: Evidence, times_ns: Sequence[int], lost: int
) -> tuple[float, Text, Reason]:
    """Return how well number and rate fit, and what they are."""
    shares = [in_count(len(times_ns) + lost, one.count)]
    came, why = say("expected.came", count=len(times_ns) + lost), unknown
    if one.rate_hz is not None:
        rate_hz = _rate_hz(times_ns, evidence.until_s(one))
        shares.append(closeness(rate_hz, one.rate_hz, one.tolerance_pct))
        if shares[-1] < 1.0:
            measured, wanted = number(rate_hz, "Hz"), number(one.rate_hz, "Hz")
            why = because(
                "rate_off", topic=one.target, rate=measured, wanted=wanted, period=f"{1 / one.rate_hz:g}"
            )
        came = join([came, plain(number(rate_hz, "Hz"))], _AND)
    if one.least_s is not None:
        gaps_s = [(b - a) / NS_PER_S for a, b in itertools.pairwise(times_ns)]
        short = sum(gap < one.least_s - 1e-6 for gap in gaps_s)
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


def fits_quality(one: Expectation, party: Party) -> bool:
    """Whether an endpoint has the quality that is wanted."""
    return (
        one.reliability in (None, "reliable" if party.reliable else "best_effort")
        and one.durability in (None, "transient_local" if party.transient_local else "volatile")
        and one.depth in (None, party.depth)
    )


def quality_of(party: Party) -> str:
    """Return the quality of an endpoint as ROS writes it."""
    reliability = "RELIABLE" if party.reliable else "BEST_EFFORT"
    durability = "TRANSIENT_LOCAL" if party.transient_local else "VOLATILE"
    return f"{reliability}, {durability}, depth {party.depth}"


def _quality(one: Expectation, evidence: Evidence, messages: Sequence[Message]) -> tuple[float, Text, Reason]:
    heard = {each.party for each in messages}
    parties = [each for each in evidence.parties("publisher", one.target) if each.id in heard]
    wrong = [each for each in parties if not fits_quality(one, each)]
    if not wrong:
        return 1.0, EMPTY, unknown
    return 0.0, plain(quality_of(wrong[0])), unknown


def _values(
    one: Expectation, evidence: Evidence, messages: Sequence[Message]
) -> tuple[float, Text, Reason, Text]:
    """Return which share of the messages has what is wanted in it, the first that has not, and what it lacks."""
    if one.values is None and one.that is None and one.increasing is None:
        return 1.0, EMPTY, unknown, EMPTY
    good, first, before, lacks = 0, EMPTY, None, EMPTY
    for n, each in enumerate(messages):
        names = evidence.names(each.t_ns, n=n, out=each.values, before=before)
        wanted = None if one.values is None else wanted_of(one.values, names)
        alike = each.values is not None and (one.values is None or equals(wanted, each.values, one.within))
        fits = alike and ((before is None and "before" in (one.that or "")) or holds(one.that, names))
        fits = fits and _grows(one.increasing, before, each.values)
        good += fits
        if not fits and first == EMPTY:
            told = shown(only(one.values, each.values) if one.values else each.values)
            first = say("expected.message", n=n + 1, time=number(each.t_ns / NS_PER_S, "s"), values=told)
            lacks = join(_wanted_besides(one), _AND) if alike else plain(readable(wanted or one.values))
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


def _answers(one: Expectation, evidence: Evidence, messages: list[Message]) -> Verdict:
    """Judge whether each message of a step had an answer on the topic: of those that came in time the first."""
    exchanges, left = evidence.exchanges_looked_at(one), list(messages)
    good, row = 0, None
    for exchange in exchanges:
        reached = _in_time(one, exchange, exchanges, left)
        fitting = next((each for each in reached if _fits(one, evidence, exchange, each)), None)
        chosen = fitting or (reached[0] if reached else None)
        if chosen is not None:
            left.remove(chosen)
        good += fitting is not None
        names = evidence.said(exchange, None)
        wanted = None if one.values is None else wanted_of(one.values, names)
        if fitting is None and row is None:
            row = (exchange, wanted, chosen)
    share = good / max(len(exchanges), 1)
    if row is None:
        return Verdict(share=share)
    exchange, wanted, chosen = row
    came = say("expected.no_answer") if chosen is None else plain(shown(only(one.values, chosen.values)))
    why = unknown if chosen is not None else partial(_unanswered, one, evidence, exchanges, messages)
    told = _wanted(one) if wanted is None else plain(readable(wanted))
    return Verdict(share=share, sent=shown(exchange.values), wanted=told, came=came, why=why)


def _in_time(
    one: Expectation, exchange: Sent, exchanges: Sequence[Sent], left: Sequence[Message]
) -> list[Message]:
    """Return the messages that may answer: within the time for it, or else before the next one was sent."""
    if exchange.sent_ns is None:
        return []
    sent_ns = exchange.sent_ns
    if one.within_s is not None:
        until_ns = sent_ns + one.within_s * NS_PER_S
    else:
        later = [each.sent_ns for each in exchanges if each.sent_ns is not None and each.sent_ns > sent_ns]
        until_ns = min([sent_ns + NS_PER_S, *(next_ns - 1 for next_ns in later)])
    return [each for each in left if sent_ns <= each.t_ns <= until_ns]


def _fits(one: Expectation, evidence: Evidence, exchange: Sent, message: Message) -> bool:
    names = evidence.said(exchange, message.t_ns, out=message.values)
    if message.values is None or not holds(one.that, names):
        return False
    return one.values is None or equals(wanted_of(one.values, names), message.values, one.within)


def _logged_for(one: Expectation, evidence: Evidence, messages: list[Message]) -> Verdict:
    """Judge whether each message of a step was logged."""
    exchanges, left = evidence.exchanges_looked_at(one), list(messages)
    good, row = 0, None
    for exchange in exchanges:
        text = wanted_of(one.target, evidence.said(exchange, None))
        reached = _in_time(one, exchange, exchanges, left)
        fitting = next((each for each in reached if equals(text, (each.values or {})["text"], 0.0)), None)
        if fitting is not None:
            good += 1
            left.remove(fitting)
        elif row is None:
            row = Verdict(
                share=0.0,
                sent=shown(exchange.values),
                wanted=say("expected.log", text=readable(text)),
                came=plain(shown((reached[0].values or {})["text"])) if reached else say("expected.no_logs"),
                why=partial(_why_not_logged, one, evidence, exchanges, text),
            )
    share = good / max(len(exchanges), 1)
    return Verdict(share=share) if row is None else replace(row, share=share)


def _why_not_logged(
    one: Expectation, evidence: Evidence, exchanges: Sequence[Sent], text: object
) -> Mistake | None:
    return _unanswered(one, evidence, exchanges, ()) or _unlogged(one, evidence, text)


def _unanswered(
    one: Expectation, evidence: Evidence, exchanges: Sequence[Sent], messages: Sequence[Message]
) -> Mistake | None:
    """Return why what was published had no answer."""
    step = evidence.step(one.step)
    if step.kind != "publish":
        return None
    if all(each.sent_ns is None for each in exchanges):
        return not_heard(step.target, step.type, evidence)
    if not messages and one.kind == "topic":
        return _silence(one, evidence)
    return None


def not_heard(name: str, kind: str, evidence: Evidence) -> Mistake:
    """Return why nobody hears what is published on a topic."""
    same = evidence.parties("subscription", name)
    if same and same[0].type != kind:
        return mistake("other_type", name=name, type=same[0].type, wanted=kind)
    if same:
        return mistake("listens_other_quality", topic=name, quality=quality_of(same[0]))
    others = [each.name for each in evidence.parties("subscription") if not each.name.endswith(_HIDDEN)]
    if others:
        return mistake("other_name", name=name, used=named(others))
    return mistake("listens_nowhere", topic=name, type=kind)


def _silence(one: Expectation, evidence: Evidence) -> Mistake | None:
    """Return why nothing came on a topic."""
    same = evidence.parties("publisher", one.target)
    if same and all(each.type != one.type for each in same):
        return mistake("other_type", name=one.target, type=same[0].type, wanted=one.type)
    if same and one.node is not None and all(each.node != one.node for each in same):
        return mistake("publishes_as_other", topic=one.target, node=same[0].node, wanted=one.node)
    if same and one.joins_s is not None and evidence.talk.heard.get(one.target):
        return mistake("publishes_volatile", topic=one.target)
    own = {each.id for each in same if one.node in (None, each.node)}
    if times_ns := [each.t_ns for each in evidence.talk.heard.get(one.target, ()) if each.party in own]:
        times = {"first": times_ns[0], "last": times_ns[-1]}
        told = {name: number(t_ns / NS_PER_S, "s") for name, t_ns in times.items()}
        start, end = number(one.from_s, "s"), number(evidence.until_s(one), "s")
        return mistake("publishes_at_other_times", topic=one.target, start=start, end=end, **told)
    if same:
        return mistake("publishes_nothing", topic=one.target)
    others = [each.name for each in evidence.parties("publisher") if not each.name.endswith(_HIDDEN)]
    if others:
        return mistake("other_name", name=one.target, used=named(others))
    return mistake("publishes_nowhere", topic=one.target, type=one.type)
