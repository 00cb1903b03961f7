"""A conversation with a script: what an assignment says to it, what it should say, and what was said.

An assignment has *steps* (publish, call, send a goal, set and get parameters, serve) and, in its rubric items,
*expectations*. Carrying the steps out gives a `Conversation`, by which the expectations are judged.
"""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Final, Literal, TypeVar

from grader.contracts.record import Record, field

_T = TypeVar("_T")
Values = dict[str, Any]
"""Fields of a message, by name; those of a step may be formulas ("= 2 * n")."""

StepKind = Literal["publish", "call", "goal", "set", "get", "serve"]
ExpectationKind = Literal[
    "topic",
    "answer",
    "goal",
    "set",
    "parameter",
    "frame",
    "log",
    "node",
    "listener",
    "service",
    "client",
    "action",
    "served",
    "turtle",
    "moved",
]
PartyKind = Literal["node", "publisher", "subscription", "service", "client"]

MOST_STEPS: Final = 40
MOST_SENT: Final = 1_000
"""Most messages, calls and goals that the steps of an assignment send in one run."""

FORMULA_MARK: Final = "="
PATTERN_MARK: Final = "~"

_SHOWN: Final = 90  # characters of one side of a row


class Step(Record):
    """Something that is said to the script, at `at_ns` or as soon after as it offers what is called.

    Attributes:
        id: what expectations call it.
        target: the topic, service, action, or node with the parameters.
        type: of that, such as ``example_interfaces/srv/AddTwoInts``; empty for parameters.
        values: of the message, request or goal; the parameters to set; what a served request is answered.
        each: several of these, one after the other; else `count` times `values`.
        every_ns: time from one to the next; 0: all at once.
        latched: a message is kept for subscriptions that come later. best_effort: it does not suit reliable ones.
        cancel_after_ns: when a goal is cancelled, from its acceptance on; None: it is not.
        names: of the parameters to get.
        after_ns: how long a served request waits for its answer.
    """

    id: str
    kind: StepKind
    target: str
    type: str = ""
    at_ns: int = 0
    values: Values = field(default_factory=dict)
    each: tuple[Values, ...] = ()
    every_ns: int = 0
    count: int = 1
    latched: bool = False
    best_effort: bool = False
    cancel_after_ns: int | None = None
    names: tuple[str, ...] = ()
    after_ns: int = 0

    @property
    def sends(self) -> int:
        """How many messages, calls or goals it is."""
        return 0 if self.kind == "serve" else len(self.each) or self.count


class Expectation(Record):
    """Something that is wanted of the script. Which fields there are depends on the kind; None: any will do.

    Attributes:
        target: topic, service, action, node, frame, turtle or parameter; of a log message its text; the step whose
            answers, goals, settings or requests are looked at.
        step: the step that the parameter was got in; the step to whose messages there is to be an answer.
        values: fields of each message, answer, request, result; numbers within `within`.
        that: a formula that must be true of each.
        within_s: time that an answer may take.
        count: least and most number.
        rate_hz: how often, within `tolerance_pct`. least_s: shortest time between two.
        from_s, until_s: what is looked at. joins_s: a listener that comes only then.
        increasing: a field that grows from message to message.
        secret: what was wanted and what came is not told.
    """

    kind: ExpectationKind
    target: str
    step: str = ""
    type: str | None = None
    node: str | None = None
    values: Values | None = None
    that: str | None = None
    within: float = 1e-6
    within_s: float | None = None
    count: tuple[int, int | None] | None = None
    rate_hz: float | None = None
    tolerance_pct: float = 10.0
    least_s: float | None = None
    from_s: float = 0.0
    until_s: float | None = None
    joins_s: float | None = None
    increasing: str | None = None
    reliability: str | None = None
    durability: str | None = None
    depth: int | None = None
    level: str | None = None
    accepted: bool | None = None
    status: str | None = None
    feedback: Values | None = None
    feedback_count: tuple[int, int | None] | None = None
    feedback_that: str | None = None
    successful: bool | None = None
    reason: str | None = None
    value: Any = None
    low: float | None = None
    high: float | None = None
    read_only: bool | None = None
    parent: str | None = None
    static: bool | None = None
    translation: tuple[float | str, float | str, float | str] | None = None
    rotation: tuple[float | str, float | str, float | str, float | str] | None = None
    yaw_deg: float | str | None = None
    within_deg: float = 2.0
    at_s: float | None = None
    x: float | None = None
    y: float | None = None
    heading_deg: float | None = None
    pen: tuple[int, int, int] | None = None
    pen_off: bool | None = None
    ahead_m: float | str | None = None
    turned_deg: float | str | None = None
    secret: bool = False


