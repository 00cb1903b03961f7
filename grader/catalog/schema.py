"""The schema of ``assignment.yaml``. CONTRIBUTING explains every field to instructors."""

from typing import Annotated, Literal, Self

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    StrictBool,
    StrictFloat,
    StrictInt,
    StrictStr,
    model_validator,
)
from pydantic_core import PydanticCustomError

from grader.catalog.misfits import (
    BAND_MISSING,
    CENTS,
    ID_PATTERN,
    INTERFACE_PATTERN,
    NO_BAND,
    ONE_PIECE,
    SCORE,
    WRONG_FILE_PATTERN,
    MisfitError,
    no_other_measure,
    swapped,
    twice,
    unknown_item,
    wrong_ending,
)
from grader.contracts.assignment import (
    BY_PERSON,
    MIB,
    SUFFIXES,
    TOPIC_PATTERN,
    Answer,
    Assignment,
    Case,
    Distro,
    Input,
    ItemSpec,
    Limits,
    PathPiece,
    Profile,
    ServiceCall,
    StartPose,
    WantedPath,
    World,
    WrongAttempt,
)
from grader.contracts.text import Text

Id = Annotated[str, Field(pattern=ID_PATTERN)]
Topic = Annotated[str, Field(pattern=f"^{TOPIC_PATTERN}$")]
Interface = Annotated[str, Field(pattern=INTERFACE_PATTERN)]


def _one_value(value: object) -> object:
    """Refuse what no option can be in one sentence: the union alone has one for each of its types."""
    if not isinstance(value, bool | int | float | str):
        raise PydanticCustomError("option_value", "no value of an option")
    return value


Options = dict[str, Annotated[StrictBool | StrictInt | StrictFloat | StrictStr, BeforeValidator(_one_value)]]
MAX_HORIZON_S = 600.0


class _Model(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=False, allow_inf_nan=False, frozen=True)


class TextModel(_Model):
    """A sentence in both languages."""

    zh: Annotated[str, Field(min_length=1)]
    en: Annotated[str, Field(min_length=1)]

    def to_contract(self) -> Text:
        """Return the contract."""
        return Text(zh=self.zh.strip(), en=self.en.strip())


def _in_cents(points: float) -> float:
    if points != round(points, 2):
        raise MisfitError(CENTS)
    return points


class ItemModel(_Model):
    """A rubric item."""

    id: Id
    title: TextModel
    points: Annotated[float, Field(gt=0.0, le=1000.0), AfterValidator(_in_cents)]
    measure: str
    low: float | None = None
    high: float | None = None
    ramp: Annotated[float, Field(ge=0.0)] = 0.0
    needs: tuple[str, ...] = ()
    scaled_by: tuple[str, ...] = ()

    @model_validator(mode="after")
    def _has_band(self) -> Self:
        if self.measure == BY_PERSON:
            if self.low is not None or self.high is not None or self.ramp:
                raise MisfitError(NO_BAND)
        elif self.low is None and self.high is None:
            raise MisfitError(BAND_MISSING)
        if self.low is not None and self.high is not None and self.low > self.high:
            raise MisfitError(swapped(self.low, self.high))
        return self

    def to_contract(self) -> ItemSpec:
        """Return the contract."""
        return ItemSpec(**{**dict(self), "title": self.title.to_contract()})


class StartModel(_Model):
    """Start pose; the field is 11.09 m wide and high, the origin bottom left."""

    x_m: Annotated[float, Field(ge=0.0, le=11.0)] = StartPose().x_m
    y_m: Annotated[float, Field(ge=0.0, le=11.0)] = StartPose().y_m
    heading_deg: float = 0.0


class WorldModel(_Model):
    """The simulated world."""

    profile: Profile = "nominal"
    walls: bool = True
    start: StartModel = StartModel()
    cmd_vel_topic: Topic = "/turtle1/cmd_vel"
    seed: Annotated[int, Field(ge=0)] = 0
    odometry: bool = False

    def to_contract(self) -> World:
        """Return the contract."""
        return World(**{**dict(self), "start": StartPose(**dict(self.start))})


