"""The schema of ``steps`` and of what rubric items ``expect``: a conversation with the script, without code."""

from collections.abc import Callable, Iterator, Mapping
from typing import Annotated, Any, ClassVar, Final, Literal, get_args

from pydantic import AfterValidator, BeforeValidator, Discriminator, Field, JsonValue, Tag, model_validator

from grader.catalog import misfits
from grader.catalog.misfits import MisfitError
from grader.catalog.spec import SpecModel
from grader.contracts.assignment import TOPIC_PATTERN
from grader.contracts.conversation import FORMULA_MARK, Expectation, ExpectationKind, Step, StepKind
from grader.contracts.formula import FormulaError, formula
from grader.contracts.python import Self

MOST_S: Final = 600.0
Name = Annotated[str, Field(pattern=f"^{TOPIC_PATTERN}$")]
AnyType = Annotated[str, Field(pattern=misfits.ANY_TYPE_PATTERN)]
Id = Annotated[str, Field(pattern=misfits.ID_PATTERN)]
Seconds = Annotated[float, Field(ge=0.0, le=MOST_S)]
Fields = dict[str, JsonValue]
Plain = Annotated[str, Field(min_length=1, max_length=400)]

_SENDING: Final = ("n",)
_ANSWERING: Final = ("n", "in_")
_JUDGING: Final = ("n", "t", "in_", "out", "sent", "before")


def _count(value: object) -> object:
    """Take ``3`` for exactly three, ``[2, 4]`` for two to four, ``[2, null]`` for two at least."""
    ends = value if isinstance(value, list) else [value, value]
    whole = [end for end in ends if isinstance(end, int) and not isinstance(end, bool) and end >= 0]
    open_ended = len(ends) == 2 and ends[1] is None and len(whole) == 1 and ends[0] is not None
    if not (open_ended or (len(ends) == 2 and len(whole) == 2 and whole[0] <= whole[1])):
        raise MisfitError(misfits.NO_COUNT)
    return tuple(ends)


Count = Annotated[tuple[int, int | None], BeforeValidator(_count)]


def _checked(text: str, names: tuple[str, ...]) -> None:
    """Refuse a formula that cannot be read, or asks for what is not there."""
    try:
        read = formula(text)
    except FormulaError as error:
        raise MisfitError(misfits.bad_formula(str(error))) from None
    turtles = {name for name in read.names if name.startswith("turtle")}
    if missing := sorted(read.names - set(names) - turtles):
        raise MisfitError(misfits.unknown_name(missing[0].rstrip("_"), [name.rstrip("_") for name in names]))


def _formulas(names: tuple[str, ...]) -> Callable[[Any], Any]:
    def check(value: Any) -> Any:
        pending = [value]
        while pending:
            one = pending.pop()
            if isinstance(one, dict):
                pending += one.values()
            elif isinstance(one, list | tuple):
                pending += one
            elif isinstance(one, str) and one.startswith(FORMULA_MARK):
                _checked(one[1:], names)
        return value

    return check


def _condition(value: str) -> str:
    _checked(value, _JUDGING)
    return value


Wanted = Annotated[Fields, AfterValidator(_formulas(_JUDGING))]
That = Annotated[Plain, AfterValidator(_condition)]
Pattern = Annotated[Plain, AfterValidator(_formulas(_JUDGING))]
Number = Annotated[float | str, AfterValidator(_formulas(_JUDGING))]

_OF_STEPS: Final[Mapping[StepKind, frozenset[str]]] = {
    "publish": frozenset({"type", "values", "each", "every_s", "count", "latched", "best_effort"}),
    "call": frozenset({"type", "values", "each", "every_s", "count"}),
    "goal": frozenset({"type", "values", "each", "every_s", "count", "cancel_after_s"}),
    "set": frozenset({"values", "each", "every_s"}),
    "get": frozenset({"names"}),
    "serve": frozenset({"type", "answer", "after_s"}),
}
STEP_FIELDS: Final = {kind: tuple(sorted(fields)) for kind, fields in _OF_STEPS.items()}
"""What a step of each kind may have besides ``id`` and ``at_s``."""


