"""An assignment as data: what is handed in, in which world and under which limits it runs, how it earns points."""

import json
import math
from dataclasses import replace
from typing import Final, Literal, get_args

from grader.contracts.conversation import Expectation, Step
from grader.contracts.python import StrEnum
from grader.contracts.record import Record, field, from_plain, to_plain
from grader.contracts.rubric import summed
from grader.contracts.text import EMPTY, Language, Text

Profile = Literal["nominal", "rough"]
Input = Literal["script", "text", "package"]
Across = Literal["each", "worst", "mean"]
Distro = Literal["humble", "jazzy"]
"""A release of ROS 2."""

DISTROS: Final[tuple[Distro, ...]] = get_args(Distro)
DEFAULT_DISTRO: Final[Distro] = "humble"

RunsAs = Literal["python", "ros2_run"]
"""How a script is started: ``python3 script.py``, or by calling its `main`, as an executable of a package does."""

WAYS_TO_RUN: Final[tuple[RunsAs, ...]] = get_args(RunsAs)
DEFAULT_WAY: Final[RunsAs] = "python"
SUFFIXES: dict[Input, tuple[str, ...]] = {
    "script": (".py",),
    "text": (".txt", ".md"),
    "package": (".zip",),
}
"""Endings of handed-in files, by kind of input. The assignment's own files have the first one."""

BY_PERSON = "by_person"
"""The measure of rubric items that a person judges. They have no band and earn nothing until then."""

EXPECTED = "expected"
"""Begins the measures of items that expect something, before their ids."""


# Within a second, as any program starts: who counts whole seconds only is wrong here as at home. Five eighths, so
# that floating point rounds times as it would from a whole second on.
EPOCH_NS: Final = 1_700_000_000_625_000_000
"""Wall clock that a script reads at virtual time 0, nanoseconds since 1970."""

WINDOW_M: Final = 11.088889122009277
"""Side of turtlesim's window: 499 pixels at 45 per metre, which turtlesim keeps in 32 bits (turtle_frame.cpp)."""


MIB: Final = 1024 * 1024


class Limits(Record):
    """Budget of one jailed run.

    Attributes:
        steps: what a script may do, counted by its own process, so that it ends at the same place on every
            machine: a wait, a callback, a look at a clock, a publish, and ten turns of a loop are a step each
            (a hundred turns where the loop waits for another thread).
            Exceeding it is the student's ``cpu_limit``, and so is `cpu_s`.
        cpu_s: CPU seconds of the student's process, for what cannot be counted; far more than `steps` take.
        wall_s: time without the host's delays; exceeding it is the student's ``stalled``. See docs/sandbox.md.
        memory_bytes: private memory of the student's process.
        output_bytes: bytes on stdout and stderr together before the run is ended.
        threads: most threads at once.
        grace_cpu_s: CPU seconds left to `except KeyboardInterrupt` / `finally` after the horizon.
    """

    steps: int = 1_500_000
    cpu_s: float = 30.0
    wall_s: float = 120.0
    memory_bytes: int = 512 * MIB
    output_bytes: int = 4 * MIB
    threads: int = 64
    grace_cpu_s: float = 1.0


class StartPose(Record):
    """Pose of the car at the start of an episode, in turtlesim's frame."""

    x_m: float = WINDOW_M / 2.0
    y_m: float = WINDOW_M / 2.0
    heading_deg: float = 0.0


TOPIC_PATTERN: Final = r"(/[A-Za-z_][A-Za-z0-9_]*)+"
"""A fully qualified name of a topic or service, by the rules of ROS 2."""


WorldKind = Literal["turtle", "robot", "pybullet"]
SolidKind = Literal["edge", "wall", "box", "cylinder", "ramp"]

ROBOT_COMMANDS: Final = "/cmd_vel"
"""The topic that moves a robot unless the assignment says otherwise."""


