"""Check ``bodies``: what became of the bodies of a PyBullet world: they fell, rest, drove, were reached or held.

It looks at the replayed world alone (`grader.contracts.replay`), and only up to the first call that does by hand
what motors and gravity are to do, unless the assignment allows that.
"""

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from grader.checks.fit import Misfit, is_number, unmet
from grader.checks.kinds.bodies.mistakes import BASE_SLACK_M, STARTS_AWAY_M, bodies_mistakes
from grader.checks.measure import UNMEASURED, Check, Measure, MeasureKind, Measures, Mistake, Option, one_of
from grader.contracts.assignment import Assignment
from grader.contracts.figure import FigureSketch
from grader.contracts.replay import TRICKS, Replayed, Trick
from grader.contracts.scoring import Run
from grader.contracts.text import Text
from grader.contracts.trajectory import Floats
from grader.geometry import exact
from grader.messages import say
from grader.messages.quantity import number

EARTH_MPS2 = 9.81
_GRAVITY_SLACK_MPS2 = 0.25  # 9.8, 9.81, 10
_AT_REST_MPS = 0.01
_HOLD_S = 0.5  # default of how long a link must stay at its target, or an object be held
_FINGERS = 2
_SLACK_S = 1e-6
MEASURES = {
    "loaded": MeasureKind(form="flag"),
    "gravity": MeasureKind(form="flag"),
    "simulated_s": MeasureKind("s"),
    "start_m": MeasureKind("m"),
    "fell_m": MeasureKind("m"),
    "height_m": MeasureKind("m"),
    "rest_s": MeasureKind("s"),
    "travel_m": MeasureKind("m"),
    "turned_deg": MeasureKind("deg"),
    "wheels_turned": MeasureKind("1"),
    "reach_m": MeasureKind("m"),
    "lifted_m": MeasureKind("m"),
}
_TARGET = ("target_x_m", "target_y_m", "target_z_m")
_BASE = ("base_x_m", "base_y_m", "base_z_m")
_CREEPS_MPS = 0.05  # a slower car has not set out
_LEAST_WORK = 0.5  # of a car's greatest kinetic energy; the rest may be lost between two samples
_NO_WORLD = Text(
    zh="检查 bodies 需要 PyBullet 的世界：写 world: {kind: pybullet, watch: …}",
    en="the check bodies needs a PyBullet world; write world: {kind: pybullet, watch: …}",
)
_NO_TARGET = Text(
    zh="缺少 options.target_x_m、target_y_m 和 target_z_m：补上",
    en="options.target_x_m, target_y_m and target_z_m are missing; add them",
)
_NO_ROBOT = Text(zh="缺少 world.watch.robot：补上", en="world.watch.robot is missing; add it")
_NO_OBJECT = Text(zh="缺少 world.watch.object：补上", en="world.watch.object is missing; add it")
_OF_ROBOT = ("reach_m", "lifted_m")
_OF_OBJECT = ("fell_m", "height_m", "rest_s", "travel_m", "turned_deg", "wheels_turned", "lifted_m")
_NUMBER = Text(zh="要写一个数", en="must be a number")
_TIME = Text(zh="要写大于 0 的时间，单位 s", en="must be a time above 0, in s")


@dataclass(frozen=True, slots=True, eq=False)
class _Counted:
    """The part of a replayed world that counts.

    Attributes:
        count: of its samples. trick: what ends it; None: it is whole.
    """

    replayed: Replayed
    count: int
    trick: Trick | None

    @property
    def seconds(self) -> Floats:
        """Return the time of each sample."""
        return np.asarray(self.replayed.t_ns[: self.count] * 1e-9)

    @property
    def object(self) -> Floats:
        """Return the object's rows."""
        return self.replayed.object[: self.count]

    @property
    def present(self) -> Floats:
        """Return the object's rows of the time when it was there."""
        return _present(self.object)


def _present(rows: Floats) -> Floats:
    present: Floats = rows[np.isfinite(rows[:, 0])]
    return present


def measure(assignment: Assignment, run: Run) -> Measures:
    """Measure a replayed world."""
    replayed = run.replayed
    if replayed is None:
        return {}
    counted = _counted(assignment, replayed)
    return {
        "loaded": Measure(float(_is_loaded(assignment, replayed))),
        **_physics(counted),
        **_object(counted),
        **_wheels(counted),
        **_reach(assignment, counted),
        "lifted_m": _lifted(assignment, counted),
    }


def explain(assignment: Assignment, run: Run, measures: Measures) -> tuple[Mistake, ...]:
    """Return what probably went wrong."""
    trick = None if run.replayed is None else _counted(assignment, run.replayed).trick
    return bodies_mistakes(assignment, run, run.replayed, trick, measures)


def _counted(assignment: Assignment, replayed: Replayed) -> _Counted:
    allowed = str(assignment.options.get("allow", "")).split()
    tricks = (one for one in (*replayed.tricks, *_touched(assignment, replayed)) if one.kind not in allowed)
    trick = min(tricks, key=lambda one: one.call, default=None)
    if trick is None:
        return _Counted(replayed, len(replayed.t_ns), None)
    until = 0 if trick.before_start else int(np.searchsorted(replayed.calls_at, trick.call))
    return _Counted(replayed, until, trick)