class Message(Record, kw_only=False):
    """A message, feedback or request that the script sent. `values` is None where it could not be read."""

    t_ns: int
    values: Values | None
    party: int = 0


class Party(Record):
    """A node, publisher, subscription, service or client of the script; `id` is what its messages name."""

    id: int
    kind: PartyKind
    node: str
    name: str
    type: str
    reliable: bool = True
    transient_local: bool = False
    depth: int = 10
    since_ns: int = 0
    until_ns: int | None = None


class Sent(Record):
    """What one message, call or goal of a step came to.

    Attributes:
        step, n: of which step, and which of it, from 0.
        values: what was sent, formulas carried out.
        sent_ns: None: nobody was there to be asked.
        answer: of a service; the result of a goal; of parameters the answers of the services that were asked.
        accepted, status: of a goal; the status is the name that ROS has for it.
    """

    step: str
    n: int
    values: Values
    sent_ns: int | None = None
    answered_ns: int | None = None
    answer: Values | None = None
    accepted: bool | None = None
    accepted_ns: int | None = None
    feedback: tuple[Message, ...] = ()
    status: str = ""
    cancelled_ns: int | None = None


class Served(Record):
    """A request of the script to a service that a step offers."""

    step: str
    t_ns: int
    values: Values
    answered_ns: int | None = None
    answer: Values | None = None


class TurtleSample(Record, kw_only=False):
    """Where a turtle was, and its pen."""

    t_ns: int
    x: float
    y: float
    heading_rad: float
    pen: tuple[int, int, int]
    pen_off: bool


class Conversation(Record):
    """What was said in one run, as the trusted side saw it.

    Attributes:
        heard: messages by topic, of the topics that an expectation is about, in order.
        lost: how many more came on a topic than are kept, by topic.
        turtles: samples by name, in order.
    """

    exchanges: tuple[Sent, ...] = ()
    heard: dict[str, tuple[Message, ...]] = field(default_factory=dict)
    lost: dict[str, int] = field(default_factory=dict)
    parties: tuple[Party, ...] = ()
    served: tuple[Served, ...] = ()
    turtles: dict[str, tuple[TurtleSample, ...]] = field(default_factory=dict)


def parameter_value(value: Any) -> Values:
    """Return rcl_interfaces/msg/ParameterValue of a value."""
    for number, (name, fits) in enumerate(_PARAMETER_FIELDS, 1):
        if fits(value):
            return {"type": number, name: value}
    raise ValueError(f"{value!r} is no value of a parameter")


def _all_of(kind: type) -> Any:
    return lambda value: isinstance(value, list) and all(type(element) is kind for element in value)


_PARAMETER_FIELDS: Final = (
    ("bool_value", lambda value: isinstance(value, bool)),
    ("integer_value", lambda value: type(value) is int),
    ("double_value", lambda value: isinstance(value, float)),
    ("string_value", lambda value: isinstance(value, str)),
    ("byte_array_value", lambda value: isinstance(value, bytes)),
    ("bool_array_value", _all_of(bool)),
    ("integer_array_value", _all_of(int)),
    ("double_array_value", _all_of(float)),
    ("string_array_value", _all_of(str)),
)
_PARAMETER_TYPES: Final = (
    "bool",
    "integer",
    "double",
    "string",
    "byte_array",
    "bool_array",
    "integer_array",
    "double_array",
    "string_array",
)