ROBOT_TOPICS: Final = (
    "/odom",
    "/tf",
    "/tf_static",
    "/joint_states",
    "/imu",
    "/scan",
    "/camera/image_raw",
    "/camera/image_raw/compressed",
    "/clock",
)
"""What a robot publishes, by its usual names."""


class Solid(Record):
    """Something in a room that stands on the floor and does not move.

    Attributes:
        kind: an outer wall (``edge``), a ``wall`` within the room, a ``box``, a ``cylinder``, or a ``ramp`` that
            rises along its own x axis, from the floor to its height.
        x_m, y_m: its middle.
        heading_deg: where its own x axis points.
        length_m, width_m: along its own x and y axis; of a cylinder both are its diameter.
        height_m: how high it stands, or rises.
    """

    kind: SolidKind
    x_m: float
    y_m: float
    heading_deg: float = 0.0
    length_m: float
    width_m: float
    height_m: float


class Stripe(Record):
    """A line on the floor of a room: seen by a camera, felt by nothing.

    Attributes:
        points_m: its corners, in order. width_m: how wide it is.
        colour: red, green and blue, 0 to 1.
    """

    points_m: tuple[tuple[float, float], ...]
    width_m: float = 0.05
    colour: tuple[float, float, float] = (0.05, 0.05, 0.05)


class Room(Record):
    """Where a robot drives.

    Attributes:
        left_m, bottom_m, right_m, top_m: the floor. Its outer walls are among the solids.
    """

    left_m: float
    bottom_m: float
    right_m: float
    top_m: float
    solids: tuple[Solid, ...] = ()
    stripes: tuple[Stripe, ...] = ()


class Watch(Record):
    """What of a PyBullet world is looked at.

    Attributes:
        object: file of the body whose way is recorded, such as ``cube_small.urdf``; ``*``: the first that can
            drive; empty: none.
        robot: file of the body of whose links one is recorded; empty: none. link: number of that.
    """

    object: str = ""
    robot: str = ""
    link: int = 0


class World(Record):
    """The simulated world of an episode.

    Attributes:
        kind: turtlesim's (``turtle``), a ``robot`` with sensors in a room, or none, for a script that brings
            ``pybullet``.
        room: of a robot. topics: other names of what it publishes, by the usual ones.
        profile: ``nominal`` obeys commands as turtlesim does; ``rough`` adds lag, slip and seeded noise.
        walls: whether turtlesim's window edges stand as walls.
        cmd_vel_topic: fully qualified topic that moves the car.
        seed: of the rough profile's noise.
        odometry: whether the car publishes ``/odom`` and ``/tf``, which turtlesim does not.
        watch: of a PyBullet world.
    """

    profile: Profile = "nominal"
    walls: bool = True
    start: StartPose = field(default_factory=StartPose)
    cmd_vel_topic: str = "/turtle1/cmd_vel"
    seed: int = 0
    odometry: bool = False
    kind: WorldKind = "turtle"
    room: Room | None = None
    topics: dict[str, str] = field(default_factory=dict)
    watch: Watch | None = None

    @property
    def window(self) -> bool:
        """Whether the edges of turtlesim's window stand as walls."""
        return self.walls and self.kind == "turtle"


Scalar = float | int | str | bool


class InterfaceDefinition(Record):
    """A message, service or action that an assignment brings along.

    Attributes:
        name: e.g. ``rosclaw_msgs/srv/GetCapabilities``.
        lines: what it consists of, in the form of an entry of `grader/shim/rosidl_data`.
    """

    name: str
    lines: str


class Region(Record):
    """A part of the field.

    Attributes:
        kind: a ``circle`` or a ``box`` along the axes.
        x_m, y_m: its middle.
        radius_m: of a circle.
        width_m, height_m: of a box, along x and y.
    """

    kind: Literal["circle", "box"]
    x_m: float
    y_m: float
    radius_m: float = 0.0
    width_m: float = 0.0
    height_m: float = 0.0