class StepModel(SpecModel):
    """Something that is said to the script: publish, call, goal, set, get or serve, with what it speaks to."""

    id: Id | None = None
    at_s: Seconds = 1.0
    publish: Name | None = None
    call: Name | None = None
    goal: Name | None = None
    set: Name | None = None
    get: Name | None = None
    serve: Name | None = None
    type: AnyType | None = None
    values: Annotated[Fields, AfterValidator(_formulas(_SENDING))] = Field(default_factory=dict)
    each: Annotated[tuple[Fields, ...], Field(max_length=200), AfterValidator(_formulas(_SENDING))] = ()
    every_s: Seconds = 0.0
    count: Annotated[int, Field(ge=1, le=1000)] = 1
    latched: bool = False
    best_effort: bool = False
    cancel_after_s: Seconds | None = None
    names: Annotated[tuple[Plain, ...], Field(max_length=20)] = ()
    answer: Annotated[Fields, AfterValidator(_formulas(_ANSWERING))] = Field(default_factory=dict)
    after_s: Seconds = 0.0

    @property
    def kind(self) -> StepKind:
        """Which kind of step it is."""
        return next(kind for kind in get_args(StepKind) if getattr(self, kind) is not None)

    @model_validator(mode="after")
    def _is_one(self) -> Self:
        if sum(getattr(self, kind) is not None for kind in get_args(StepKind)) != 1:
            raise MisfitError(misfits.ONE_STEP)
        allowed = _OF_STEPS[self.kind]
        for name in sorted(self.model_fields_set - allowed - {"id", "at_s", self.kind}):
            raise MisfitError(misfits.not_of_step(self.kind, sorted(allowed)), name)
        if ("type" in allowed) != (self.type is not None):
            raise MisfitError(misfits.STEP_NEEDS_TYPE, "type")
        return self

    def to_contract(self, number: int) -> Step:
        """Return the contract of the step of that number, from 1."""
        cancel_s = self.cancel_after_s
        return Step(
            id=self.id or f"step{number}",
            kind=self.kind,
            target=getattr(self, self.kind),
            type=self.type or "",
            at_ns=round(self.at_s * 1e9),
            values=dict(self.answer if self.kind == "serve" else self.values),
            each=self.each,
            every_ns=round(self.every_s * 1e9),
            count=self.count,
            latched=self.latched,
            best_effort=self.best_effort,
            cancel_after_ns=None if cancel_s is None else round(cancel_s * 1e9),
            names=self.names,
            after_ns=round(self.after_s * 1e9),
        )


class _Expected(SpecModel):
    """What every expectation may have."""

    kind: ClassVar[ExpectationKind]
    secret: bool = False

    def to_contract(self) -> Expectation:
        """Return the contract."""
        values = {_CONTRACT_NAMES.get(name, name): value for name, value in self if value is not None}
        target = values.pop(self.kind)
        return Expectation(kind=self.kind, target=target, **values)


_CONTRACT_NAMES: Final = {"result": "values", "after": "step", "of": "step"}


class _Window(_Expected):
    from_s: Seconds = 0.0
    until_s: Seconds | None = None


class _Often(_Window):
    count: Count | None = None
    rate_hz: Annotated[float, Field(gt=0.0, le=1000.0)] | None = None
    tolerance_pct: Annotated[float, Field(ge=0.0, le=100.0)] = 10.0
    least_s: Seconds | None = None


class _ExpectedEndpoint(_Expected):
    type: AnyType
    node: Name | None = None


class _Quality(SpecModel):
    reliability: Literal["reliable", "best_effort"] | None = None
    durability: Literal["volatile", "transient_local"] | None = None
    depth: Annotated[int, Field(ge=1, le=65535)] | None = None


