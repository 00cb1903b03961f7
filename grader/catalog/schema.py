"""The schema of ``assignment.yaml``. CONTRIBUTING explains every field to instructors."""

import json
from collections.abc import Sequence
from random import Random
from typing import Annotated, Any, Literal

from pydantic import (
    AfterValidator,
    BeforeValidator,
    Field,
    PlainValidator,
    StrictBool,
    StrictFloat,
    StrictInt,
    StrictStr,
    model_validator,
)

from grader.catalog import misfits
from grader.catalog.attempts import (
    MOST_ATTEMPTS,
    NEEDS_CHANGE,
    NO_CHANGE_OF_PACKAGE,
    Replacement,
    changed,
    edits_of,
)
from grader.catalog.conversation import ExpectationModel, StepModel, steps_named
from grader.catalog.misfits import MisfitError
from grader.catalog.rooms import NoPlaceError, RoomModel
from grader.catalog.spec import Metres, SpecModel, drawn, number_or_range
from grader.contracts.assignment import (
    BY_PERSON,
    EXPECTED,
    MIB,
    ROBOT_COMMANDS,
    ROBOT_TOPICS,
    SUFFIXES,
    TOPIC_PATTERN,
    Across,
    Answer,
    Assignment,
    Case,
    Counts,
    Distro,
    Hints,
    Input,
    ItemSpec,
    Limits,
    PathPiece,
    Profile,
    Region,
    RunsAs,
    StartPose,
    WantedGoal,
    WantedPackage,
    WantedPath,
    WantedPlaces,
    Watch,
    World,
    WorldKind,
    WrongAttempt,
    outside_m,
)
from grader.contracts.conversation import MOST_SENT, MOST_STEPS
from grader.contracts.python import Self
from grader.contracts.text import EMPTY, Text

Id = Annotated[str, Field(pattern=misfits.ID_PATTERN)]
Topic = Annotated[str, Field(pattern=f"^{TOPIC_PATTERN}$")]
MAX_HORIZON_S = 600.0
_MOST = 1_000_000_000  # of a whole number: what a column of every database holds
AnyHeading = Annotated[float, Field(ge=-360.0, le=360.0)]
FIELD_M = 11.0
FREE_M = 0.5  # a drawn start is at least that far from every goal and from what is to be avoided
TRIES = 200
ModelFile = Annotated[str, Field(pattern=r"^([A-Za-z0-9_][A-Za-z0-9_/.-]{0,99}|[*])?$")]
Degrees = Annotated[float, Field(ge=-3600.0, le=3600.0)]


def _one_value(value: object) -> object:
    """Return the value of an option. A list or mapping becomes its text, which the check then refuses."""
    return value if isinstance(value, bool | int | float | str) else json.dumps(value, default=str)


Options = dict[str, Annotated[StrictBool | StrictInt | StrictFloat | StrictStr, BeforeValidator(_one_value)]]


class TextModel(SpecModel):
    """A sentence in both languages."""

    zh: Annotated[str, Field(min_length=1)]
    en: Annotated[str, Field(min_length=1)]

    def to_contract(self) -> Text:
        """Return the contract."""
        return Text(zh=self.zh.strip(), en=self.en.strip())


def _in_cents(points: float) -> float:
    if points != round(points, 2):
        raise MisfitError(misfits.CENTS)
    return points


