"""Check ``room``: what a robot did among walls: how near it came, for how long, where it went and stopped."""

import math
from collections.abc import Iterator

import numpy as np

from grader.checks.drive import MOVING_MPS, Drive, drive_of
from grader.checks.fit import Misfit, is_number, unmet
from grader.checks.kinds.room.mistakes import room_mistakes
from grader.checks.kinds.room.way import POINT_M, SIDES, WallFollowing, points_of, wall_following
from grader.checks.measure import UNMEASURED, Check, Measure, MeasureKind, Measures, Mistake, Option
from grader.checks.mistakes import driving_mistakes
from grader.checks.surroundings import clearance
from grader.contracts.assignment import Assignment, Room
from grader.contracts.figure import FigureSketch
from grader.contracts.robot import SCANNER_X_M
from grader.contracts.scoring import Run
from grader.contracts.text import Text
from grader.contracts.trajectory import Floats, Trajectory
from grader.geometry import exact
from grader.geometry.room import ahead_m, from_point_m
from grader.messages.quantity import number

CELL_M = 0.25
_AROUND_M = 0.12  # from a cell's middle to whatever stands there, so that a robot gets in
MEASURES = {
    "distance_m": MeasureKind("m"),
    "contacts": MeasureKind(form="count"),
    "clearance_m": MeasureKind("m"),
    "ahead_m": MeasureKind("m"),
    "settled": MeasureKind(form="flag"),
    "turned_deg": MeasureKind("deg"),
    "moving_s": MeasureKind("s"),
    "covered_pct": MeasureKind("%"),
    "band_pct": MeasureKind("%"),
    "band_m": MeasureKind("m"),
    "line_pct": MeasureKind("%"),
    "line_covered_pct": MeasureKind("%"),
}
_NO_ROBOT = Text(
    zh="检查 room 需要机器人：写 world: {kind: robot, room: …}",
    en="the check room needs a robot; write world: {kind: robot, room: …}",
)
_NO_BAND = Text(
    zh="缺少 options.band_low_m 和 band_high_m：补上",
    en="options.band_low_m and band_high_m are missing; add them",
)
_SWAPPED = Text(
    zh="要小于 band_high_m：对调或改小", en="must be less than band_high_m; swap them or make it smaller"
)
_NO_LINE = Text(
    zh="缺少 options.line_within_m 或 world.room.lines：补上",
    en="options.line_within_m or world.room.lines is missing; add it",
)
_LENGTH = Text(zh="要写大于 0 的长度，单位 m", en="must be a length above 0, in m")
_SIDE = Text(zh="要写 left 或 right", en="must be left or right")


def measure(assignment: Assignment, run: Run) -> Measures:
    """Measure a drive in a room."""
    drive, room = drive_of(run), assignment.world.room
    if drive is None or room is None:
        return {}
    trajectory, band = run.trajectory, wall_following(assignment, room, drive)
    return {
        "distance_m": Measure(float(np.max(drive.path.along_m))),
        "contacts": Measure(float(len(trajectory.contacts))),
        "clearance_m": clearance(room, trajectory),
        "ahead_m": _ahead(room, trajectory),
        "settled": Measure(0.0 if drive.moving_at_end else 1.0),
        "turned_deg": Measure(
            math.degrees(abs(float(trajectory.heading_rad[-1] - trajectory.heading_rad[0])))
        ),
        "moving_s": Measure(_moving_s(trajectory)),
        "covered_pct": Measure(100.0 * _covered(room, trajectory)),
        **_band(band),
        **_line(assignment, room, drive),
    }


def explain(assignment: Assignment, run: Run, measures: Measures) -> tuple[Mistake, ...]:
    """Return what probably went wrong."""
    return driving_mistakes(run, room_mistakes(assignment, run, drive_of(run), measures))


def _ahead(room: Room, trajectory: Trajectory) -> Measure:
    """Return how far the scanner sees straight ahead in the end."""
    x, y, heading = (float(c[-1]) for c in (trajectory.x_m, trajectory.y_m, trajectory.heading_rad))
    x += SCANNER_X_M * exact.cos(heading)
    y += SCANNER_X_M * exact.sin(heading)
    seen = ahead_m(room.solids, x, y, heading)
    return Measure(seen) if math.isfinite(seen) else UNMEASURED


def _moving_s(trajectory: Trajectory) -> float:
    """Return for how long the robot drove before it touched anything; turning on the spot is not driving."""
    steps_s = np.diff(trajectory.t_ns) * 1e-9
    drives = np.abs(trajectory.v_mps[1:]) > MOVING_MPS
    return exact.total(steps_s[drives & (trajectory.t_ns[1:] * 1e-9 <= _touched_s(trajectory))])


