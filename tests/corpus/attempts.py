"""What is driven: figures over speeds, sizes, senses, headings, pauses and laps, with and without defects."""

import itertools
import math
import random
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Literal

Leg = tuple[float, float, float]  # duration in s, v in m/s, w in rad/s
Truth = Literal["right", "harmless", "wrong"]

HORIZON_S = 60.0
FINE_TICK_S = 0.002  # of scripts with a measured defect: adds nothing to it
REACH_M = 5.3  # from the middle of the field to the nearest wall, with a margin
UPDATE_S = 0.016  # of turtlesim: every motion takes whole updates
MAX_TICK_TURN_RAD = math.radians(2.0)  # a loop that turns further in one tick is no right script
MAX_TICK_SHARE = 0.02  # nor one whose sides may differ by more than that for want of a tick
TICKS_S = (0.1, 0.05, 0.02, 0.01, 0.005)

SPEEDS_MPS = (0.2, 0.5, 1.0, 1.5, 2.0, 3.0)
TURN_RATES_RADPS = (0.3, 0.5, 1.0, 1.57, 2.2, 3.1)
SIDES_M = (0.5, 0.8, 1.2, 2.0, 3.0, 4.0)
HEADINGS_DEG = (0.0, 0.0, 37.0, 90.0, 163.0, -120.0)
PAUSES_S = (0.0, 0.1, 0.3, 1.0)
FIGURES = {"triangle": 3, "square": 4, "pentagon": 5, "hexagon": 6, "octagon": 8, "rectangle": 4}
OPEN_STYLES = ("sleep loop", "clock loop", "timer", "rate in a thread", "spin_once loop", "callback chain")
STYLES = (*OPEN_STYLES, "closed loop")


@dataclass(frozen=True, slots=True, kw_only=True)
class Attempt:
    """One generated script and what must become of it.

    Attributes:
        assignment: what it is handed in for. style: how the script is written.
        legs: the motion. tick_s: period of the script's loop or timer.
        heading_deg: of the car at the start. for_ever: the legs are repeated until Ctrl+C.
        stops: a stop is published at the end.
        defect: what is wrong with it, and how much (in `unit`); empty when right.
    """

    assignment: str
    style: str
    legs: tuple[Leg, ...]
    tick_s: float
    heading_deg: float = 0.0
    for_ever: bool = False
    stops: bool = True
    truth: Truth = "right"
    defect: str = ""
    size: float = 0.0
    unit: str = ""

    @property
    def duration_s(self) -> float:
        """Virtual time one pass through the legs takes."""
        return sum(math.ceil(leg[0] / self.tick_s) * self.tick_s for leg in self.legs)

    def __str__(self) -> str:
        what = f"{self.defect} {self.size:+g} {self.unit}".strip() if self.defect else self.truth
        return f"{self.assignment}, {self.style}, {what}"


@dataclass(frozen=True, slots=True, kw_only=True)
class Manner:
    """How a figure is driven, apart from its shape."""

    v_mps: float
    w_radps: float
    pause_s: float
    tick_s: float
    style: str
    heading_deg: float

    def drive(self, length_m: float, w_radps: float = 0.0) -> list[Leg]:
        """Drive a length, in an arc if `w_radps` is given, then pause."""
        return [(abs(length_m / self.v_mps), math.copysign(self.v_mps, length_m), w_radps), *self._pause()]

    def turn(self, angle_deg: float) -> list[Leg]:
        """Turn in place, then pause."""
        rate = math.copysign(self.w_radps, angle_deg * self.w_radps)
        return [(abs(math.radians(angle_deg) / self.w_radps), 0.0, rate), *self._pause()]

    def _pause(self) -> list[Leg]:
        return [(self.pause_s, 0.0, 0.0)] if self.pause_s else []


def corpus() -> list[Attempt]:
    """Return every attempt, always the same."""
    dice = random.Random(20)
    found = [*_right(dice), *_defective(dice), *_simple(dice)]
    assert all(attempt.legs for attempt in found)
    return found


def figure_legs(manner: Manner, lengths_m: Sequence[float], corners_deg: Sequence[float]) -> tuple[Leg, ...]:
    """Return the legs that drive each side and the corner after it."""
    pairs = zip(lengths_m, corners_deg, strict=True)
    return tuple(leg for length, corner in pairs for leg in (*manner.drive(length), *manner.turn(corner)))


def _lengths(assignment: str, side_m: float) -> list[float]:
    return [3.0, 2.0, 3.0, 2.0] if assignment == "rectangle" else [side_m] * FIGURES[assignment]


def _corners(assignment: str) -> list[float]:
    return [360.0 / FIGURES[assignment]] * FIGURES[assignment]


def _manner(dice: random.Random, styles: Sequence[str] = STYLES) -> Manner:
    w = dice.choice(TURN_RATES_RADPS)
    fine = [tick for tick in TICKS_S if tick * w <= MAX_TICK_TURN_RAD]
    return Manner(
        v_mps=dice.choice(SPEEDS_MPS),
        w_radps=w * dice.choice((1.0, -1.0)),
        pause_s=dice.choice(PAUSES_S),
        tick_s=dice.choice(fine),
        style=dice.choice(styles),
        heading_deg=dice.choice(HEADINGS_DEG),
    )