class LimitsModel(_Model):
    """What one run may use; the defaults are right for ordinary assignments."""

    steps: Annotated[int, Field(ge=1_000, le=100_000_000)] = Limits().steps
    cpu_s: Annotated[float, Field(gt=0.0, le=120.0)] = Limits().cpu_s
    wall_s: Annotated[float, Field(gt=0.0, le=600.0)] = Limits().wall_s
    memory_mib: Annotated[int, Field(ge=64, le=4096)] = Limits().memory_bytes // MIB
    output_kib: Annotated[int, Field(ge=16, le=65536)] = Limits().output_bytes // 1024
    threads: Annotated[int, Field(ge=1, le=256)] = Limits().threads
    grace_cpu_s: Annotated[float, Field(ge=0.0, le=10.0)] = Limits().grace_cpu_s

    def to_contract(self) -> Limits:
        """Return the contract."""
        return Limits(
            steps=self.steps,
            cpu_s=self.cpu_s,
            wall_s=self.wall_s,
            memory_bytes=self.memory_mib * MIB,
            output_bytes=self.output_kib * 1024,
            threads=self.threads,
            grace_cpu_s=self.grace_cpu_s,
        )


class CaseModel(_Model):
    """One run of the script and what it is given."""

    id: Id = "default"
    title: TextModel | None = None
    stdin: str = ""
    args: tuple[str, ...] = ()
    options: Options = {}
    seed: Annotated[int, Field(ge=0)] | None = None

    def to_contract(self) -> Case:
        """Return the contract."""
        title = Case().title if self.title is None else self.title.to_contract()
        return Case(**{**dict(self), "title": title})


Metres = Annotated[float, Field(ge=-50.0, le=50.0)]
Degrees = Annotated[float, Field(ge=-3600.0, le=3600.0)]


class PieceModel(_Model):
    """A piece of a path: one of `line`, `arc` (with `radius`), `turn` and `goto`."""

    line: Metres | None = None
    arc: Degrees | None = None
    radius: Annotated[float, Field(ge=0.05, le=20.0)] | None = None
    turn: Degrees | None = None
    goto: tuple[Metres, Metres] | None = None

    @model_validator(mode="after")
    def _is_one(self) -> Self:
        given = [each for each in (self.line, self.arc, self.turn, self.goto) if each is not None]
        if len(given) != 1 or (self.arc is None) != (self.radius is None) or given[0] == 0.0:
            raise MisfitError(ONE_PIECE)
        return self

    def to_contract(self) -> PathPiece:
        """Return the contract."""
        if self.line is not None:
            return PathPiece(kind="line", length_m=self.line)
        if self.arc is not None:
            return PathPiece(kind="arc", angle_deg=self.arc, radius_m=self.radius or 0.0)
        if self.goto is not None:
            return PathPiece(kind="goto", x_m=self.goto[0], y_m=self.goto[1])
        return PathPiece(kind="turn", angle_deg=self.turn or 0.0)


class PathModel(_Model):
    """The path that is wanted, and in which ways a driven one may differ from it."""

    pieces: Annotated[tuple[PieceModel, ...], Field(min_length=1, max_length=40)]
    start: Literal["any", "given"] = "any"
    scale: Literal["any", "given"] = "given"
    mirror: bool = True
    direction: Literal["any", "given"] = "any"
    laps: bool = True

    def to_contract(self) -> WantedPath:
        """Return the contract."""
        return WantedPath(
            pieces=tuple(piece.to_contract() for piece in self.pieces),
            any_start=self.start == "any",
            any_scale=self.scale == "any",
            mirror=self.mirror,
            any_direction=self.direction == "any",
            laps=self.laps,
        )


class CallModel(_Model):
    """A request to a service of the script, `at_s` seconds after its start or as soon as it is offered."""

    at_s: Annotated[float, Field(ge=0.0, le=MAX_HORIZON_S)] = 1.0
    service: Topic
    type: Interface
    values: Options = {}

    def to_contract(self) -> ServiceCall:
        """Return the contract."""
        return ServiceCall(
            at_ns=round(self.at_s * 1e9), service=self.service, type=self.type, values=dict(self.values)
        )


