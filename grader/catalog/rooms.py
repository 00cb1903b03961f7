"""The schema of a robot's room. Where a pair of numbers stands for one, each seed draws its own."""

import math
from collections.abc import Iterator, Sequence
from random import Random
from typing import Annotated, Final

import numpy as np
from pydantic import Field, model_validator

from grader.catalog.misfits import BOUNDS, NO_FREE_ROOM, SAME_ENDS, START_OUTSIDE, MisfitError
from grader.catalog.spec import (
    Metres,
    Size,
    SpecModel,
    SpreadMetres,
    SpreadSize,
    SpreadTurn,
    Turn,
    drawn,
)
from grader.contracts.assignment import Region, Room, Solid, StartPose, Stripe
from grader.contracts.python import Self
from grader.geometry.room import clearance_m

EDGE_M: Final = 0.1  # how thick outer walls are; they stand outside of the bounds
_NARROW_M: Final = 0.3  # least gap around a drawn solid, so that a robot gets past it
_TRIES: Final = 200
_LEAST_M, _MOST_M = 0.5, 20.0  # width and height of a room


class NoPlaceError(MisfitError):
    """A drawn solid finds no place. `field` leads from the room to it."""


class WallModel(SpecModel):
    """A straight wall within the room."""

    begin: Annotated[tuple[SpreadMetres, SpreadMetres], Field(alias="from")]
    end: Annotated[tuple[SpreadMetres, SpreadMetres], Field(alias="to")]
    thickness: Size = 0.05
    height_m: Size = 0.5

    @model_validator(mode="after")
    def _is_long(self) -> Self:
        if self.begin == self.end:
            raise MisfitError(SAME_ENDS, "to")
        return self

    @property
    def is_drawn(self) -> bool:
        """Whether it differs from seed to seed."""
        return any(isinstance(value, tuple) for value in (*self.begin, *self.end))

    def solid(self, source: Random) -> Solid:
        """Return the contract."""
        x0, y0 = (drawn(value, source, 2) for value in self.begin)
        x1, y1 = (drawn(value, source, 2) for value in self.end)
        return Solid(
            kind="wall",
            x_m=(x0 + x1) / 2.0,
            y_m=(y0 + y1) / 2.0,
            heading_deg=math.degrees(math.atan2(y1 - y0, x1 - x0)),
            length_m=math.hypot(x1 - x0, y1 - y0) + self.thickness,
            width_m=self.thickness,
            height_m=self.height_m,
        )


class BoxModel(SpecModel):
    """A box that stands on the floor."""

    at: tuple[SpreadMetres, SpreadMetres]
    size: tuple[SpreadSize, SpreadSize]
    heading_deg: SpreadTurn = 0.0
    height_m: Size = 0.4

    @property
    def is_drawn(self) -> bool:
        """Whether it differs from seed to seed."""
        return any(isinstance(value, tuple) for value in (*self.at, *self.size, self.heading_deg))

    def solid(self, source: Random) -> Solid:
        """Return the contract."""
        x, y = (drawn(value, source, 2) for value in self.at)
        length, width = (drawn(value, source, 2) for value in self.size)
        heading = drawn(self.heading_deg, source, 0)
        return Solid(
            kind="box",
            x_m=x,
            y_m=y,
            heading_deg=heading,
            length_m=length,
            width_m=width,
            height_m=self.height_m,
        )


class CylinderModel(SpecModel):
    """A post or a bin."""

    at: tuple[SpreadMetres, SpreadMetres]
    radius: SpreadSize
    height_m: Size = 0.4

    @property
    def is_drawn(self) -> bool:
        """Whether it differs from seed to seed."""
        return any(isinstance(value, tuple) for value in (*self.at, self.radius))

    def solid(self, source: Random) -> Solid:
        """Return the contract."""
        x, y = (drawn(value, source, 2) for value in self.at)
        wide = 2.0 * drawn(self.radius, source, 2)
        return Solid(kind="cylinder", x_m=x, y_m=y, length_m=wide, width_m=wide, height_m=self.height_m)


class RampModel(SpecModel):
    """A slope, which rises from the floor along its heading to its height."""

    at: tuple[Metres, Metres]
    size: tuple[Size, Size]
    heading_deg: Turn = 0.0
    height_m: Annotated[float, Field(ge=0.01, le=0.5)] = 0.05

    @property
    def is_drawn(self) -> bool:
        """Whether it differs from seed to seed."""
        return False

    def solid(self, source: Random) -> Solid:
        """Return the contract."""
        return Solid(
            kind="ramp",
            x_m=self.at[0],
            y_m=self.at[1],
            heading_deg=self.heading_deg,
            length_m=self.size[0],
            width_m=self.size[1],
            height_m=self.height_m,
        )


class LineModel(SpecModel):
    """A line on the floor."""

    points: Annotated[tuple[tuple[Metres, Metres], ...], Field(min_length=2, max_length=200)]
    width: Annotated[float, Field(ge=0.005, le=1.0)] = 0.05

    def stripe(self) -> Stripe:
        """Return the contract."""
        return Stripe(points_m=self.points, width_m=self.width)