def plain_parameter(told: Mapping[str, Any]) -> tuple[str, Any] | None:
    """Return type and value of rcl_interfaces/msg/ParameterValue; None where it is not set."""
    number = told["type"]
    if not 1 <= number <= len(_PARAMETER_TYPES):
        return None
    return _PARAMETER_TYPES[number - 1], told[_PARAMETER_FIELDS[number - 1][0]]


class Saying(Record, kw_only=False):
    """A line of a conversation as it is shown.

    Attributes:
        way: ``in``: it was sent to the script. ``out``: the script sent it. ``call``: the script was asked, and
            answered at `until_ns` (None: it did not). ``ask``: the script asked.
        name: the topic, service or action. text: what was said, short.
    """

    t_ns: int
    way: Literal["in", "out", "call", "ask"]
    name: str
    text: str
    until_ns: int | None = None


def sayings(conversation: Conversation, steps: Mapping[str, Step]) -> tuple[Saying, ...]:
    """Return a conversation in order of time: of each topic and service the first and the last lines."""
    lines: dict[str, list[Saying]] = {}
    for exchange in conversation.exchanges:
        if exchange.sent_ns is not None:
            step = steps[exchange.step]
            lines.setdefault(f"in {step.target}", []).append(_sent(exchange, step, exchange.sent_ns))
            lines.setdefault(f"feedback {step.target}", []).extend(
                Saying(message.t_ns, "out", f"{step.target} feedback", shown(message.values))
                for message in exchange.feedback
            )
    for name, messages in conversation.heard.items():
        lines[f"out {name}"] = [
            Saying(message.t_ns, "out", name, "?" if message.values is None else shown(message.values))
            for message in _ends(messages)
        ]
    for request in conversation.served:
        text = f"{shown(request.values)} → {shown(request.answer)}"
        lines.setdefault(f"ask {request.step}", []).append(
            Saying(request.t_ns, "ask", steps[request.step].target, text, request.answered_ns)
        )
    kept = (line for each in lines.values() for line in _ends(each))
    return tuple(sorted(kept, key=lambda line: (line.t_ns, line.way, line.name)))


def _sent(sent: Sent, step: Step, sent_ns: int) -> Saying:
    """Return the line of something that was sent, with its answer."""
    if step.kind == "publish":
        return Saying(sent_ns, "in", step.target, shown(sent.values))
    told = shown(sent.values) if sent.values else ", ".join(step.names)
    answer = f" → {shown(sent.answer)}" if sent.answer is not None else ""
    status = "REJECTED" if sent.accepted is False else sent.status
    text = f"{told}{answer}{f' ({status})' if status else ''}"
    ended_ns = sent.accepted_ns if sent.accepted is False else sent.answered_ns
    return Saying(sent_ns, "call", step.target, text, ended_ns)


MOST_SAYINGS: Final = 60
"""Lines kept of one topic or service."""


def _ends(lines: Sequence[_T]) -> Sequence[_T]:
    half = MOST_SAYINGS // 2
    return lines if len(lines) <= MOST_SAYINGS else [*lines[:half], *lines[-half:]]


def clip(text: str) -> str:
    """Return a text short enough for a row."""
    return text if len(text) <= _SHOWN else text[: _SHOWN - 1] + "…"


def shown(value: Any) -> str:
    """Return a value as a row shows it: ``a = 3, b = 4``."""
    return clip(", ".join(_fields("", value))) or "—"


def _fields(name: str, value: Any) -> Iterator[str]:
    if isinstance(value, Mapping):
        for field, each in value.items():
            yield from _fields(f"{name}.{field}" if name else str(field), each)
    else:
        text = _plain(value)
        yield f"{name} = {text}" if name else text


def _plain(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, str):
        return f'"{value}"'
    if isinstance(value, list | tuple | bytes):
        listed = [_plain(element) for element in value[:12]]
        return f"[{', '.join(listed)}{', …' if len(value) > 12 else ''}]"
    return str(value) if not isinstance(value, dict) else ", ".join(_fields("", value))