class ItemModel(SpecModel):
    """A rubric item."""

    id: Id
    title: TextModel
    points: Annotated[float, Field(gt=0.0, le=1000.0), AfterValidator(_in_cents)]
    measure: str = ""
    expect: Annotated[tuple[ExpectationModel, ...], Field(max_length=20)] = ()
    low: float | None = None
    high: float | None = None
    ramp: Annotated[float, Field(ge=0.0)] = 0.0
    needs: tuple[str, ...] = ()
    scaled_by: tuple[str, ...] = ()
    across: Across = "each"
    limit: Annotated[str, Field(max_length=500)] = ""
    hint: TextModel | None = None

    @model_validator(mode="after")
    def _has_band(self) -> Self:
        if bool(self.measure) == bool(self.expect):
            raise MisfitError(misfits.MEASURE_OR_EXPECT, "expect" if self.measure else "measure")
        if self.expect:
            if self.low is not None or self.high is not None or self.ramp:
                raise MisfitError(misfits.MEASURE_OR_EXPECT, "expect")
        elif self.measure == BY_PERSON:
            if self.low is not None or self.high is not None or self.ramp or self.limit or self.hint:
                raise MisfitError(misfits.NO_BAND)
        elif self.low is None and self.high is None:
            raise MisfitError(misfits.BAND_MISSING)
        if self.low is not None and self.high is not None and self.low > self.high:
            raise MisfitError(misfits.swapped(self.low, self.high))
        return self

    def to_contract(self) -> ItemSpec:
        """Return the contract."""
        hint = EMPTY if self.hint is None else self.hint.to_contract()
        own: dict[str, Any] = {"title": self.title.to_contract(), "hint": hint}
        if self.expect:
            own |= {"measure": f"{EXPECTED}.{self.id}", "low": 100.0, "ramp": 100.0}
            own["expect"] = tuple(expectation.to_contract() for expectation in self.expect)
        return ItemSpec(**{**dict(self), **own})


class StartModel(SpecModel):
    """Start pose; turtlesim's field is 11.09 m wide and high, its origin bottom left. Seeds draw from pairs."""

    x_m: Annotated[Metres | tuple[Metres, Metres], BeforeValidator(number_or_range)] = StartPose().x_m
    y_m: Annotated[Metres | tuple[Metres, Metres], BeforeValidator(number_or_range)] = StartPose().y_m
    heading_deg: Annotated[float | tuple[AnyHeading, AnyHeading], BeforeValidator(number_or_range)] = 0.0

    @property
    def beyond_field(self) -> tuple[Text, tuple[int | str, ...]] | None:
        """What does not lie on turtlesim's field, and where it is written."""
        for name in ("x_m", "y_m"):
            value = getattr(self, name)
            for place, each in enumerate(value if isinstance(value, tuple) else (value,)):
                if not 0.0 <= each <= FIELD_M:
                    written_at = (name, place) if isinstance(value, tuple) else (name,)
                    return (misfits.TOO_SMALL if each < 0.0 else misfits.TOO_LARGE), written_at
        return None

    @property
    def is_drawn(self) -> bool:
        """Whether the pose differs from seed to seed."""
        return any(isinstance(value, tuple) for value in (self.x_m, self.y_m, self.heading_deg))

    def to_contract(self, seed: str, taken: Sequence[Region] = ()) -> StartPose:
        """Return the pose of one seed, to the centimetre and the degree where it is drawn.

        Raises MisfitError: no place within the bounds is free.
        """
        source = Random(seed)  # noqa: S311 - the same pose each time, not a secret
        for _ in range(TRIES if self.is_drawn else 1):
            x_m, y_m = drawn(self.x_m, source, 2), drawn(self.y_m, source, 2)
            pose = StartPose(x_m=x_m, y_m=y_m, heading_deg=drawn(self.heading_deg, source, 0))
            if not self.is_drawn or all(outside_m(region, x_m, y_m) >= FREE_M for region in taken):
                return pose
        raise MisfitError(misfits.NO_FREE_PLACE)


class WatchModel(SpecModel):
    """What of a PyBullet world is looked at."""

    object: ModelFile = ""
    robot: ModelFile = ""
    link: Annotated[int, Field(ge=0, le=63)] = 0

    def to_contract(self) -> Watch:
        """Return the contract."""
        return Watch(**dict(self))


