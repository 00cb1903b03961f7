"""How sensitive a rubric is: drive the solution's motion again with growing errors, and see what each costs.

The recorded commands are driven without the script, so hundreds of errors take a few seconds.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import groupby

from grader.checks import evaluate
from grader.contracts.assignment import Assignment, World
from grader.contracts.rubric import ItemStatus, RubricItem, Unit
from grader.contracts.scoring import Run
from grader.contracts.text import Text
from grader.contracts.trajectory import COMMAND_LIFE_NS, Command, Trajectory
from grader.messages.quantity import number
from grader.sim.car import UPDATE_NS
from grader.sim.turtle import obeyed_at_once

Commands = Sequence[Command]
Spoil = Callable[[Commands, float], list[Command]]
STEP = 0.01
MOST = 1.0
# Fine where credit begins to fall, coarser where only the error that costs an item's last point is still sought.
_STEPS = (*range(1, 25), *range(25, 50, 3), *range(50, 100, 7))
_COARSE = 10  # every tenth of these steps is scored first
_ROUNDING = 1e-6  # measures of equal motions differ by less
_MOVING = 1e-6  # slower is rest: velocities are commanded, so anything else is rounding


@dataclass(frozen=True, slots=True)
class Perturbation:
    """One way to make a motion worse.

    Attributes:
        name: in the printed table. spoil: returns the commands with an error of the given size.
        applies: whether a motion of these kinds of stretches can be spoilt this way.
        must_cost_from: an error of this size must cost points in at least one direction; None: none must.
        full: size of the error 1.0, in `unit`.
    """

    name: Text
    spoil: Spoil
    applies: Callable[[list[str]], bool]
    must_cost_from: float | None = 0.25
    full: float = 100.0
    unit: Unit = "%"


@dataclass(frozen=True, slots=True, kw_only=True)
class Sensitivity:
    """What one perturbation costs one item; errors as shares of the perturbation's full size, signed.

    Attributes:
        starts: the smallest error that costs something.
        zero: the smallest error that leaves no points; None if every error leaves some.
    """

    perturbation: Perturbation
    item: str
    starts: float
    zero: float | None


def sensitivities(assignment: Assignment, run: Run) -> list[Sensitivity]:
    """Return what each perturbation of the solution's `run` costs each item, in both directions."""
    results: list[Sensitivity] = []
    for perturbation in _applicable(run.trajectory):
        for sign in (1.0, -1.0):
            results += _along(assignment, run, perturbation, sign)
    return results


def lax(assignment: Assignment, run: Run) -> list[Text]:
    """Return a complaint about each gross error in the solution's motion that costs no points.

    A ``limit:`` of an item, by which the author says what the rubric does not see, allows errors that change that
    item's measure. It also allows errors that change no measure at all, because no band could be narrowed.
    """
    problems = []
    limits = {item.id for item in assignment.items if item.limit}
    right = _items(assignment, run, run.trajectory.commands)
    for perturbation in _applicable(run.trajectory):
        error = perturbation.must_cost_from
        if error is None:
            continue
        both = [_scored(assignment, run, perturbation, sign * error) for sign in (1.0, -1.0)]
        moved = set().union(*(_moved(right, items) for items in both))
        if all(map(_full, both)) and not (limits & moved if moved else limits):
            problems.append(_complaint(perturbation, error, [item.id for item in right if item.id in moved]))
    return problems


def _moved(right: Sequence[RubricItem], spoilt: Sequence[RubricItem]) -> set[str]:
    """Return the ids of the items whose measures differ between the right motion and a spoilt one."""
    pairs = zip(right, spoilt, strict=False)
    return {one.id for one, other in pairs if not _alike(one.measured, other.measured)}


def _alike(one: float | None, other: float | None) -> bool:
    """Whether two values differ by no more than rounding."""
    if one is None or other is None:
        return one is other
    return math.isclose(one, other, rel_tol=_ROUNDING, abs_tol=_ROUNDING)


def _complaint(perturbation: Perturbation, error: float, moved: Sequence[str]) -> Text:
    """Return the complaint about an error that costs nothing; `moved` are the items whose measures it changes."""
    size, name = number(error * perturbation.full, perturbation.unit), perturbation.name
    zh, en = f"太宽松：{name.zh}差 {size} 也不扣分；", f"lax: {name.en} off by {size} costs nothing; "
    if not moved:
        zh += "没有任何测量值受它影响：增加评分项，或在任一评分项上用 limit 写明为什么不管它"
        en += "no measure sees it: add an item that does, or say with limit, at any item, why it may be so"
        return Text(zh=zh, en=en)
    zh += f"把 {'、'.join(moved)} 中某一项的范围收窄，或在其中一项上用 limit 写明原因"
    en += f"narrow the band of one of {', '.join(moved)}, or say why with limit there"
    return Text(zh=zh, en=en)