class ExpectedTopic(_Often, _ExpectedEndpoint, _Quality):
    """Messages on a topic."""

    kind = "topic"
    topic: Name
    values: Wanted | None = None
    that: That | None = None
    within: Annotated[float, Field(ge=0.0)] = 1e-6
    increasing: Plain | None = None
    joins_s: Seconds | None = None
    after: Id | None = None
    within_s: Seconds | None = None


class ExpectedAnswer(_Expected):
    """Answers to the calls of a step."""

    kind = "answer"
    answer: Id
    values: Wanted | None = None
    that: That | None = None
    within: Annotated[float, Field(ge=0.0)] = 1e-6
    within_s: Seconds | None = None


class ExpectedGoal(_Expected):
    """What became of the goals of a step."""

    kind = "goal"
    goal: Id
    accepted: bool | None = None
    status: Literal["succeeded", "canceled", "aborted"] | None = None
    result: Wanted | None = None
    that: That | None = None
    feedback_count: Count | None = None
    feedback: Wanted | None = None
    feedback_that: That | None = None
    within: Annotated[float, Field(ge=0.0)] = 1e-6
    within_s: Seconds | None = None


class ExpectedSet(_Expected):
    """Whether the parameters of a step could be set."""

    kind = "set"
    set: Id
    successful: bool | None = None
    reason: Pattern | None = None


class ExpectedParameter(_Expected):
    """A parameter, as a step got it; or as the node declared it and set it last, if it only is to have a value."""

    kind = "parameter"
    parameter: Plain
    of: Id | None = None
    node: Name | None = None
    type: (
        Literal["bool", "integer", "double", "string", "integer_array", "double_array", "string_array"] | None
    ) = None
    value: JsonValue | None = None
    within: Annotated[float, Field(ge=0.0)] = 1e-6
    low: float | None = None
    high: float | None = None
    read_only: bool | None = None

    @model_validator(mode="after")
    def _has_one_source(self) -> Self:
        asks = self.low is not None or self.high is not None or self.read_only is not None
        if (self.of is None) == (self.node is None) or (asks and self.of is None):
            raise MisfitError(misfits.PARAMETER_SOURCE, "of")
        return self


class ExpectedFrame(_Often):
    """A frame of tf2, as its parent sees it."""

    kind = "frame"
    frame: Plain
    parent: Plain
    static: bool | None = None
    translation: tuple[Number, Number, Number] | None = None
    rotation: tuple[Number, Number, Number, Number] | None = None
    yaw_deg: Number | None = None
    within: Annotated[float, Field(ge=0.0)] = 0.01
    within_deg: Annotated[float, Field(ge=0.0)] = 2.0
    at_s: Seconds | None = None


class ExpectedLog(_Often):
    """Log messages of a text."""

    kind = "log"
    log: Pattern
    level: Literal["debug", "info", "warn", "error", "fatal"] | None = None
    node: Plain | None = None
    after: Id | None = None
    within_s: Seconds | None = None


class ExpectedNode(_Expected):
    """A node with that name."""

    kind = "node"
    node: Name


class ExpectedListener(_ExpectedEndpoint, _Quality):
    """A subscription."""

    kind = "listener"
    listener: Name


class ExpectedService(_ExpectedEndpoint):
    """A service that is offered."""

    kind = "service"
    service: Name


class ExpectedClient(_ExpectedEndpoint):
    """A client of a service."""

    kind = "client"
    client: Name


class ExpectedAction(_ExpectedEndpoint):
    """An action that is offered."""

    kind = "action"
    action: Name


class ExpectedServed(_Window):
    """The script's requests to a service that a step serves."""

    kind = "served"
    served: Id
    count: Count | None = None
    values: Wanted | None = None
    that: That | None = None
    within: Annotated[float, Field(ge=0.0)] = 1e-6