class WorldModel(SpecModel):
    """The simulated world: turtlesim's, a robot's, or none where the script brings PyBullet."""

    kind: WorldKind = "turtle"
    watch: WatchModel | None = None
    room: RoomModel | None = None
    topics: dict[Annotated[str, Field(pattern=f"^{TOPIC_PATTERN}$")], Topic] = Field(default_factory=dict)
    profile: Profile = "nominal"
    walls: bool = True
    start: StartModel = StartModel()
    cmd_vel_topic: Topic = "/turtle1/cmd_vel"
    seed: Annotated[int, Field(ge=0, le=_MOST)] = 0
    odometry: bool = False

    @model_validator(mode="before")
    @classmethod
    def _of_a_robot(cls, data: Any) -> Any:
        """Let a robot start in the middle of its coordinates, and hear its own topic."""
        if isinstance(data, dict) and data.get("kind") == "robot":
            start = data.get("start", {})
            if isinstance(start, dict):
                start = {"x_m": 0.0, "y_m": 0.0, **start}
            return {"cmd_vel_topic": ROBOT_COMMANDS, **data, "start": start}
        return data

    @model_validator(mode="after")
    def _fits_its_kind(self) -> Self:
        if (self.kind == "pybullet") != (self.watch is not None):
            raise MisfitError(misfits.NO_WATCH if self.kind == "pybullet" else misfits.NO_PYBULLET, "watch")
        if (self.kind == "robot") != (self.room is not None):
            raise MisfitError(misfits.NO_ROOM if self.kind == "robot" else misfits.NO_ROBOT, "room")
        if self.kind == "robot":
            for name in sorted({"walls", "odometry"} & self.model_fields_set):
                raise MisfitError(misfits.NOT_OF_ROBOTS, name)
            if missing := sorted(set(self.topics) - set(ROBOT_TOPICS)):
                raise MisfitError(misfits.unknown_topic(missing[0], ROBOT_TOPICS), "topics", missing[0])
        elif self.topics:
            raise MisfitError(misfits.NO_ROBOT, "topics")
        elif (beyond := self.start.beyond_field) is not None:
            raise MisfitError(beyond[0], "start", *beyond[1])
        return self

    def to_contract(self, first: Case) -> World:
        """Return the contract; start pose and room are the first case's where they are drawn."""
        start = first.start if self.start.is_drawn and first.start else self.start.to_contract(str(self.seed))
        watch = None if self.watch is None else self.watch.to_contract()
        return World(**{**dict(self), "start": start, "room": first.room, "watch": watch})


class LimitsModel(SpecModel):
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
        same = self.model_dump(exclude={"memory_mib", "output_kib"})
        return Limits(**same, memory_bytes=self.memory_mib * MIB, output_bytes=self.output_kib * 1024)


class RegionModel(SpecModel):
    """A circle (`at` with `within`) or a box: left, bottom, right, top."""

    at: tuple[Metres, Metres] | None = None
    within: Annotated[float, Field(ge=0.02, le=10.0)] = 0.2
    box: tuple[Metres, Metres, Metres, Metres] | None = None

    @model_validator(mode="after")
    def _is_one(self) -> Self:
        box = self.box
        stray = box is not None and "within" in self.model_fields_set
        if (self.at is None) == (box is None) or stray:
            raise MisfitError(misfits.ONE_REGION)
        if box is not None and not (box[0] < box[2] and box[1] < box[3]):
            raise MisfitError(misfits.ONE_REGION)
        return self

    def region(self) -> Region:
        """Return the contract."""
        if self.at is not None:
            return Region(kind="circle", x_m=self.at[0], y_m=self.at[1], radius_m=self.within)
        left, bottom, right, top = self.box or (0.0, 0.0, 0.0, 0.0)
        middle = ((left + right) / 2.0, (bottom + top) / 2.0)
        return Region(kind="box", x_m=middle[0], y_m=middle[1], width_m=right - left, height_m=top - bottom)


class GoalModel(RegionModel):
    """A place to visit, for how long and by when."""

    hold_s: Annotated[float, Field(ge=0.0, le=MAX_HORIZON_S)] = 0.0
    by_s: Annotated[float, Field(gt=0.0, le=MAX_HORIZON_S)] | None = None

    def to_contract(self) -> WantedGoal:
        """Return the contract."""
        return WantedGoal(region=self.region(), hold_s=self.hold_s, by_s=self.by_s)


Goals = Annotated[tuple[GoalModel, ...], Field(min_length=1, max_length=20)]


class PlacesModel(SpecModel):
    """Where to go, in which order, and where not to."""

    visit: Goals
    order: Literal["any", "given"] = "given"
    avoid: Annotated[tuple[RegionModel, ...], Field(max_length=20)] = ()
    end_heading_deg: AnyHeading | None = None

    def to_contract(self) -> WantedPlaces:
        """Return the contract."""
        return WantedPlaces(
            visit=tuple(goal.to_contract() for goal in self.visit),
            any_order=self.order == "any",
            avoid=tuple(region.region() for region in self.avoid),
            end_heading_deg=self.end_heading_deg,
        )

    def taken(self, case: "CaseModel") -> list[Region]:
        """Return where no drawn start may be."""
        visit = case.visit or self.visit
        return [region.region() for region in (*visit, *self.avoid)]