def _fits(attempt: Attempt) -> bool:
    """Whether the motion ends in time and stays away from the walls."""
    if attempt.duration_s * 1.05 >= HORIZON_S - 4.0:
        return False
    x = y = heading = farthest = 0.0
    for duration, v, w in attempt.legs:
        for _ in range(8):
            heading += w * duration / 16
            x, y = x + v * duration / 8 * math.cos(heading), y + v * duration / 8 * math.sin(heading)
            heading += w * duration / 16
        farthest = max(farthest, math.hypot(x, y))
    return farthest < REACH_M


def _drawn(dice: random.Random, assignment: str, styles: Sequence[str] = STYLES) -> tuple[Manner, float]:
    """Draw a manner and a side until the right figure fits into field and time."""
    while True:
        manner, side_m = _manner(dice, styles), dice.choice(SIDES_M)
        lengths = _lengths(assignment, side_m)
        legs = figure_legs(manner, lengths, _corners(assignment))
        if manner.v_mps * manner.tick_s > MAX_TICK_SHARE * min(lengths):
            continue
        if _fits(Attempt(assignment=assignment, style=manner.style, legs=legs, tick_s=manner.tick_s)):
            return manner, side_m


def _attempt(assignment: str, manner: Manner, legs: Sequence[Leg], **changes: object) -> Attempt:
    attempt = Attempt(
        assignment=assignment,
        style=manner.style,
        legs=tuple(legs),
        tick_s=manner.tick_s,
        heading_deg=manner.heading_deg,
    )
    return replace(attempt, **changes)  # type: ignore[arg-type]


def _right(dice: random.Random) -> Iterator[Attempt]:
    """Right figures: once with or without the last turn, or over and over until Ctrl+C."""
    for assignment in FIGURES:
        for i in range(56):
            manner, side_m = _drawn(dice, assignment)
            legs = figure_legs(manner, _lengths(assignment, side_m), _corners(assignment))
            if i % 4 == 1:
                pause = 1 if manner.pause_s else 0
                legs = legs[: len(legs) - 1 - pause]
            yield _attempt(assignment, manner, legs, for_ever=i % 4 == 3)


Shape = tuple[list[float], list[float]]


def _one_side(shape: Shape, index: int, percent: float) -> Shape:
    lengths, corners = shape
    return [length * (1 + percent / 100 * (i == index)) for i, length in enumerate(lengths)], corners


def _one_corner(shape: Shape, index: int, degrees: float) -> Shape:
    lengths, corners = shape
    return lengths, [corner + degrees * (i == index) for i, corner in enumerate(corners)]


def _all_corners(shape: Shape, _: int, degrees: float) -> Shape:
    return shape[0], [corner + degrees for corner in shape[1]]


def _side_count(shape: Shape, _: int, more: float) -> Shape:
    lengths, corners = shape
    if more > 0:
        return lengths + lengths[:1], corners + corners[:1]
    return lengths[:-1], corners[:-1]


def _other_way(shape: Shape, index: int, _: float) -> Shape:
    return shape[0], [corner * (-1 if i == index else 1) for i, corner in enumerate(shape[1])]


DEFECTS = {
    "one side": (_one_side, "%", (-35.0, -20.0, -12.0, -8.0, 8.0, 12.0, 20.0, 35.0)),
    "one corner": (_one_corner, "deg", (-40.0, -20.0, -10.0, -6.0, 6.0, 10.0, 20.0, 40.0)),
    "all corners": (_all_corners, "deg", (-20.0, -10.0, -6.0, 6.0, 10.0, 20.0)),
    "sides": (_side_count, "", (-1.0, 1.0)),
    "other way": (_other_way, "", (1.0,)),
}
HARMLESS = {
    "one side": (_one_side, "%", (-3.0, 3.0)),
    "one corner": (_one_corner, "deg", (-2.0, 2.0)),
}


def _defective(dice: random.Random) -> Iterator[Attempt]:
    """Figures with one defect of a given size; the tick is so fine that it adds nothing to the defect."""
    for assignment, (truth, table) in itertools.product(
        FIGURES, (("wrong", DEFECTS), ("harmless", HARMLESS))
    ):
        for defect, (spoil, unit, sizes) in table.items():
            for size in sizes:
                yield from _spoilt(dice, assignment, truth, defect, spoil, size, unit)  # type: ignore[arg-type]
        if truth == "wrong":
            yield from _careless(dice, assignment)


EDGES = {"one side": (6.5, 20.0), "one corner": (3.0, 15.0), "all corners": (3.0, 15.0)}
"""Where credit begins to fall and where it ends, in most figures."""


def near_edges(count: int = 200) -> list[Attempt]:
    """Return figures whose defect is a little more or less than the edge of a band, always the same."""
    dice = random.Random(42)
    drawn = []
    for _ in range(count):
        defect = dice.choice(list(EDGES))
        size = dice.choice(EDGES[defect]) * dice.uniform(0.98, 1.02) * dice.choice((1.0, -1.0))
        spoil, unit, _ = DEFECTS[defect]
        drawn += [*_spoilt(dice, dice.choice(list(FIGURES)), "wrong", defect, spoil, round(size, 3), unit)][
            :1
        ]
    return drawn