def _touched_s(trajectory: Trajectory) -> float:
    """Return when the robot first touched something."""
    return min((contact.start_ns * 1e-9 for contact in trajectory.contacts), default=math.inf)


def _covered(room: Room, trajectory: Trajectory) -> float:
    """Return in which share of the cells it can be in the robot was before it touched anything."""
    columns = np.arange(room.left_m + CELL_M / 2.0, room.right_m, CELL_M)
    rows = np.arange(room.bottom_m + CELL_M / 2.0, room.top_m, CELL_M)
    x, y = (each.ravel() for each in np.meshgrid(columns, rows))
    free = np.ones(len(x), dtype=bool)
    for solid in room.solids:
        free &= from_point_m(solid, x, y) > (_AROUND_M if solid.kind != "ramp" else -1.0)
    free_of_touch = trajectory.t_ns * 1e-9 <= _touched_s(trajectory)
    at_x, at_y = trajectory.x_m[free_of_touch], trajectory.y_m[free_of_touch]
    column = np.clip(((at_x - room.left_m) / CELL_M).astype(int), 0, len(columns) - 1)
    row = np.clip(((at_y - room.bottom_m) / CELL_M).astype(int), 0, len(rows) - 1)
    been = np.zeros(len(x), dtype=bool)
    been[row * len(columns) + column] = True
    return float(np.sum(been & free)) / max(int(np.sum(free)), 1)


def _band(band: WallFollowing | None) -> dict[str, Measure]:
    """Measure which share of the way ran along a wall as it should, and how far the robot got on it."""
    if band is None:
        return {}
    details = {"low": number(band.low_m, "m"), "high": number(band.high_m, "m")}
    return {
        "band_pct": Measure(100.0 * band.kept_share, details),
        "band_m": Measure(band.way_m, details),
    }


def _line(assignment: Assignment, room: Room, drive: Drive) -> dict[str, Measure]:
    """Measure which share of the way ran over the lines on the floor, and how much of them."""
    within = assignment.options.get("line_within_m")
    if within is None or not room.stripes:
        return {}
    x, y, _ = points_of(drive)
    line = [_points_along(stripe.points_m) for stripe in room.stripes]
    line_x, line_y = (np.concatenate([each[i] for each in line]) for i in (0, 1))
    apart = exact.hypot(x[:, None] - line_x, y[:, None] - line_y)
    details = {"within": number(float(within), "m")}
    on_line = np.min(apart, axis=1) <= float(within) + POINT_M / 2.0
    return {
        "line_pct": Measure(100.0 * float(np.mean(on_line)), details),
        "line_covered_pct": Measure(100.0 * float(np.mean(np.min(apart, axis=0) <= float(within))), details),
    }


def _points_along(corners: tuple[tuple[float, float], ...]) -> tuple[Floats, Floats]:
    """Return points of a line on the floor, a centimetre apart or less."""
    at = np.array(corners)
    length = np.concatenate(([0.0], np.cumsum(exact.hypot(*np.diff(at, axis=0).T))))
    steps = np.linspace(0.0, length[-1], max(round(length[-1] / POINT_M), 1) + 1)
    return exact.interpolated(steps, length, at[:, 0]), exact.interpolated(steps, length, at[:, 1])


def sketch(assignment: Assignment, run: Run) -> FigureSketch:
    """Return the bare path: the room is drawn for every check."""
    return FigureSketch(view="path", ideal_closed=False)


def _consult(assignment: Assignment) -> Iterator[Misfit]:
    if assignment.world.kind != "robot":
        yield "world", _NO_ROBOT
        return
    room, options = assignment.world.room, assignment.options
    low, high = (options.get(name) for name in ("band_low_m", "band_high_m"))
    if is_number(low) and is_number(high) and low >= high:
        yield "options.band_low_m", _SWAPPED
    has_band = {"band_low_m", "band_high_m"} <= options.keys()
    has_line = "line_within_m" in options and room is not None and bool(room.stripes)
    yield from unmet(assignment, (("band_pct", "band_m"), has_band, _NO_BAND))
    yield from unmet(assignment, (("line_pct", "line_covered_pct"), has_line, _NO_LINE))


def _problem_with_length(value: Option) -> Text | None:
    return None if is_number(value) and value > 0.0 else _LENGTH


def _problem_with_side(value: Option) -> Text | None:
    return None if value in SIDES else _SIDE


CHECK = Check(
    kind="room",
    measures=MEASURES,
    optional={
        **dict.fromkeys(("band_low_m", "band_high_m", "line_within_m"), _problem_with_length),
        "wall_side": _problem_with_side,
    },
    consult=_consult,
    measure=measure,
    explain=explain,
    sketch=sketch,
)