class CaseModel(SpecModel):
    """One run of the script and what it is given."""

    id: Id = "default"
    title: TextModel | None = None
    stdin: str = ""
    args: tuple[str, ...] = ()
    options: Options = Field(default_factory=dict)
    seed: Annotated[int, Field(ge=0, le=_MOST)] | None = None
    start: StartModel | None = None
    visit: Annotated[tuple[GoalModel, ...], Field(max_length=20)] = ()

    def to_contract(self, world: WorldModel, places: PlacesModel | None) -> Case:
        """Return the contract."""
        title = Case().title if self.title is None else self.title.to_contract()
        start = self.start or (world.start if world.start.is_drawn else None)
        visit = tuple(goal.to_contract() for goal in self.visit)
        seed = f"{world.seed if self.seed is None else self.seed} {self.id}"
        taken = places.taken(self) if places else []
        pose = None if start is None else start.to_contract(seed, taken)
        room = None
        if world.room is not None:
            room = world.room.to_contract(seed, pose or world.start.to_contract(seed), taken)
        return Case(**{**dict(self), "title": title, "start": pose, "visit": visit, "room": room})


class PieceModel(SpecModel):
    """A piece of a path: one of `line`, `arc` (with `radius`), `turn` and `goto`."""

    line: Metres | None = None
    arc: Degrees | None = None
    radius: Annotated[float, Field(ge=0.05, le=20.0)] | None = None
    turn: Degrees | None = None
    goto: tuple[Metres, Metres] | None = None

    @model_validator(mode="after")
    def _is_one(self) -> Self:
        pieces = [piece for piece in (self.line, self.arc, self.turn, self.goto) if piece is not None]
        if len(pieces) == 1 and (self.arc is None) != (self.radius is None):
            raise MisfitError(misfits.ARC)
        if len(pieces) != 1 or pieces[0] == 0.0:
            raise MisfitError(misfits.ONE_PIECE)
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


class PathModel(SpecModel):
    """The path that is wanted, and in which ways a driven one may differ from it."""

    pieces: Annotated[tuple[PieceModel, ...], Field(max_length=40)] = ()
    reference: Literal["solution"] | None = None
    start: Literal["any", "given"] = "any"
    scale: Literal["any", "given"] = "given"
    mirror: bool = True
    direction: Literal["any", "given"] = "any"
    laps: bool = True

    @model_validator(mode="after")
    def _is_given_once(self) -> Self:
        if bool(self.pieces) == (self.reference is not None):
            raise MisfitError(misfits.ONE_PATH)
        return self

    def to_contract(self) -> WantedPath:
        """Return the contract."""
        return WantedPath(
            pieces=tuple(piece.to_contract() for piece in self.pieces),
            by_solution=self.reference is not None,
            any_start=self.start == "any",
            any_scale=self.scale == "any",
            mirror=self.mirror,
            any_direction=self.direction == "any",
            laps=self.laps,
        )


class PackageModel(SpecModel):
    """Which part of a package is run."""

    name: Annotated[str, Field(pattern=r"^([a-z][a-z0-9_]{0,59})?$")] = ""
    executable: Annotated[str, Field(max_length=100)] = ""
    launch: Annotated[str, Field(max_length=100)] = ""
    interfaces: bool = False

    @model_validator(mode="after")
    def _is_python(self) -> Self:
        if self.launch and not self.launch.endswith((".py", ".xml", ".yaml", ".yml")):
            raise MisfitError(misfits.NOT_READ, "launch")
        return self

    def to_contract(self) -> WantedPackage:
        """Return the contract."""
        return WantedPackage(**dict(self))


class AnswerModel(SpecModel):
    """A number that students are known to answer."""

    value: float
    tolerance: Annotated[float, Field(ge=0.0)]
    right: bool
    remark: TextModel

    def to_contract(self) -> Answer:
        """Return the contract."""
        return Answer(**{**dict(self), "remark": self.remark.to_contract()})