def outside_m(region: Region, x_m: float, y_m: float) -> float:
    """Return how far a point is from a region; 0 within it."""
    dx, dy = abs(x_m - region.x_m), abs(y_m - region.y_m)
    if region.kind == "circle":
        return max(math.hypot(dx, dy) - region.radius_m, 0.0)
    return math.hypot(max(dx - region.width_m / 2.0, 0.0), max(dy - region.height_m / 2.0, 0.0))


class WantedGoal(Record):
    """A place to go to.

    Attributes:
        region: the car has reached it once it is in there.
        hold_s: for how long it must stay in there.
        by_s: when it must have come at the latest; None: at any time.
    """

    region: Region
    hold_s: float = 0.0
    by_s: float | None = None


class WantedPlaces(Record):
    """The places that an assignment asks for.

    Attributes:
        visit: where to go; a case may have goals of its own.
        any_order: they may be visited in any order; else one after the other as they stand here.
        avoid: where the car must not go.
        end_heading_deg: where it must look in the end; None: anywhere.
    """

    visit: tuple[WantedGoal, ...]
    any_order: bool = False
    avoid: tuple[Region, ...] = ()
    end_heading_deg: float | None = None


class Case(Record):
    """One run of the script: what it is given. Most assignments have the single case ``default``.

    Attributes:
        options: take the place of the assignment's options in this run.
        seed: takes the place of the world's seed in this run, unless None.
        start: takes the place of the world's start pose, unless None.
        visit: take the place of the goals of the assignment's places, unless there are none.
        room: takes the place of the world's room, unless None.
    """

    id: str = "default"
    title: Text = EMPTY
    stdin: str = ""
    args: tuple[str, ...] = ()
    options: dict[str, Scalar] = field(default_factory=dict)
    seed: int | None = None
    start: StartPose | None = None
    visit: tuple[WantedGoal, ...] = ()
    room: Room | None = None


class PathPiece(Record):
    """One piece of a wanted path, from where the one before ended.

    Attributes:
        kind: ``line`` straight on, ``arc`` along a circle, ``turn`` on the spot, ``goto`` straight to a point.
        length_m: of a line.
        angle_deg: of an arc or a turn, positive to the left.
        radius_m: of an arc.
        x_m, y_m: the point to go to, seen from the path's start: x ahead, y to the left.
    """

    kind: Literal["line", "arc", "turn", "goto"]
    length_m: float = 0.0
    angle_deg: float = 0.0
    radius_m: float = 0.0
    x_m: float = 0.0
    y_m: float = 0.0


class WantedPath(Record):
    """The path that an assignment asks for, and in which ways a driven one may differ from it.

    Attributes:
        pieces: what it consists of; none where it is what the solution drives.
        by_solution: it is what the solution drives. trace: points of that, from the origin along the x axis; none
            until they are recorded.
        any_start: it may lie and point anywhere; else it begins at the world's start pose.
        any_scale: it may be larger or smaller as a whole.
        mirror: its mirror image is as good.
        any_direction: it may be driven from its end to its start; a closed one may begin at any of its pieces.
        laps: a closed one may be driven over and over again.
    """

    pieces: tuple[PathPiece, ...] = ()
    by_solution: bool = False
    trace: tuple[tuple[float, float], ...] = ()
    any_start: bool = True
    any_scale: bool = False
    mirror: bool = True
    any_direction: bool = True
    laps: bool = True


class WantedPackage(Record):
    """Which part of a handed-in package is run.

    Attributes:
        name: what the package must be called; empty: anything.
        executable: as ``ros2 run`` names it; empty: the only one.
        launch: name of the launch file that is started instead, such as ``drive.launch.py``; empty: none.
        interfaces: whether packages of CMake in it may define messages, services and actions.
    """

    name: str = ""
    executable: str = ""
    launch: str = ""
    interfaces: bool = False