def _spoilt(
    dice: random.Random, assignment: str, truth: Truth, defect: str, spoil: object, size: float, unit: str
) -> Iterator[Attempt]:
    for _ in range(2 if unit else 1):
        while True:
            manner, side_m = _drawn(dice, assignment)
            manner = replace(manner, tick_s=FINE_TICK_S if manner.style != "closed loop" else manner.tick_s)
            shape = (_lengths(assignment, side_m), _corners(assignment))
            index = dice.randrange(FIGURES[assignment] - 1)
            legs = figure_legs(manner, *spoil(shape, index, size))  # type: ignore[operator]
            attempt = _attempt(assignment, manner, legs, truth=truth, defect=defect, size=size, unit=unit)
            if _fits(attempt) and (truth == "wrong" or _finely(manner, min(shape[0]))):
                yield attempt
                break


def _finely(manner: Manner, side_m: float) -> bool:
    """Whether turtlesim's updates add so little to a harmless defect that it stays one."""
    return abs(manner.w_radps) * UPDATE_S <= math.radians(1.0) and manner.v_mps * UPDATE_S <= 0.01 * side_m


def _careless(dice: random.Random, assignment: str) -> Iterator[Attempt]:
    """Corners driven as arcs of a given radius (in per cent of the side), and no stop at the end."""
    for percent in (20.0, 35.0) if assignment == "rectangle" else (20.0, 35.0, 60.0):
        while True:
            manner, side_m = _drawn(dice, assignment, OPEN_STYLES)
            lengths = _lengths(assignment, side_m)
            radius_m = min(lengths) * percent / 100
            corner = math.radians(360.0 / FIGURES[assignment])
            if abs(manner.v_mps / radius_m) > 6.0:
                continue
            w = math.copysign(manner.v_mps / radius_m, manner.w_radps)
            manner = replace(manner, tick_s=FINE_TICK_S)
            legs = [
                leg
                for length in lengths
                for leg in (*manner.drive(length), *manner.drive(radius_m * corner, w))
            ]
            attempt = _attempt(assignment, manner, legs, truth="wrong", defect="arcs", size=percent, unit="%")
            if _fits(attempt):
                yield attempt
                break
    manner, side_m = _drawn(dice, assignment, OPEN_STYLES)
    legs = figure_legs(manner, _lengths(assignment, side_m), _corners(assignment))
    circling = (*legs, (1.0, 0.4, 0.3))
    yield _attempt(assignment, manner, circling, stops=False, truth="wrong", defect="no stop")


def _simple(dice: random.Random) -> Iterator[Attempt]:
    """Straight, backward and spin, right and wrong."""
    for _ in range(16):
        ahead = replace(_manner(dice, OPEN_STYLES), pause_s=0.0)
        length_m = dice.choice((0.8, 1.5, 3.0))
        turn = math.copysign(dice.choice((365.0, 380.0, 730.0)), ahead.w_radps)
        yield _attempt("straight", ahead, ahead.drive(length_m))
        yield _attempt("backward", ahead, ahead.drive(-length_m))
        yield _attempt("spin", ahead, ahead.turn(abs(turn)))
    for size in (0.1, 0.25, 0.4):
        for assignment, sense in (("straight", 1.0), ("backward", -1.0)):
            slow = replace(_manner(dice, OPEN_STYLES), v_mps=0.5, tick_s=FINE_TICK_S, pause_s=0.0)
            yield _wrong(assignment, slow, slow.drive(sense * size), "too short", size, "m")
    for size in (12.0, 30.0, 90.0):
        for assignment, sense in (("straight", 1.0), ("backward", -1.0)):
            bent = replace(_manner(dice, OPEN_STYLES), v_mps=1.0, tick_s=FINE_TICK_S, pause_s=0.0)
            yield _wrong(
                assignment, bent, bent.drive(sense * 2.0, math.radians(size) / 2.0), "curved", size, "deg"
            )
            back = [*bent.drive(sense * 2.0), *bent.drive(-sense * size / 100.0)]
            yield _wrong(assignment, bent, back, "came back", size / 100.0, "m")
    for size in (-180.0, -90.0, -45.0, -12.0):
        spin = replace(_manner(dice, OPEN_STYLES), tick_s=FINE_TICK_S, pause_s=0.0)
        yield _wrong("spin", spin, spin.turn(360.0 + size), "turn", size, "deg")
    for size in (0.3, 0.6, 1.0):
        spin = replace(_manner(dice, OPEN_STYLES), v_mps=1.0, tick_s=FINE_TICK_S, pause_s=0.0)
        yield _wrong("spin", spin, [*spin.turn(365.0), *spin.drive(size)], "left place", size, "m")


def _wrong(
    assignment: str, manner: Manner, legs: Sequence[Leg], defect: str, size: float, unit: str
) -> Attempt:
    return _attempt(assignment, manner, legs, truth="wrong", defect=defect, size=size, unit=unit)
