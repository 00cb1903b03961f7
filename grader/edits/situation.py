"""What a search for a change begins with: the script, what its lines did, and what was wanted of the car."""

import ast
import itertools
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

from grader.contracts.outcome import RunOutcome, RunStatus, StudentError
from grader.edits.received import Ledger, Motion
from grader.edits.slices import calls_of, dotted
from grader.edits.tree import Edit, ParsedScript

HOLD_NS = 1_000_000_000
"""For so long turtlesim obeys the last command."""
_SLOW = 1e-6
OFF_SHARE = 0.03
"""Of the size of a motion: what turtlesim's updates and the period of a loop add or take away."""
_ALIKE = 0.1  # of a motion's time: what updates and the period of a loop change is less
_MOST_MOTIONS = 8
_MOST_LINES = 12
_IN_NOTE = re.compile(r"[^:]*?(?:\bline (\d{1,7}))?: (\w+)(?:: (.*))?", re.DOTALL | re.ASCII)


@dataclass(frozen=True)
class WantedSizes:
    """Sizes that the assignment names: of turns, of drives, and of how many of something.

    `arcs`: radius in m (0: any) and angle in degrees (to the left positive) of each arc of the path, in order.
    `at_least_m`: whether a drive may be longer.
    """

    turns_deg: tuple[float, ...] = ()
    lengths_m: tuple[float, ...] = ()
    counts: tuple[int, ...] = ()
    arcs: tuple[tuple[float, float], ...] = ()
    at_least_m: bool = False


@dataclass(frozen=True)
class Stated:
    """What an assignment names beside sizes.

    Attributes:
        names: of topics, services, actions, nodes, parameters. kinds: classes of messages, services, actions.
        fields: of what is expected. inputs: fields of what is sent. logs: whether log messages are expected.
        levels: distances in m that a robot is to keep. goals: places in m that are to be reached.
        slips: whether the car obeys only roughly.
    """

    names: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    kinds: frozenset[str] = frozenset()
    fields: frozenset[str] = frozenset()
    inputs: tuple[str, ...] = ()
    rates_hz: tuple[float, ...] = ()
    levels: tuple[float, ...] = ()
    goals: tuple[tuple[float, float], ...] = ()
    logs: bool = False
    slips: bool = False


@dataclass(frozen=True)
class Driven:
    """A motion with its size: how far it drove or turned, and for how long it lasted.

    Attributes:
        is_held: no command ended it, turtlesim did, a second after its last one.
    """

    motion: Motion
    seconds: float
    is_held: bool = False

    @property
    def length_m(self) -> float:
        """How far it drove, backwards negative."""
        return self.motion.v * self.seconds

    @property
    def angle_deg(self) -> float:
        """How far it turned, to the left positive."""
        return math.degrees(self.motion.w * self.seconds)

    @property
    def is_turn(self) -> bool:
        """Whether it turns and does not drive."""
        return abs(self.motion.v) <= _SLOW < abs(self.motion.w)

    @property
    def is_drive(self) -> bool:
        """Whether it drives and does not turn."""
        return abs(self.motion.w) <= _SLOW < abs(self.motion.v)

    @property
    def is_arc(self) -> bool:
        """Whether it does both."""
        return abs(self.motion.w) > _SLOW and abs(self.motion.v) > _SLOW


@dataclass(frozen=True)
class Proposal:
    """A change that may be the cause of what went wrong.

    Attributes:
        code: the operator. cost: the less, the more plausible. values: what its sentence names.
    """

    code: str
    cost: float
    edits: tuple[Edit, ...]
    values: Mapping[str, object] = field(default_factory=dict)


@dataclass(frozen=True)
class Cause:
    """A measured fact about a line. `values`: what its sentence ``cause.<code>`` names beside the line."""

    code: str
    line: int
    values: dict[str, object] = field(default_factory=dict)


def replacing(
    script: ParsedScript,
    code: str,
    cost: float,
    node: ast.expr | ast.stmt,
    new: str,
    /,
    *others: Edit,
    **values: object,
) -> Proposal:
    """Return the proposal that puts `new` in the place of a node, with other edits. `values` are named as well."""
    values = {"line": node.lineno, "old": script.source(node), "new": new, **values}
    return Proposal(code, cost, (script.replaced(node, new), *others), values)


def removing(script: ParsedScript, cost: float, statement: ast.stmt) -> Proposal:
    """Return the proposal that takes a statement out."""
    values = {"line": statement.lineno, "old": script.source(statement)}
    return Proposal("removed", cost, (script.removed(statement),), values)


def _all_fit(sizes: Sequence[float], wanted: Sequence[float]) -> bool:
    """Whether sizes have one sign, and each is one of those that are wanted."""
    return len({size > 0.0 for size in sizes}) == 1 and all(
        any(abs(abs(size) - abs(one)) <= OFF_SHARE * abs(one) for one in wanted) for size in sizes
    )


