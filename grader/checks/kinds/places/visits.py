"""Where the car was when: which goals it visited, how near it came to the others, what it should have avoided."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from grader.contracts.assignment import Region, WantedGoal, WantedPlaces
from grader.contracts.scoring import Run
from grader.contracts.trajectory import Floats, Trajectory
from grader.geometry import exact

# Points of the way are no further apart, so that a small goal is not passed between two samples.
NEAR_M = 0.02
MOST_PARTS = 8  # into which the way between two samples is divided for that
SAME_M = 0.01  # jumps that are shorter, all together, do not count as being put elsewhere
# A missed goal counts this much at most, the less, the larger it must be to be reached; nothing at twice its size.
NEARLY_COUNTS = 0.75
NEARLY_STEPS = 25  # from that to nothing
# Of the straight way from goal to goal: who wanders about meets any goal some day. Twice this lets a search in,
# half of it a controller that drives in arcs.
MOST_TIMES = 3.0
SPARE_M = 1.0  # for a short way
FOR_EVER_S = math.inf
Stay = tuple[float, float]
"""When the car came into a region, and when it left it."""


@dataclass(frozen=True, slots=True, eq=False)
class Way:
    """The motion of a run up to the first time that the car was put elsewhere instead of driving there.

    Attributes:
        t_s, x_m, y_m: points of the way, close together.
        end_rad: heading at its end.
        rests: the car stands still at its end, and stays where it is.
        put: the car was put elsewhere then.
    """

    t_s: Floats
    x_m: Floats
    y_m: Floats
    end_rad: float
    rests: bool
    put: bool


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Visit:
    """What became of one goal.

    Attributes:
        goal: the goal. number: which it is, from 1.
        nearest_m: how near the car came to its middle. outside_m: how far outside of it that was at best.
        first_m: how far its middle was from the start.
        entered_s: when the car was in it first; None: never.
        stayed_s: the longest time in it without leaving.
        done_s: when the visit that counts was complete; None: there is none.
    """

    goal: WantedGoal
    number: int
    nearest_m: float
    outside_m: float
    first_m: float
    entered_s: float | None
    stayed_s: float
    done_s: float | None


def way_of(run: Run, *, moving_at_end: bool) -> Way:
    """Return the way that counts; a finite trajectory is taken for granted."""
    trajectory = run.trajectory
    count = _driven(trajectory)
    put = count < len(trajectory)
    x, y = trajectory.x_m[:count], trajectory.y_m[:count]
    t = trajectory.t_ns[:count] * 1e-9
    longest_m = float(np.max(exact.hypot(np.diff(x), np.diff(y)))) if count > 1 else 0.0
    parts = min(MOST_PARTS, max(1, math.ceil(longest_m / NEAR_M)))
    at = np.arange((count - 1) * parts + 1) / parts
    index = np.arange(count, dtype=np.float64)
    return Way(
        t_s=exact.interpolated(at, index, t),
        x_m=exact.interpolated(at, index, x),
        y_m=exact.interpolated(at, index, y),
        end_rad=float(trajectory.heading_rad[count - 1]),
        rests=not put and not moving_at_end,
        put=put,
    )


def _driven(trajectory: Trajectory) -> int:
    """Return how many samples there are before the car was put elsewhere."""
    x, y, put_m = trajectory.x_m, trajectory.y_m, 0.0
    for i in trajectory.jumps:
        put_m += exact.hypot(float(x[i] - x[i - 1]), float(y[i] - y[i - 1]))
        if put_m > SAME_M:
            return i
    return len(trajectory)


def within_budget(wanted: WantedPlaces, way: Way) -> Way:
    """Return the part of a way in which goals count: up to `MOST_TIMES` the straight way from goal to goal."""
    x, y, straight_m = float(way.x_m[0]), float(way.y_m[0]), 0.0
    for goal in wanted.visit:
        straight_m += exact.hypot(goal.region.x_m - x, goal.region.y_m - y)
        x, y = goal.region.x_m, goal.region.y_m
    along_m = np.concatenate(([0.0], np.cumsum(exact.hypot(np.diff(way.x_m), np.diff(way.y_m)))))
    count = int(np.searchsorted(along_m, MOST_TIMES * straight_m + SPARE_M, side="right"))
    if count == len(way.t_s):
        return way
    return replace(way, t_s=way.t_s[:count], x_m=way.x_m[:count], y_m=way.y_m[:count], rests=False)


def outside_of(region: Region, way: Way) -> Floats:
    """Return how far each point of the way is outside of a region."""
    dx, dy = np.abs(way.x_m - region.x_m), np.abs(way.y_m - region.y_m)
    if region.kind == "circle":
        return np.asarray(np.maximum(exact.hypot(dx, dy) - region.radius_m, 0.0))
    return np.asarray(
        exact.hypot(np.maximum(dx - region.width_m / 2.0, 0.0), np.maximum(dy - region.height_m / 2.0, 0.0))
    )


def visits(wanted: WantedPlaces, way: Way) -> list[Visit]:
    """Return what became of each goal, in the order of the assignment."""
    outside = [outside_of(goal.region, way) for goal in wanted.visit]
    stays = [_stays(span, way) for span in outside]
    done = _done(wanted, stays)
    found = []
    for i, goal in enumerate(wanted.visit):
        middle_m = exact.hypot(way.x_m - goal.region.x_m, way.y_m - goal.region.y_m)
        lasted = [left - came for came, left in stays[i]]
        found.append(
            Visit(
                goal=goal,
                number=i + 1,
                nearest_m=float(np.min(middle_m)),
                outside_m=float(np.min(outside[i])),
                first_m=float(middle_m[0]),
                entered_s=stays[i][0][0] if stays[i] else None,
                stayed_s=max(lasted, default=0.0),
                done_s=done[i],
            )
        )
    return found


def nearly_reached(wanted: WantedPlaces, way: Way, seen: Sequence[Visit]) -> list[float]:
    """Return how much of each missed goal counts: the less, the larger all goals must be for it to be reached."""
    shares = [0.0] * len(seen)
    if not any(visit.done_s is None and visit.outside_m <= _size_m(visit.goal.region) for visit in seen):
        return shares
    for step in range(1, NEARLY_STEPS):
        more = step / NEARLY_STEPS
        larger = replace(wanted, visit=tuple(_enlarged(goal, 1.0 + more) for goal in wanted.visit))
        stays = [_stays(outside_of(goal.region, way), way) for goal in larger.visit]
        for i, done_s in enumerate(_done(larger, stays)):
            if done_s is not None and seen[i].done_s is None and not shares[i]:
                shares[i] = NEARLY_COUNTS * (1.0 - more)
    return shares


def _size_m(region: Region) -> float:
    """Return how far outside of a region one of twice its size may reach."""
    return max(region.radius_m, exact.hypot(region.width_m, region.height_m) / 2.0)


def _enlarged(goal: WantedGoal, times: float) -> WantedGoal:
    region = goal.region
    larger = replace(
        region,
        radius_m=times * region.radius_m,
        width_m=times * region.width_m,
        height_m=times * region.height_m,
    )
    return replace(goal, region=larger)


def _stays(outside: Floats, way: Way) -> list[Stay]:
    within = np.concatenate(([False], outside <= 0.0, [False]))
    edges = np.flatnonzero(np.diff(within.astype(np.int8)))
    found = []
    for first, behind in zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True):
        stays = behind == len(way.t_s) and way.rests
        found.append((float(way.t_s[first]), FOR_EVER_S if stays else float(way.t_s[behind - 1])))
    return found


def _done(wanted: WantedPlaces, stays: Sequence[Sequence[Stay]]) -> list[float | None]:
    """Return when each goal's visit was complete.

    In a given order, the longest chain of goals visited one after the other counts; of equally long chains the one
    that was complete first.
    """
    if wanted.any_order:
        return [_complete(goal, stays[i], 0.0) for i, goal in enumerate(wanted.visit)]
    chains: list[tuple[float, tuple[tuple[int, float], ...]]] = [(0.0, ())]
    for i, goal in enumerate(wanted.visit):
        for length in range(len(chains) - 1, -1, -1):
            at_s, chain = chains[length]
            done_s = _complete(goal, stays[i], at_s)
            if done_s is None:
                continue
            longer = (done_s, (*chain, (i, done_s)))
            if length + 1 == len(chains):
                chains.append(longer)
            elif done_s < chains[length + 1][0]:
                chains[length + 1] = longer
    known = dict(chains[-1][1])
    return [known.get(i) for i in range(len(wanted.visit))]


def _complete(goal: WantedGoal, stays: Sequence[Stay], after_s: float) -> float | None:
    """Return when the first visit after a time was complete, or None."""
    for came_s, left_s in stays:
        begins_s = max(came_s, after_s)
        in_time = goal.by_s is None or came_s <= goal.by_s
        if in_time and begins_s <= left_s and left_s - begins_s >= goal.hold_s:
            return begins_s + goal.hold_s
    return None


def entered(regions: Sequence[Region], way: Way) -> list[int]:
    """Return the numbers of the regions that the car went into, from 1."""
    return [i for i, region in enumerate(regions, 1) if float(np.min(outside_of(region, way))) <= 0.0]


def jolt_mps(trajectory: Trajectory, within_s: float) -> float:
    """Return the largest change of the measured speed within a time."""
    t_s = trajectory.t_ns * 1e-9
    before = np.searchsorted(t_s, t_s - within_s, side="right") - 1
    # a sample far back was taken at rest: the car had the speed of the sample behind it
    change = np.abs(trajectory.v_mps - trajectory.v_mps[np.maximum(before, 0)])
    return float(np.max(change))