def _touched(assignment: Assignment, replayed: Replayed) -> Iterator[Trick]:
    """Yield the moment from which on something else pushes the arm: a body that moves, or came later."""
    if assignment.item_on("reach_m") is None:
        return
    strangers = {body.id for body in replayed.bodies if body.role != "robot"} & {
        body.id for body in replayed.bodies if body.mass_kg > 0.0 or body.joints or body.is_late
    }
    for i, pushes in enumerate(replayed.pushes):
        if any(body in strangers and force > 0.0 for body, _, force in pushes):
            call, t_ns = int(replayed.calls_at[i]), int(replayed.t_ns[i])
            yield Trick(kind="push", name="", call=call, t_ns=t_ns, before_start=i == 0)
            return


def _is_loaded(assignment: Assignment, replayed: Replayed) -> bool:
    watch = assignment.world.watch
    roles = {body.role for body in replayed.bodies}
    wanted = {"object": bool(watch and watch.object), "robot": bool(watch and watch.robot)}
    return all(role in roles for role, is_wanted in wanted.items() if is_wanted)


def _physics(counted: _Counted) -> dict[str, Measure]:
    x, y, z = counted.replayed.gravity
    down = abs(z + EARTH_MPS2) <= _GRAVITY_SLACK_MPS2 and abs(x) < 1e-6 and abs(y) < 1e-6
    seconds = counted.seconds
    return {
        "gravity": Measure(float(down), {"x": f"{x:g}", "y": f"{y:g}", "z": f"{z:g}"}),
        "simulated_s": Measure(float(seconds[-1]) if len(seconds) else 0.0),
    }


def _object(counted: _Counted) -> dict[str, Measure]:
    placed = _present(counted.replayed.object)
    start = {"start_m": Measure(float(placed[0, 2]))} if len(placed) else {}
    rows = counted.present
    if len(rows) < 2:
        return start
    x, y = rows[0, :2] - rows[-1, :2]
    speeds = _lengths(rows[:, 7:10])
    moving = np.flatnonzero(speeds >= _AT_REST_MPS)
    seconds = counted.seconds[np.isfinite(counted.object[:, 0])]
    since_s = float(seconds[moving[-1] + 1]) if len(moving) and moving[-1] + 1 < len(rows) else None
    rest_s = float(seconds[-1]) - (
        since_s if since_s is not None else float(seconds[0 if not len(moving) else -1])
    )
    return {
        **start,
        "fell_m": Measure(float(np.max(rows[:, 2]) - rows[-1, 2])),
        "height_m": Measure(float(rows[-1, 2])),
        "rest_s": Measure(rest_s),
        "travel_m": Measure(exact.hypot(float(x), float(y))),
        "turned_deg": Measure(math.degrees(abs(_heading(rows)))),
    }


def _lengths(rows: Floats) -> Floats:
    """Return the length of each (x, y, z)."""
    x, y, z = rows.T
    return np.asarray(np.sqrt(x * x + y * y + z * z))


def _heading(rows: Floats) -> float:
    """Return by how much the object's heading has changed, in rad."""
    x, y, z, w = (rows[:, column] for column in (3, 4, 5, 6))
    heading = np.unwrap(exact.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z)))
    return float(heading[-1] - heading[0])


def _wheels(counted: _Counted) -> dict[str, Measure]:
    """Measure the wheels' turns; absent if the motors did not do the work that the car's speed takes.

    What they did before the car set out, as on a jack, drove nothing.
    """
    rows, power_w = counted.object, counted.replayed.power_w[: counted.count]
    if len(rows) < 2:
        return {}
    speeds_mps = exact.hypot(*np.nan_to_num(rows[:, 7:9]).T)
    fastest = int(np.argmax(speeds_mps))
    still = np.flatnonzero(speeds_mps[:fastest] < _CREEPS_MPS)
    since = int(still[-1]) if len(still) else 0
    works_w = np.maximum(np.nan_to_num(power_w), 0.0)
    work_j = exact.total((works_w[1:] * np.diff(counted.seconds))[since:])
    mass_kg = next((body.total_kg for body in counted.replayed.bodies if body.role == "object"), 0.0)
    if work_j < _LEAST_WORK * mass_kg * float(speeds_mps[fastest]) ** 2 / 2.0:
        return {"wheels_turned": UNMEASURED}
    return {"wheels_turned": Measure(_turned(counted))}


def _turned(counted: _Counted) -> float:
    """Return how many times the joint that turned most went round: a car that is driven turns its wheels."""
    joints = counted.replayed.object_joints[: counted.count]
    if not joints.size or not np.isfinite(joints).any():
        return 0.0
    return float(np.nanmax(np.nanmax(joints, axis=0) - np.nanmin(joints, axis=0))) / math.tau