class WrongModel(SpecModel):
    """A wrong attempt and the score it must get: a file, or a change of the solution or of another script."""

    file: Annotated[str, Field(pattern=misfits.WRONG_FILE_PATTERN)]
    base: str = ""
    about: Annotated[str, Field(pattern=misfits.ABOUT_PATTERN)] | None = None
    change: Annotated[tuple[Replacement, ...], PlainValidator(edits_of)] = ()
    score: tuple[float, float]
    fails: str
    mistake: str = ""

    @model_validator(mode="after")
    def _score_is_a_band(self) -> Self:
        if not 0.0 <= self.score[0] <= self.score[1]:
            raise MisfitError(misfits.SCORE, "score")
        return self

    @model_validator(mode="after")
    def _belongs_to_a_change(self) -> Self:
        for name, given in (("base", self.base != ""), ("about", self.about is not None)):
            if given and not self.change:
                raise MisfitError(NEEDS_CHANGE, name)
        return self

    def made_of(self, base: str) -> str:
        """Return the changed script. Raises MisfitError: the change does not fit `base`."""
        return changed(base, self.change, self.about)

    def to_contract(self) -> WrongAttempt:
        """Return the contract."""
        low, high = self.score
        return WrongAttempt(file=self.file, low=low, high=high, fails=self.fails, mistake=self.mistake)


def _as_contract(value: Any) -> Any:
    """Return a value of the file as an assignment has it: of models, alone or in a tuple, their contracts."""
    if isinstance(value, tuple):
        return tuple(map(_as_contract, value))
    return value.to_contract() if hasattr(value, "to_contract") else value