class RoomModel(SpecModel):
    """A floor with walls around it, and what stands on it."""

    bounds: tuple[SpreadMetres, SpreadMetres, SpreadMetres, SpreadMetres]
    walls: Annotated[tuple[WallModel, ...], Field(max_length=40)] = ()
    boxes: Annotated[tuple[BoxModel, ...], Field(max_length=40)] = ()
    cylinders: Annotated[tuple[CylinderModel, ...], Field(max_length=40)] = ()
    ramps: Annotated[tuple[RampModel, ...], Field(max_length=10)] = ()
    lines: Annotated[tuple[LineModel, ...], Field(max_length=10)] = ()
    height_m: Size = 0.5

    @model_validator(mode="after")
    def _is_wide(self) -> Self:
        ends = [bound if isinstance(bound, tuple) else (bound, bound) for bound in self.bounds]
        for low, high in (ends[::2], ends[1::2]):
            if high[0] - low[1] < _LEAST_M or high[1] - low[0] > _MOST_M:
                raise MisfitError(BOUNDS, "bounds")
        return self

    def to_contract(self, seed: str, start: StartPose, goals: Sequence[Region]) -> Room:
        """Return the room of one seed. What is drawn stands clear of start, goals and what is there already.

        Raises NoPlaceError: a solid finds no place, or the robot starts outside.
        """
        source = Random(f"room {seed}")  # noqa: S311 - the same room each time, not a secret
        left, bottom, right, top = bounds = tuple(drawn(bound, source, 2) for bound in self.bounds)
        solids = list(_edges(bounds, self.height_m))
        inside = left <= start.x_m <= right and bottom <= start.y_m <= top
        if not inside or not all(_clear_of_start(edge, start, 0.0) for edge in solids):
            raise NoPlaceError(START_OUTSIDE, "bounds")
        for name in ("walls", "boxes", "cylinders", "ramps"):
            for i, model in enumerate(getattr(self, name)):
                for _ in range(_TRIES if model.is_drawn else 1):
                    solid = model.solid(source)
                    free = not model.is_drawn or _clear_of(solid, solids, goals, bounds)
                    if free and _clear_of_start(solid, start, _NARROW_M if model.is_drawn else 0.0):
                        solids.append(solid)
                        break
                else:
                    raise NoPlaceError(NO_FREE_ROOM, name, i)
        stripes = tuple(line.stripe() for line in self.lines)
        return Room(
            left_m=left, bottom_m=bottom, right_m=right, top_m=top, solids=tuple(solids), stripes=stripes
        )


def _edges(bounds: tuple[float, ...], height_m: float) -> Iterator[Solid]:
    """Yield the outer walls: left, bottom, right, top."""
    left, bottom, right, top = bounds
    x, y, half = (left + right) / 2.0, (bottom + top) / 2.0, EDGE_M / 2.0
    wide, high = right - left + 2.0 * EDGE_M, top - bottom + 2.0 * EDGE_M
    for at_x, at_y, length, width in (
        (left - half, y, EDGE_M, high),
        (x, bottom - half, wide, EDGE_M),
        (right + half, y, EDGE_M, high),
        (x, top + half, wide, EDGE_M),
    ):
        yield Solid(kind="edge", x_m=at_x, y_m=at_y, length_m=length, width_m=width, height_m=height_m)


def _clear_of_start(solid: Solid, start: StartPose, least_m: float) -> bool:
    pose = (np.array([value]) for value in (start.x_m, start.y_m, math.radians(start.heading_deg)))
    return solid.kind == "ramp" or float(clearance_m(solid, *pose)[0]) > least_m


def _clear_of(
    solid: Solid, others: Sequence[Solid], goals: Sequence[Region], bounds: tuple[float, ...]
) -> bool:
    """Return whether a robot gets by on both sides of a drawn solid, and into every goal."""
    reach = math.hypot(solid.length_m, solid.width_m) / 2.0
    if any(
        math.hypot(goal.x_m - solid.x_m, goal.y_m - solid.y_m)
        < reach + _NARROW_M + max(goal.radius_m, math.hypot(goal.width_m, goal.height_m) / 2.0)
        for goal in goals
    ):
        return False
    left, bottom, right, top = bounds
    if not (left <= solid.x_m <= right and bottom <= solid.y_m <= top):
        return False
    return all(_apart_m(solid, other) >= reach + _NARROW_M for other in others)


def _apart_m(solid: Solid, other: Solid) -> float:
    """Return how far the middle of a solid is from the outline of another one."""
    dx, dy = solid.x_m - other.x_m, solid.y_m - other.y_m
    if other.kind == "cylinder":
        return math.hypot(dx, dy) - other.length_m / 2.0
    turn = math.radians(other.heading_deg)
    x, y = dx * math.cos(turn) + dy * math.sin(turn), dy * math.cos(turn) - dx * math.sin(turn)
    return math.hypot(max(abs(x) - other.length_m / 2.0, 0.0), max(abs(y) - other.width_m / 2.0, 0.0))
