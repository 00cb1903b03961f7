"""Check ``places``: go to places, in order or in any order, stay there, and keep away from others."""

import math
from collections.abc import Iterable, Iterator

import numpy as np

from grader.checks.drive import Drive, drive_of
from grader.checks.fit import Misfit, unmet
from grader.checks.kinds.places.mistakes import place_mistakes
from grader.checks.kinds.places.visits import (
    Visit,
    Way,
    entered,
    jolt_mps,
    nearly_reached,
    outside_of,
    visits,
    way_of,
    within_budget,
)
from grader.checks.measure import UNMEASURED, Check, Measure, MeasureKind, Measures, Mistake
from grader.checks.mistakes import driving_mistakes
from grader.checks.surroundings import clearance
from grader.contracts.assignment import WINDOW_M, Assignment, Region, WantedPlaces, outside_m
from grader.contracts.figure import FigureSketch, Point, SketchLabel, SketchRegion
from grader.contracts.scoring import Run
from grader.contracts.text import EMPTY, Text
from grader.geometry import exact
from grader.messages import say
from grader.messages.quantity import number

JOLT_S = 0.1  # within which a change of speed is one jolt
_CIRCLE_POINTS = 36
MEASURES = {
    "distance_m": MeasureKind("m"),
    "reached": MeasureKind(form="count"),
    "reached_pct": MeasureKind("%"),
    "missed_m": MeasureKind("m"),
    "time_s": MeasureKind("s"),
    "end_off_m": MeasureKind("m"),
    "heading_error_deg": MeasureKind("deg"),
    "settled": MeasureKind(form="flag"),
    "contacts": MeasureKind(form="count"),
    "entered": MeasureKind(form="count"),
    "clearance_m": MeasureKind("m"),
    "detour_pct": MeasureKind("%"),
    "speed_mps": MeasureKind("m/s"),
    "turn_radps": MeasureKind("rad/s"),
    "jolt_mps": MeasureKind("m/s"),
}
_NO_PLACES = Text(
    zh="缺少：写上 places 和它的 visit，例如 visit: [{at: [8.0, 8.0], within: 0.2}]",
    en="missing; give places with visit, such as visit: [{at: [8.0, 8.0], within: 0.2}]",
)
_NO_HEADING = Text(
    zh="没有 places.end_heading_deg：补上，或删掉这一项",
    en="there is no places.end_heading_deg; add it or remove this item",
)
_NOTHING_TO_AVOID = Text(
    zh="没有 places.avoid：补上，或删掉这一项", en="there is no places.avoid; add it or remove this item"
)
_NO_WALLS = Text(
    zh="world.walls 是 false，撞不到墙：删掉这一项",
    en="world.walls is false: there is no wall to touch; remove this item",
)
_OUTSIDE = Text(
    zh=f"在场地外面（0 到 {WINDOW_M:.2f} m）：改位置，或写 world: {{walls: false}}",
    en=f"lies outside the field (0 to {WINDOW_M:.2f} m); move it, or write world: {{walls: false}}",
)
_OUTSIDE_ROOM = Text(
    zh="在房间外面（world.room.bounds）：改位置", en="lies outside the room (world.room.bounds); move it"
)
_TOO_LONG = Text(
    zh="要短于 horizon_s：缩短它，或者加长 horizon_s",
    en="must be less than horizon_s; shorten it or lengthen that",
)
_AT_START = Text(
    zh="小车一开始就在里面：移走目标，或改 world.start",
    en="the car is in it from the beginning; move it, or change world.start",
)


def measure(assignment: Assignment, run: Run) -> Measures:
    """Measure which places were visited, and how."""
    drive, wanted = drive_of(run), assignment.places
    if drive is None or wanted is None:
        return {}
    way = way_of(run, moving_at_end=drive.moving_at_end)
    counted = _counted(assignment, wanted, way)
    seen = visits(wanted, counted)
    return {
        **_of_the_goals(wanted, way, counted, seen),
        **_of_the_way(assignment, run, way),
        **_of_the_motion(run, drive),
        "detour_pct": _detour(way, seen),
    }


def explain(assignment: Assignment, run: Run, measures: Measures) -> tuple[Mistake, ...]:
    """Return what probably went wrong."""
    drive, wanted = drive_of(run), assignment.places
    if drive is None or wanted is None:
        return driving_mistakes(run, ())
    way = way_of(run, moving_at_end=drive.moving_at_end)
    seen = visits(wanted, _counted(assignment, wanted, way))
    return driving_mistakes(run, place_mistakes(assignment, run, drive, way, seen))