class Hints(StrEnum):
    """How much is told of lost points: what was measured; also in which line; also a change that was tried."""

    FACT = "fact"
    LINE = "line"
    CHANGE = "change"


class ItemSpec(Record):
    """One rubric item as the instructor wrote it.

    Credit falls smoothly with the error e = distance of the measure from [low, high]: full at e = 0,
    zero from e = ramp on.

    Attributes:
        measure: name of a quantity that the assignment's check computes, or `BY_PERSON`.
        low, high: band of full credit (None: unbounded on that side).
        ramp: width outside the band over which credit falls to zero (0: all or nothing).
        needs: ids of items that must not have failed; otherwise this one is ``not_checked``. Where one of them
            earned less than half of its points, this one counts in proportion, unless a person judges it.
        scaled_by: ids of items on whose measures this one's points depend as well: it earns the least share of
            the credit that they and it have. They may come later and need this one: what it lost to them does not
            count against them a second time.
        across: with several cases, ``each`` earns its share of the points; or the ``worst`` of them, or the
            ``mean`` of what was measured in them, earns all.
        expect: what is wanted of the script, in place of a measure: the item earns the share that is met.
        hint: what the teacher says where the item loses points, before anything else is said; may be empty.
        limit: why a motion may differ without any loss, within the band or in what nothing measures; empty: it
            should not by much.
    """

    id: str
    title: Text
    points: float
    measure: str
    low: float | None = None
    high: float | None = None
    ramp: float = 0.0
    needs: tuple[str, ...] = ()
    scaled_by: tuple[str, ...] = ()
    across: Across = "each"
    limit: str = ""
    expect: tuple[Expectation, ...] = ()
    hint: Text = EMPTY


class Answer(Record):
    """A number that students are known to answer, and what it tells about their thinking.

    Attributes:
        right: whether it earns the points. There may be several, for different readings of the question.
        remark: which reading or mistake leads to this number.
    """

    value: float
    tolerance: float
    right: bool
    remark: Text


_GRADE_NOTHING = frozenset({"id", "version", "order", "title", "brief", "file_patterns", "items", "hints"})


Counts = Literal["driven", "either"]