def _reach(assignment: Assignment, counted: _Counted) -> dict[str, Measure]:
    """Measure the least distance to the target within which motors alone kept the link for the wanted time.

    Absent if the run was shorter than that time, the link was at the target before the first step or came no
    nearer, or the arm does not stand fixed at its place. Less counts if the link made less than half of the way.
    """
    target = [assignment.options.get(name) for name in _TARGET]
    link = counted.replayed.link[: counted.count]
    if None in target or not len(link) or not np.isfinite(link).all():
        return {}
    apart = _lengths(link[:, :3] - np.array([float(coordinate or 0.0) for coordinate in target]))
    start_m, apart = float(apart[0]), np.where(_propped(counted), np.inf, apart)
    seconds, hold_s = counted.seconds, _hold_s(assignment)
    ends = np.searchsorted(seconds, seconds + hold_s - _SLACK_S)
    kept = [float(np.max(apart[i : end + 1])) for i, end in enumerate(ends) if end < len(seconds)]
    if not kept or start_m < STARTS_AWAY_M or not _stands(assignment, counted.replayed):
        return {}
    share = min(2.0 * (1.0 - min(kept) / start_m), 1.0)
    if share <= 0.0:
        return {}
    nearest = int(np.argmin(apart))
    details = {
        "hold": number(hold_s, "s"),
        "nearest": number(float(apart[nearest]), "m"),
        "time": number(float(seconds[nearest]), "s"),
        "why": say("bodies.part_of_way"),
    }
    return {"reach_m": Measure(min(kept), details, share)}


def _stands(assignment: Assignment, replayed: Replayed) -> bool:
    """Return whether the arm's base is fixed, and where the assignment has it (the origin)."""
    place = np.array([float(assignment.options.get(name) or 0.0) for name in _BASE])
    is_loose = any(body.role == "robot" and body.mass_kg > 0.0 for body in replayed.bodies)
    return not is_loose and exact.length((replayed.base[0] - place).tolist()) <= BASE_SLACK_M


def _lifted(assignment: Assignment, counted: _Counted) -> Measure:
    """Measure how high two fingers alone held the object for the wanted time, above where they first held it.

    It must have lain on something else before: what is put between the fingers was not picked up.
    """
    robots = {body.id for body in counted.replayed.bodies if body.role == "robot"}
    pushes = counted.replayed.pushes[: counted.count]
    held = np.array([_holds(push, robots) for push in pushes], dtype=bool)
    propped = _propped(counted)
    held &= np.logical_or.accumulate(propped)
    if not held.any():
        return UNMEASURED
    heights = counted.object[:, 2]
    raised = np.where(held & ~propped, heights - heights[int(np.argmax(held))], -math.inf)
    seconds, hold_s, best = counted.seconds, _hold_s(assignment), 0.0
    for i in np.flatnonzero(held & ~propped):
        end = int(np.searchsorted(seconds, seconds[i] + hold_s - _SLACK_S))
        if end < len(seconds):
            best = max(best, float(np.min(raised[i : end + 1])))
    return Measure(best, {"hold": number(hold_s, "s")})


def _propped(counted: _Counted) -> NDArray[np.bool_]:
    """Return when something else than the robot pushed what is looked at."""
    robots = {body.id for body in counted.replayed.bodies if body.role == "robot"}
    pushed = np.zeros(counted.count, dtype=bool)
    for i, pushes in enumerate(counted.replayed.pushes[: counted.count]):
        pushed[i] = any(force > 0.0 and body not in robots for body, _, force in pushes)
    return pushed


def _holds(pushes: tuple[tuple[int, int, float], ...], robots: set[int]) -> bool:
    return len({link for body, link, force in pushes if body in robots and force > 0.0}) >= _FINGERS


def _hold_s(assignment: Assignment) -> float:
    return float(assignment.options.get("hold_s", _HOLD_S))


def sketch(assignment: Assignment, run: Run) -> FigureSketch:
    """Return the view of the pictures, which show more than a path from above."""
    return FigureSketch(view="frames", ideal_closed=False)


def _consult(assignment: Assignment) -> Iterable[Misfit]:
    if assignment.world.kind != "pybullet":
        return (("world", _NO_WORLD),)
    watch, has_target = assignment.world.watch, assignment.options.keys() >= set(_TARGET)
    return unmet(
        assignment,
        (("reach_m",), has_target, _NO_TARGET),
        (_OF_ROBOT, bool(watch and watch.robot), _NO_ROBOT),
        (_OF_OBJECT, bool(watch and watch.object), _NO_OBJECT),
    )


def _problem_with_number(value: Option) -> Text | None:
    return None if is_number(value) else _NUMBER


def _problem_with_time(value: Option) -> Text | None:
    return None if is_number(value) and value > 0.0 else _TIME


def _problem_with_tricks(value: Option) -> Text | None:
    is_known = isinstance(value, str) and set(value.split()) <= set(TRICKS)
    return None if is_known else one_of(TRICKS)


CHECK = Check(
    kind="bodies",
    measures=MEASURES,
    optional={
        **dict.fromkeys((*_TARGET, *_BASE), _problem_with_number),
        "hold_s": _problem_with_time,
        "allow": _problem_with_tricks,
    },
    consult=_consult,
    measure=measure,
    explain=explain,
    sketch=sketch,
)