def _counted(assignment: Assignment, wanted: WantedPlaces, way: Way) -> Way:
    """Return the part of a way in which goals count. In a room with walls the straight way says nothing."""
    room = assignment.world.room
    is_open = room is None or all(solid.kind == "edge" for solid in room.solids)
    return within_budget(wanted, way) if is_open else way


def _of_the_goals(wanted: WantedPlaces, way: Way, counted: Way, seen: list[Visit]) -> dict[str, Measure]:
    done = [visit.done_s for visit in seen if visit.done_s is not None]
    missed = [visit for visit in seen if visit.done_s is None]
    last = wanted.visit[-1].region
    off_m = exact.hypot(float(way.x_m[-1]) - last.x_m, float(way.y_m[-1]) - last.y_m)
    nearly = [share for share in nearly_reached(wanted, counted, seen) if share] if missed else []
    worth = math.fsum(nearly)
    more = say("places.nearly", count=len(nearly), worth=number(worth, "1")) if nearly else EMPTY
    found = {
        "reached": Measure(float(len(done)), {"goals": len(seen)}),
        "reached_pct": Measure(
            100.0 * (len(done) + worth) / len(seen),
            {"goals": len(seen), "reached": len(done), "nearly": more},
        ),
        "missed_m": Measure(max((visit.outside_m for visit in missed), default=0.0)),
        "end_off_m": Measure(off_m),
    }
    if not missed:
        found["time_s"] = Measure(max(done))
    if wanted.end_heading_deg is not None:
        looks_deg = math.remainder(math.degrees(way.end_rad), 360.0)
        error_deg = abs(math.remainder(looks_deg - wanted.end_heading_deg, 360.0))
        details = {"looks": number(looks_deg, "deg"), "wanted": number(wanted.end_heading_deg, "deg")}
        found["heading_error_deg"] = Measure(error_deg, details)
    return found


def _of_the_way(assignment: Assignment, run: Run, way: Way) -> dict[str, Measure]:
    avoid = () if assignment.places is None else assignment.places.avoid
    apart = [float(np.min(outside_of(region, way))) for region in avoid]
    if assignment.world.window:
        edges = (way.x_m, way.y_m, WINDOW_M - way.x_m, WINDOW_M - way.y_m)
        apart.append(max(min(float(np.min(edge)) for edge in edges), 0.0))
    if assignment.world.room is not None:
        apart.append(clearance(assignment.world.room, run.trajectory).value)
    return {
        "contacts": Measure(float(len(run.trajectory.contacts))),
        "entered": Measure(float(len(entered(avoid, way)))),
        "clearance_m": Measure(min(apart)) if apart else UNMEASURED,
    }


def _of_the_motion(run: Run, drive: Drive) -> dict[str, Measure]:
    trajectory = run.trajectory
    return {
        "distance_m": Measure(float(np.max(drive.path.along_m))),
        "settled": Measure(0.0 if drive.moving_at_end else 1.0),
        "speed_mps": Measure(float(np.max(np.abs(trajectory.v_mps)))),
        "turn_radps": Measure(float(np.max(np.abs(trajectory.w_radps)))),
        "jolt_mps": Measure(jolt_mps(trajectory, JOLT_S)),
    }


def _detour(way: Way, seen: list[Visit]) -> Measure:
    """Return how much longer the way up to the last goal was than straight lines from goal to goal."""
    if any(visit.done_s is None for visit in seen):
        return UNMEASURED
    in_time = sorted(seen, key=lambda visit: visit.done_s or 0.0)
    x, y, straight_m = float(way.x_m[0]), float(way.y_m[0]), 0.0
    for visit in in_time:
        region = visit.goal.region
        straight_m += outside_m(region, x, y)
        x, y = region.x_m, region.y_m
    until = int(np.searchsorted(way.t_s, in_time[-1].done_s or 0.0, side="right"))
    driven_m = exact.total(exact.hypot(np.diff(way.x_m[:until]), np.diff(way.y_m[:until])))
    if straight_m <= 0.0:
        return UNMEASURED
    details = {"driven": number(driven_m, "m"), "straight": number(straight_m, "m")}
    return Measure(max(100.0 * (driven_m / straight_m - 1.0), 0.0), details)