class Assignment(Record):
    """A validated assignment.

    Attributes:
        input: what is handed in: a ``script`` or a ``package`` (a zip), which is run, or a ``text`` to be read.
        check: kind of check, a key of the table in `grader.checks`.
        options: the check's own options, validated by it.
        file_patterns: shell patterns of file names that tell this assignment.
        horizon_s: virtual seconds after which the script sees Ctrl+C.
        order: position on the checklist.
        steps: what is said to the script in every run.
        answers: of a question whose answer is a number.
        package: what of a package is run; None: its only executable.
        path: what the check ``path`` compares with. places: where the check ``places`` looks.
        interfaces: which the script can import besides ROS's own.
        distro: release of ROS 2 that the script finds; None: the course's, see `of_course` and `release`.
        runs_as: how a script is started; None: as the course says, see `of_course` and `started_as`.
        counts: where commands come faster than turtlesim takes them, score what the turtle ``driven`` did, or
            ``either`` that or the motion as commanded, whichever is better as a whole.
        hints: how much students are told of lost points, where their course does not say otherwise.
    """

    id: str
    version: int
    order: int
    title: Text
    brief: Text
    check: str
    items: tuple[ItemSpec, ...]
    options: dict[str, Scalar] = field(default_factory=dict)
    file_patterns: tuple[str, ...] = ()
    horizon_s: float = 60.0
    limits: Limits = field(default_factory=Limits)
    world: World = field(default_factory=World)
    cases: tuple[Case, ...] = field(default_factory=lambda: (Case(),))
    input: Input = "script"
    steps: tuple[Step, ...] = ()
    answers: tuple[Answer, ...] = ()
    interfaces: tuple[InterfaceDefinition, ...] = ()
    distro: Distro | None = None
    runs_as: RunsAs | None = None
    path: WantedPath | None = None
    places: WantedPlaces | None = None
    package: WantedPackage | None = None
    counts: Counts = "either"
    hints: Hints = Hints.CHANGE

    @property
    def release(self) -> Distro:
        """The release of ROS 2 that the script finds."""
        return self.distro or DEFAULT_DISTRO

    @property
    def started_as(self) -> RunsAs:
        """How a script is started."""
        return self.runs_as or DEFAULT_WAY

    def of_course(self, distro: Distro | None, runs_as: RunsAs | None) -> "Assignment":
        """Return the assignment as a course of these settings grades it; its own settings come first."""
        way = self.runs_as or (
            runs_as if runs_as != DEFAULT_WAY else None
        )  # else it differs from stored ones
        return replace(self, distro=self.distro or distro, runs_as=way)

    @property
    def expectations(self) -> tuple[Expectation, ...]:
        """What the rubric's items expect of the script."""
        return tuple(expectation for item in self.items for expectation in item.expect)

    @property
    def max_score(self) -> float:
        """Sum of the items' points over all cases."""
        return summed(item.points for item in self.items)

    def in_case(self, case_id: str) -> "Assignment":
        """Return the assignment with those values replaced that one of its cases gives itself."""
        case = next((case for case in self.cases if case.id == case_id), None)
        if case is None:
            return self
        world, places = self.world, self.places
        if case.seed is not None or case.start is not None:
            seed = world.seed if case.seed is None else case.seed
            world = replace(world, seed=seed, start=case.start or world.start)
        if case.room is not None:
            world = replace(world, room=case.room)
        if case.visit and places is not None:
            places = replace(places, visit=case.visit)
        options = {**self.options, **case.options}
        return replace(self, options=options, world=world, places=places)

    def item_on(self, measure: str) -> ItemSpec | None:
        """Return the first item that judges `measure`, or None."""
        return next((item for item in self.items if item.measure == measure), None)

    def item_title(self, item_id: str, language: Language) -> str:
        """Return the title of an item of a report, with the case where there are several; unknown ids stay."""
        case_id, _, name = item_id.rpartition("/")
        title = next((item.title.get(language) for item in self.items if item.id == name), name)
        case = next((case.title.get(language) for case in self.cases if case.id == case_id), "") or case_id
        return f"{title} ({case})" if case else title


def graded_otherwise(before: Assignment, after: Assignment) -> tuple[str, ...]:
    """Return which fields make `after` grade otherwise, such as ``horizon_s`` or ``items.sides.high``.

    Texts, how much is told, the place on the checklist and the names of files grade nothing.
    """
    old, new = to_plain(before), to_plain(after)
    changed = [name for name in new if name not in _GRADE_NOTHING and old[name] != new[name]]
    items_before = {item.id: to_plain(item) for item in before.items}
    for item in after.items:
        was = items_before.pop(item.id, None)
        if was is None:
            changed.append(f"items.{item.id}")
        else:
            fields = {name: value for name, value in to_plain(item).items() if name not in ("title", "hint")}
            changed += [f"items.{item.id}.{name}" for name, value in fields.items() if was[name] != value]
    return (*changed, *(f"items.{gone}" for gone in items_before))


class WrongAttempt(Record):
    """A wrong script that comes with an assignment, and the verdict it must get.

    Attributes:
        file: name inside the assignment's ``wrong`` folder.
        low, high: bounds of the expected score, inclusive.
        fails: id of the rubric item that must lose credit (failed or partial).
        mistake: code that must be recognised first, or empty.
    """

    file: str
    low: float
    high: float
    fails: str
    mistake: str = ""


def stored_assignment(content: bytes | str) -> Assignment:
    """Return an assignment that was stored with a grading, maybe before `steps` took the place of two fields.

    Raises ValueError: it is none.
    """
    fields = json.loads(content)
    for name in ("calls", "agent"):
        fields.pop(name, None)
    return from_plain(Assignment, fields)