def replayable(assignment: Assignment, run: Run) -> bool:
    """Whether the recorded commands earn full marks if an ideal turtle drives them, the basis of comparison."""
    if not run.trajectory.commands or assignment.world.profile != "nominal":
        return False
    return _full(_items(assignment, run, run.trajectory.commands))


def _applicable(trajectory: Trajectory) -> list[Perturbation]:
    kinds = [kind for kind, _ in _stretches(trajectory.commands)]
    return [perturbation for perturbation in PERTURBATIONS if perturbation.applies(kinds)]


def _along(
    assignment: Assignment, run: Run, perturbation: Perturbation, sign: float
) -> Iterator[Sensitivity]:
    starts: dict[str, float] = {}
    zero: dict[str, float] = {}
    steps = [each for each in _STEPS if each * STEP < MOST]
    lost = _Losses(assignment, run, perturbation, sign)
    for at in _informative_steps(steps, lost):
        error = sign * at * STEP
        for item_id, nothing_left in lost.at(at).items():
            starts.setdefault(item_id, error)
            if nothing_left:
                zero.setdefault(item_id, error)
    for item_id, start in starts.items():
        yield Sensitivity(perturbation=perturbation, item=item_id, starts=start, zero=zero.get(item_id))


class _Losses:
    """What errors of growing size cost. Each size is scored once."""

    def __init__(self, assignment: Assignment, run: Run, perturbation: Perturbation, sign: float) -> None:
        self._of = (assignment, run, perturbation)
        self._sign = sign
        self._known: dict[int, dict[str, bool]] = {}

    def at(self, step: int) -> dict[str, bool]:
        """Return the items that lose points at an error of `step` × `STEP`: by id, whether all points are lost.

        Items that were not checked are left out: they lose their points through the item that they need.
        """
        if step not in self._known:
            items = _scored(*self._of, self._sign * step * STEP)
            checked = [item for item in items if item.status is not ItemStatus.NOT_CHECKED]
            self._known[step] = {item.id: item.earned <= 0.0 for item in checked if item.earned < item.points}
        return self._known[step]


def _informative_steps(steps: Sequence[int], lost: _Losses) -> list[int]:
    """Return the steps that show where losses change: every `_COARSE`-th, and the changes between those."""
    informative = [steps[0]]
    for at in range(0, len(steps) - 1, _COARSE):
        informative += _changes(steps[at : at + _COARSE + 1], lost)
    return informative


def _changes(steps: Sequence[int], lost: _Losses) -> list[int]:
    """Return the steps at which losses change, found by bisection, and the last step."""
    if len(steps) <= 2 or lost.at(steps[0]) == lost.at(steps[-1]):
        return [steps[-1]]
    middle = len(steps) // 2
    return _changes(steps[: middle + 1], lost) + _changes(steps[middle:], lost)


def _scored(
    assignment: Assignment, run: Run, perturbation: Perturbation, error: float
) -> tuple[RubricItem, ...]:
    commands = perturbation.spoil(run.trajectory.commands, error)
    return _items(assignment, run, commands)


def _items(assignment: Assignment, run: Run, commands: Commands) -> tuple[RubricItem, ...]:
    motion = replayed(assignment.in_case(run.case).world, run.trajectory, commands)
    return evaluate(assignment, [replace(run, trajectory=motion)]).items


def _full(items: tuple[RubricItem, ...]) -> bool:
    return all(item.earned >= item.points for item in items)


def _stretches(commands: Commands) -> list[tuple[str, list[Command]]]:
    """Group successive commands of one kind of motion; an arc of another radius begins a new group."""

    def motion(command: Command) -> tuple[str, float]:
        kind = motion_of(command)
        return kind, round(command.w_radps / command.v_mps, 3) if kind == "arc" else 0.0

    return [(kind, list(group)) for (kind, _), group in groupby(commands, key=motion)]


def _scaled(kind: str, *, only_first: bool = False, turning: bool = True) -> Spoil:
    """Return a `Spoil` that makes stretches of one kind faster. They last as long as before, so they get longer.

    Args:
        kind: of the stretches, as in `motion_of`.
        only_first: spoil the first of them only.
        turning: scale the turn rate as well; without it an arc turns as far as before, on another radius.
    """

    def spoil(commands: Commands, error: float) -> list[Command]:
        spoilt: list[Command] = []
        left = True
        for found, stretch in _stretches(commands):
            factor = 1.0 + error if found == kind and left else 1.0
            left = left and not (only_first and found == kind)
            spoilt += [
                Command(
                    t_ns=command.t_ns,
                    v_mps=command.v_mps * factor,
                    w_radps=command.w_radps * (factor if turning else 1.0),
                )
                for command in stretch
            ]
        return spoilt

    return spoil