def sketch(assignment: Assignment, run: Run) -> FigureSketch:
    """Return the places, which of them were visited or entered, and how near the car came to the others."""
    drive, wanted = drive_of(run), assignment.places
    if wanted is None:
        return FigureSketch()
    if drive is None:
        return FigureSketch()
    way = way_of(run, moving_at_end=drive.moving_at_end)
    seen, hit = visits(wanted, _counted(assignment, wanted, way)), entered(wanted.avoid, way)
    goals = tuple(
        _drawn(visit.goal.region, _plain(str(visit.number)), ok=visit.done_s is not None) for visit in seen
    )
    avoid = tuple(
        _drawn(region, _plain("×"), ok=i not in hit, avoid=True) for i, region in enumerate(wanted.avoid, 1)
    )
    return FigureSketch(
        view="path",
        regions=goals + avoid,
        labels=tuple(_misses(way, seen)),
        ideal_closed=False,
    )


def _misses(way: Way, seen: list[Visit]) -> Iterator[SketchLabel]:
    """Yield how near the car came to the goals that it never entered, where it was then."""
    for visit in seen:
        region = visit.goal.region
        if visit.entered_s is not None or visit.nearest_m > 0.9 * visit.first_m:
            continue
        at = int(np.argmin(exact.hypot(way.x_m - region.x_m, way.y_m - region.y_m)))
        text = say("figure.apart", value=number(visit.nearest_m, "m"))
        yield SketchLabel(at_m=(float(way.x_m[at]), float(way.y_m[at])), text=text, ok=False)


def _drawn(region: Region, text: Text, *, ok: bool, avoid: bool = False) -> SketchRegion:
    middle = (region.x_m, region.y_m)
    return SketchRegion(outline_m=_outline(region), at_m=middle, text=text, ok=ok, avoid=avoid)


def _outline(region: Region) -> tuple[Point, ...]:
    x, y = region.x_m, region.y_m
    if region.kind == "box":
        half, tall = region.width_m / 2.0, region.height_m / 2.0
        return ((x - half, y - tall), (x + half, y - tall), (x + half, y + tall), (x - half, y + tall))
    angles = [math.tau * i / _CIRCLE_POINTS for i in range(_CIRCLE_POINTS)]
    return tuple((x + region.radius_m * exact.cos(a), y + region.radius_m * exact.sin(a)) for a in angles)


def _plain(text: str) -> Text:
    return Text(zh=text, en=text)


def _consult(assignment: Assignment) -> Iterable[Misfit]:
    if assignment.places is None:
        return (("places", _NO_PLACES),)
    return (*_wrong_items(assignment, assignment.places), *_wrong_goals(assignment))


def _wrong_items(assignment: Assignment, wanted: WantedPlaces) -> Iterator[Misfit]:
    most = max(len(case.visit) or len(wanted.visit) for case in assignment.cases)
    for i, item in enumerate(assignment.items):
        if item.measure == "reached" and (item.low or 0.0) > most:
            zh, en = f"只有 {most} 个目标：写 {most}", f"there are only {most} goals; write {most}"
            yield f"items.{i}.low", Text(zh=zh, en=en)
    has_walls = assignment.world.window or assignment.world.room is not None
    yield from unmet(
        assignment,
        (("heading_error_deg",), wanted.end_heading_deg is not None, _NO_HEADING),
        (("entered",), bool(wanted.avoid), _NOTHING_TO_AVOID),
        (("contacts",), has_walls, _NO_WALLS),
        (("clearance_m",), has_walls or bool(wanted.avoid), _NOTHING_TO_AVOID),
    )


def _wrong_goals(assignment: Assignment) -> Iterator[Misfit]:
    for case_number, case in enumerate(assignment.cases):
        task = assignment.in_case(case.id)
        start = task.world.start
        where = f"cases.{case_number}.visit" if case.visit else "places.visit"
        for i, goal in enumerate(() if task.places is None else task.places.visit):
            region = goal.region
            room = task.world.room
            inside = 0.0 <= region.x_m <= WINDOW_M and 0.0 <= region.y_m <= WINDOW_M
            if task.world.window and not inside:
                yield f"{where}.{i}", _OUTSIDE
            if room is not None and not (
                room.left_m <= region.x_m <= room.right_m and room.bottom_m <= region.y_m <= room.top_m
            ):
                yield f"{where}.{i}", _OUTSIDE_ROOM
            if outside_m(region, start.x_m, start.y_m) <= 0.0 and i == 0:
                yield f"{where}.{i}", _AT_START
            if goal.hold_s >= assignment.horizon_s:
                yield f"{where}.{i}.hold_s", _TOO_LONG


CHECK = Check(
    kind="places", measures=MEASURES, consult=_consult, measure=measure, explain=explain, sketch=sketch
)