class AssignmentModel(SpecModel):
    """The whole file."""

    id: Id
    version: Annotated[int, Field(ge=1, le=_MOST)]
    order: Annotated[int, Field(ge=-_MOST, le=_MOST)]
    title: TextModel
    brief: TextModel
    check: str
    input: Input = "script"
    distro: Distro | None = None
    runs_as: RunsAs | None = None
    options: Options = Field(default_factory=dict)
    file_patterns: tuple[str, ...] = ()
    horizon_s: Annotated[float, Field(gt=0.0, le=MAX_HORIZON_S)] = 60.0
    limits: LimitsModel = LimitsModel()
    world: WorldModel = WorldModel()
    cases: Annotated[tuple[CaseModel, ...], Field(min_length=1)] = (CaseModel(),)
    steps: Annotated[tuple[StepModel, ...], Field(max_length=MOST_STEPS)] = ()
    answers: tuple[AnswerModel, ...] = ()
    path: PathModel | None = None
    places: PlacesModel | None = None
    package: PackageModel | None = None
    counts: Counts = "either"
    hints: Hints = Hints.CHANGE
    items: Annotated[tuple[ItemModel, ...], Field(min_length=1)]
    wrong: Annotated[tuple[WrongModel, ...], Field(max_length=MOST_ATTEMPTS)] = ()

    @model_validator(mode="after")
    def _items_fit(self) -> Self:
        ids_so_far: set[str] = set()
        ids = [item.id for item in self.items]
        for i, item in enumerate(self.items):
            if item.id in ids_so_far:
                raise MisfitError(misfits.twice(item.id), "items", i, "id")
            if missing := sorted(set(item.needs) - ids_so_far):
                told = (
                    misfits.not_before(missing[0])
                    if missing[0] in ids
                    else misfits.unknown_item(missing[0], ids)
                )
                raise MisfitError(told, "items", i, "needs")
            ids_so_far.add(item.id)
        measured = {item.id for item in self.items if item.measure != BY_PERSON}
        for i, item in enumerate(self.items):
            if missing := sorted(set(item.scaled_by) - (measured - {item.id})):
                raise MisfitError(misfits.no_other_measure(missing[0]), "items", i, "scaled_by")
        return self

    @model_validator(mode="after")
    def _across_several(self) -> Self:
        for i, item in enumerate(self.items):
            if item.across != "each" and (len(self.cases) < 2 or item.measure == BY_PERSON):
                raise MisfitError(misfits.NOT_ACROSS, "items", i, "across")
        return self

    @model_validator(mode="after")
    def _starts_are_free(self) -> Self:
        for i, case in enumerate(self.cases):
            beyond = None if case.start is None or self.world.kind == "robot" else case.start.beyond_field
            if beyond is not None:
                raise MisfitError(beyond[0], "cases", i, "start", *beyond[1])
            try:
                case.to_contract(self.world, self.places)
            except NoPlaceError as error:
                raise MisfitError(error.told, "world", "room", *error.field) from error
            except MisfitError as error:
                place = ("world",) if case.start is None else ("cases", i)
                raise MisfitError(error.told, *place, "start") from error
        return self

    @model_validator(mode="after")
    def _comes_before_the_end(self) -> Self:
        for i, step in enumerate(self.steps):
            if step.at_s >= self.horizon_s:
                raise MisfitError(misfits.too_late("at_s", self.horizon_s), "steps", i, "at_s")
        for i, goal in enumerate(self.places.visit if self.places else ()):
            if goal.by_s is not None and goal.by_s > self.horizon_s:
                raise MisfitError(misfits.too_late("by_s", self.horizon_s), "places", "visit", i, "by_s")
        return self

    @model_validator(mode="after")
    def _conversation_fits(self) -> Self:
        steps = [step.to_contract(i) for i, step in enumerate(self.steps, 1)]
        kinds = {step.id: step.kind for step in steps}
        for i, step in enumerate(steps):
            if step.id in [earlier.id for earlier in steps[:i]]:
                raise MisfitError(misfits.twice(step.id), "steps", i, "id")
        if sum(step.sends for step in steps) > MOST_SENT:
            raise MisfitError(misfits.TOO_MANY_SENT, "steps")
        types: dict[str, str | None] = {}
        for i, item in enumerate(self.items):
            for k, model in enumerate(item.expect):
                one = model.to_contract()
                for name, kind, step_id in steps_named(one):
                    if step_id not in kinds or (kind is not None and kinds[step_id] != kind):
                        step_ids = [each for each in kinds if kind in (None, kinds[each])]
                        raise MisfitError(
                            misfits.unknown_step(step_id, kind, step_ids), "items", i, "expect", k, name
                        )
                if one.kind == "topic" and types.setdefault(one.target, one.type) != one.type:
                    raise MisfitError(misfits.SAME_TYPE, "items", i, "expect", k, "type")
        return self

    @model_validator(mode="after")
    def _reference_is_a_script(self) -> Self:
        if self.path is not None and self.path.reference is not None and self.input != "script":
            raise MisfitError(misfits.NO_REFERENCE, "path", "reference")
        return self

    @model_validator(mode="after")
    def _names_fit(self) -> Self:
        names = [item.id for item in self.items]
        for i, case in enumerate(self.cases):
            if case.id in {earlier.id for earlier in self.cases[:i]}:
                raise MisfitError(misfits.twice(case.id), "cases", i, "id")
        for i, wrong in enumerate(self.wrong):
            if wrong.fails not in names:
                raise MisfitError(misfits.unknown_item(wrong.fails, names), "wrong", i, "fails")
        return self

    @model_validator(mode="after")
    def _attempts_fit(self) -> Self:
        endings = SUFFIXES[self.input]
        bases = [name + endings[0] for name in ("solution", "starter")]
        for i, wrong in enumerate(self.wrong):
            if not wrong.file.endswith(endings):
                raise MisfitError(misfits.wrong_ending(self.input, endings), "wrong", i, "file")
            if wrong.file in bases:
                raise MisfitError(misfits.twice(wrong.file), "wrong", i, "file")
            if wrong.change and self.input == "package":
                raise MisfitError(NO_CHANGE_OF_PACKAGE, "wrong", i, "change")
            if wrong.base and wrong.base not in bases:
                raise MisfitError(misfits.unknown_base(wrong.base, bases), "wrong", i, "base")
            bases.append(wrong.file)
        return self

    def to_contract(self) -> Assignment:
        """Return the contract."""
        cases = tuple(case.to_contract(self.world, self.places) for case in self.cases)
        others = {
            name: _as_contract(value)
            for name, value in self
            if name not in ("world", "cases", "wrong", "steps")
        }
        others["steps"] = tuple(step.to_contract(i) for i, step in enumerate(self.steps, 1))
        return Assignment(**others, world=self.world.to_contract(cases[0]), cases=cases)

    def attempts(self) -> tuple[WrongAttempt, ...]:
        """Return the expectations for the wrong scripts."""
        return tuple(wrong.to_contract() for wrong in self.wrong)