class AnswerModel(_Model):
    """A number that students are known to answer."""

    value: float
    tolerance: Annotated[float, Field(ge=0.0)]
    right: bool
    remark: TextModel

    def to_contract(self) -> Answer:
        """Return the contract."""
        return Answer(**{**dict(self), "remark": self.remark.to_contract()})


class WrongModel(_Model):
    """A wrong file and the score it must get."""

    file: Annotated[str, Field(pattern=WRONG_FILE_PATTERN)]
    score: tuple[float, float]
    fails: str
    mistake: str = ""

    @model_validator(mode="after")
    def _score_is_a_band(self) -> Self:
        if not 0.0 <= self.score[0] <= self.score[1]:
            raise MisfitError(SCORE, "score")
        return self

    def to_contract(self) -> WrongAttempt:
        """Return the contract."""
        low, high = self.score
        return WrongAttempt(file=self.file, low=low, high=high, fails=self.fails, mistake=self.mistake)


class AssignmentModel(_Model):
    """The whole file."""

    id: Id
    version: Annotated[int, Field(ge=1)]
    order: int
    title: TextModel
    brief: TextModel
    check: str
    input: Input = "script"
    distro: Distro | None = None
    options: Options = {}
    file_patterns: tuple[str, ...] = ()
    horizon_s: Annotated[float, Field(gt=0.0, le=MAX_HORIZON_S)] = 60.0
    limits: LimitsModel = LimitsModel()
    world: WorldModel = WorldModel()
    cases: Annotated[tuple[CaseModel, ...], Field(min_length=1)] = (CaseModel(),)
    calls: tuple[CallModel, ...] = ()
    answers: tuple[AnswerModel, ...] = ()
    path: PathModel | None = None
    items: Annotated[tuple[ItemModel, ...], Field(min_length=1)]
    wrong: tuple[WrongModel, ...] = ()

    @model_validator(mode="after")
    def _items_fit(self) -> Self:
        seen: set[str] = set()
        for i, item in enumerate(self.items):
            if item.id in seen:
                raise MisfitError(twice(item.id), "items", i, "id")
            if missing := sorted(set(item.needs) - seen):
                raise MisfitError(unknown_item(missing[0]), "items", i, "needs")
            seen.add(item.id)
        measured = {item.id for item in self.items if item.measure != BY_PERSON}
        for i, item in enumerate(self.items):
            if missing := sorted(set(item.scaled_by) - (measured - {item.id})):
                raise MisfitError(no_other_measure(missing[0]), "items", i, "scaled_by")
        return self

    @model_validator(mode="after")
    def _names_fit(self) -> Self:
        names = {item.id for item in self.items}
        for i, case in enumerate(self.cases):
            if case.id in {earlier.id for earlier in self.cases[:i]}:
                raise MisfitError(twice(case.id), "cases", i, "id")
        for i, wrong in enumerate(self.wrong):
            if wrong.fails not in names:
                raise MisfitError(unknown_item(wrong.fails), "wrong", i, "fails")
            if not wrong.file.endswith(endings := SUFFIXES[self.input]):
                raise MisfitError(wrong_ending(self.input, endings), "wrong", i, "file")
        return self

    def to_contract(self) -> Assignment:
        """Return the contract."""
        return Assignment(
            id=self.id,
            version=self.version,
            order=self.order,
            title=self.title.to_contract(),
            brief=self.brief.to_contract(),
            check=self.check,
            options=dict(self.options),
            file_patterns=self.file_patterns,
            horizon_s=self.horizon_s,
            limits=self.limits.to_contract(),
            world=self.world.to_contract(),
            cases=tuple(case.to_contract() for case in self.cases),
            input=self.input,
            distro=self.distro,
            calls=tuple(call.to_contract() for call in self.calls),
            answers=tuple(answer.to_contract() for answer in self.answers),
            path=None if self.path is None else self.path.to_contract(),
            items=tuple(item.to_contract() for item in self.items),
        )

    def attempts(self) -> tuple[WrongAttempt, ...]:
        """Return the expectations for the wrong scripts."""
        return tuple(wrong.to_contract() for wrong in self.wrong)