@dataclass(frozen=True)
class Situation:
    """A script that lacks marks, with what its traced run told.

    Attributes:
        topic: moves the car. lost: names of the measures that cost points.
        fields: those that a message has, where an exception says that it lacks one. asked: beside sizes.
    """

    script: ParsedScript
    ledger: Ledger
    outcome: RunOutcome
    wanted: WantedSizes
    topic: str = "/turtle1/cmd_vel"
    lost: frozenset[str] = frozenset()
    fields: tuple[str, ...] = ()
    asked: Stated = field(default_factory=Stated)

    @cached_property
    def failure(self) -> StudentError | None:
        """The exception that ended the script, or else the first one that something in it has caught."""
        if self.outcome.status is RunStatus.CRASHED:
            return self.outcome.error
        for note in self.outcome.notes if self.outcome.status is not RunStatus.SYNTAX_ERROR else ():
            if note.code == "caught" and (match := _IN_NOTE.fullmatch(note.text)) is not None:
                line = int(match[1] or 0) or None
                message, meant, name = (match[3] or "").partition(". Did you mean: ")
                return StudentError(type=match[2], message=message, line=line, traceback=meant + name)
        return None

    @cached_property
    def driven(self) -> tuple[Driven, ...]:
        """The motions with their sizes, without stops."""
        motions = self.ledger.motions
        ends = [*(one.t for one in motions[1:]), *([self.outcome.duration_ns] if motions else [])]
        return tuple(
            Driven(one, max(min(end, one.until + HOLD_NS) - one.t, 0) / 1e9, end > one.until + HOLD_NS)
            for one, end in zip(motions, ends, strict=True)
            if not one.is_stop
        )

    @property
    def comes_to_rest(self) -> bool:
        """Whether the script commanded motions, and none up to its end."""
        if not self.driven:
            return False
        until_ns = self.driven[-1].motion.t + round(self.driven[-1].seconds * 1e9)
        return until_ns < self.outcome.duration_ns - HOLD_NS or self.outcome.status is RunStatus.FINISHED

    def sizes_beside(self, unit: str) -> frozenset[float]:
        """Return the sizes of the other kind of motion: of the drives for ``deg``, of the turns for ``m``."""
        if unit == "deg":
            return frozenset(round(abs(one.length_m), 2) for one in self.driven if one.is_drive)
        return frozenset(round(abs(one.angle_deg), 1) for one in self.driven if one.is_turn)

    @cached_property
    def rounds_missing(self) -> int:
        """How many drives are missing, where each one and each turn has the wanted size; negative: too many.

        0 also where something else is wrong: then a count is not why marks are lost.
        """
        if not self.wanted.counts or not self.comes_to_rest or any(one.is_arc for one in self.driven):
            return 0
        rounds = [
            sum(one.length_m if is_drive else one.angle_deg for one in group)
            for is_drive, group in itertools.groupby(self.driven, key=lambda one: one.is_drive)
        ]
        first = 0 if self.driven[0].is_drive else 1
        drives, turns = rounds[first::2], rounds[1 - first :: 2]
        lengths = self.wanted.lengths_m if "side_error_pct" in self.lost else drives[:1]
        if _all_fit(drives, lengths) and _all_fit(turns, self.wanted.turns_deg):
            return self.wanted.counts[0] - len(drives)
        return 0

    def is_part(self, driven: Driven) -> bool:
        """Whether the next command goes on with a motion at another rate, as a controller does: one of many."""
        motion = driven.motion
        pairs = itertools.pairwise(self.ledger.motions)
        after = next((later for earlier, later in pairs if earlier is motion), None)
        if after is None or after.line != motion.line:
            return False
        return (motion.w * after.w if driven.is_turn else motion.v * after.v) > 0.0

    @cached_property
    def usual_lengths_m(self) -> tuple[float, ...]:
        """The length of most drives, where all are to be equal and some are not."""
        lengths = [round(abs(one.length_m), 1) for one in self.driven if one.is_drive]
        usual = max(lengths, key=lengths.count, default=0.0)
        is_asked = "side_spread_pct" in self.lost and lengths.count(usual) > len(lengths) / 2
        return (usual,) if is_asked and usual else ()

    @cached_property
    def distinct(self) -> tuple[Driven, ...]:
        """Of the motions that one line published with one command for about as long, the first; few of them."""
        first: dict[tuple[int, float, float], list[Driven]] = {}
        for one in self.driven:
            alike = first.setdefault((one.motion.line, one.motion.v, one.motion.w), [])
            if all(abs(one.seconds - other.seconds) > _ALIKE * other.seconds for other in alike):
                alike.append(one)
        return tuple(itertools.chain.from_iterable(first.values()))[:_MOST_MOTIONS]

    @cached_property
    def lines(self) -> tuple[int, ...]:
        """The lines that decide about any motion, the earliest first; of a car that stood, all that publish."""
        moving = [line for one in self.driven for line in one.motion.lines]
        published = [call.lineno for call in calls_of(self.script, "publish")]
        return tuple(dict.fromkeys(moving or published))[:_MOST_LINES]

    @cached_property
    def twist(self) -> str:
        """The name under which the script has the class of commands."""
        for node in ast.walk(self.script.tree):
            if isinstance(node, ast.ImportFrom) and node.module == "geometry_msgs.msg":
                for one in node.names:
                    if one.name == "Twist":
                        return one.asname or "Twist"
        return "Twist"

    def publish_on(self, line: int) -> tuple[str, str] | None:
        """Return the publisher and the message (a name, or empty) of the publish on a line."""
        for node in ast.walk(self.script.tree):
            if isinstance(node, ast.Call) and node.lineno == line and dotted(node.func).endswith(".publish"):
                return dotted(node.func).removesuffix(".publish"), dotted(node.args[0]) if node.args else ""
        return None