def _veering(commands: Commands, error: float) -> list[Command]:
    """Make every run veer, so that it ends turned by `error` × 90 degrees."""
    spoilt: list[Command] = []
    stretches = _stretches(commands)
    for i, (kind, stretch) in enumerate(stretches):
        end_ns = stretches[i + 1][1][0].t_ns if i + 1 < len(stretches) else stretch[-1].t_ns + 1_000_000_000
        turn_rad = error * 1.5707963 if kind == "run" else 0.0
        rate = turn_rad / max((end_ns - stretch[0].t_ns) * 1e-9, 1e-3)
        spoilt += [
            Command(t_ns=command.t_ns, v_mps=command.v_mps, w_radps=command.w_radps + rate)
            for command in stretch
        ]
    return spoilt


def _longer_rests(commands: Commands, error: float) -> list[Command]:
    """Make every rest longer by the share `error`, except the last one."""
    spoilt: list[Command] = []
    shift_ns = 0
    stretches = _stretches(commands)
    for i, (kind, stretch) in enumerate(stretches):
        begin_ns = stretch[0].t_ns
        stretched = error if kind == "rest" and i + 1 < len(stretches) else 0.0
        spoilt += [
            Command(
                t_ns=command.t_ns + shift_ns + round((command.t_ns - begin_ns) * stretched),
                v_mps=command.v_mps,
                w_radps=command.w_radps,
            )
            for command in stretch
        ]
        if stretched:
            shift_ns += round((stretches[i + 1][1][0].t_ns - begin_ns) * stretched)
    return spoilt


PERTURBATIONS = (
    Perturbation(
        Text(zh="每段直行的长度", en="length of every straight"),
        _scaled("run"),
        lambda kinds: "run" in kinds,
        must_cost_from=None,
    ),
    Perturbation(
        Text(zh="第一段直行的长度", en="length of the first straight"),
        _scaled("run", only_first=True),
        lambda kinds: kinds.count("run") > 1,
    ),
    Perturbation(
        Text(zh="每次转弯的角度", en="angle of every turn"), _scaled("turn"), lambda kinds: "turn" in kinds
    ),
    Perturbation(
        Text(zh="第一次转弯的角度", en="angle of the first turn"),
        _scaled("turn", only_first=True),
        lambda kinds: kinds.count("turn") > 1,
    ),
    Perturbation(
        Text(zh="每段直行末尾的朝向", en="heading at the end of every straight"),
        _veering,
        lambda kinds: "run" in kinds,
        must_cost_from=1.0 / 3.0,
        full=90.0,
        unit="deg",
    ),
    Perturbation(
        Text(zh="每段弧线的半径", en="radius of every arc"),
        _scaled("arc", turning=False),
        lambda kinds: "arc" in kinds,
        must_cost_from=None,
    ),
    Perturbation(
        Text(zh="第一段弧线的半径", en="radius of the first arc"),
        _scaled("arc", only_first=True, turning=False),
        lambda kinds: kinds.count("arc") > 1,
    ),
    Perturbation(
        Text(zh="每段弧线的角度", en="angle of every arc"), _scaled("arc"), lambda kinds: "arc" in kinds
    ),
    Perturbation(
        Text(zh="每次停顿的时间", en="time of every rest"),
        _longer_rests,
        lambda kinds: "rest" in kinds[:-1],
        must_cost_from=None,
    ),
)


# ------------------------------------------------------------------------------------------------- replay


def replayed(world: World, recorded: Trajectory, commands: Commands) -> Trajectory:
    """Return the motion of a turtle that obeys other commands than the recorded ones, and each at once.

    The episode lasts at least as long as the recorded one.
    """
    if not commands:
        return recorded
    end_ns = max(recorded.end_ns, commands[-1].t_ns + COMMAND_LIFE_NS + 2 * UPDATE_NS)
    return replace(obeyed_at_once(world, commands, end_ns), commands=tuple(commands))


def motion_of(command: Command) -> str:
    """Return what a command asks for: ``run``, ``turn``, ``arc`` or ``rest``."""
    drives, turns = abs(command.v_mps) > _MOVING, abs(command.w_radps) > _MOVING
    if drives:
        return "arc" if turns else "run"
    return "turn" if turns else "rest"