class ExpectedTurtle(_Window):
    """Where a turtle is, and its pen."""

    kind = "turtle"
    turtle: Plain
    at_s: Seconds | None = None
    x: float | None = None
    y: float | None = None
    heading_deg: float | None = None
    within: Annotated[float, Field(ge=0.0)] = 0.1
    within_deg: Annotated[float, Field(ge=0.0)] = 5.0
    pen: tuple[int, int, int] | None = None
    pen_off: bool | None = None
    that: That | None = None


class ExpectedMoved(_Expected):
    """What the car does from each call, message or goal of a step on, until the next one of any step."""

    kind = "moved"
    moved: Id
    ahead_m: Number | None = None
    turned_deg: Number | None = None
    within: Annotated[float, Field(ge=0.0)] = 0.05
    within_deg: Annotated[float, Field(ge=0.0)] = 3.0

    @model_validator(mode="after")
    def _wants_something(self) -> Self:
        if self.ahead_m is None and self.turned_deg is None:
            raise MisfitError(misfits.NO_MOTION, "ahead_m")
        return self


EXPECTATIONS: Final = (
    *(
        ExpectedTopic,
        ExpectedAnswer,
        ExpectedGoal,
        ExpectedSet,
        ExpectedParameter,
        ExpectedFrame,
        ExpectedLog,
    ),
    *(
        ExpectedNode,
        ExpectedListener,
        ExpectedService,
        ExpectedClient,
        ExpectedAction,
        ExpectedServed,
        ExpectedTurtle,
        ExpectedMoved,
    ),
)
"""The models of expectations, in the order of the documents."""


def _kind_of(value: Any) -> str | None:
    """Return the tag of the model that an expectation has to fit. ``node`` may stand beside another kind."""
    if isinstance(value, SpecModel):
        return f"<{getattr(value, 'kind', '')}>"
    kinds = [model.kind for model in EXPECTATIONS if isinstance(value, Mapping) and model.kind in value]
    return f"<{min(kinds, key=lambda kind: kind == 'node')}>" if kinds else None


def _known_kind(value: Any) -> Any:
    if _kind_of(value) is None:
        raise MisfitError(misfits.ONE_EXPECTATION)
    return value


ExpectationModel = Annotated[
    Annotated[ExpectedTopic, Tag("<topic>")]
    | Annotated[ExpectedAnswer, Tag("<answer>")]
    | Annotated[ExpectedGoal, Tag("<goal>")]
    | Annotated[ExpectedSet, Tag("<set>")]
    | Annotated[ExpectedParameter, Tag("<parameter>")]
    | Annotated[ExpectedFrame, Tag("<frame>")]
    | Annotated[ExpectedLog, Tag("<log>")]
    | Annotated[ExpectedNode, Tag("<node>")]
    | Annotated[ExpectedListener, Tag("<listener>")]
    | Annotated[ExpectedService, Tag("<service>")]
    | Annotated[ExpectedClient, Tag("<client>")]
    | Annotated[ExpectedAction, Tag("<action>")]
    | Annotated[ExpectedServed, Tag("<served>")]
    | Annotated[ExpectedTurtle, Tag("<turtle>")]
    | Annotated[ExpectedMoved, Tag("<moved>")],
    Discriminator(_kind_of),
    BeforeValidator(_known_kind),
]


def steps_named(expectation: Expectation) -> Iterator[tuple[str, StepKind | None, str]]:
    """Yield the steps that an expectation names: the field, the kind that the step must be of, and its id."""
    kinds: Mapping[str, StepKind] = {"answer": "call", "goal": "goal", "set": "set", "served": "serve"}
    if expectation.kind in kinds:
        yield expectation.kind, kinds[expectation.kind], expectation.target
    if expectation.kind == "moved":
        yield "moved", None, expectation.target
    elif expectation.kind == "parameter" and expectation.step:
        yield "of", "get", expectation.step
    elif expectation.step:
        yield "after", None, expectation.step
