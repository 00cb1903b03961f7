"""Check ``path`` on random paths: a measure of the figure, whatever its pieces, place, size and direction."""

import itertools
import math
from dataclasses import replace

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from grader.checks import evaluate
from grader.contracts.assignment import Assignment, PathPiece, WantedPath
from grader.contracts.trajectory import Trajectory
from tests.examples import examples
from tests.unit.checks.shipped import assignment, score
from tests.unit.checks.trajectories import Leg, drive, run_of

LINES = st.floats(1.0, 3.0).map(lambda m: PathPiece(kind="line", length_m=round(m, 2)))
ARCS = st.builds(
    lambda deg, m, left: PathPiece(kind="arc", angle_deg=deg if left else -deg, radius_m=round(m, 2)),
    st.integers(60, 300),
    st.floats(0.5, 1.5),
    st.booleans(),
)
TURNS = st.builds(
    lambda deg, left: PathPiece(kind="turn", angle_deg=float(deg if left else -deg)),
    st.integers(50, 130),
    st.booleans(),
)
PATHS = st.one_of(
    st.tuples(LINES, TURNS, LINES), st.tuples(LINES, TURNS, ARCS), st.tuples(ARCS, TURNS, LINES)
)
HEADINGS = st.floats(-180.0, 180.0)
EXAMPLES = settings(max_examples=examples(15))


def asked(pieces: tuple[PathPiece, ...], **free: object) -> Assignment:
    """Return an assignment on the whole path alone, whatever its pieces."""
    task = assignment("letter_l")
    kept = {"distance_m", "off_pct", "mean_off_pct", "covered_pct", "gap_pct", "settled"}
    items = tuple(replace(item, needs=()) for item in task.items if item.measure in kept)
    values: dict[str, object] = {"any_start": True, "mirror": False, "any_direction": False, **free}
    return replace(task, items=items, path=WantedPath(pieces=pieces, **values))  # type: ignore[arg-type]


def legs(pieces: tuple[PathPiece, ...], scale: float = 1.0) -> list[Leg]:
    found: list[Leg] = []
    for piece in pieces:
        turn = abs(math.radians(piece.angle_deg))
        sense = math.copysign(1.0, piece.angle_deg)
        if piece.kind == "line":
            found.append((piece.length_m * scale, 1.0, 0.0))
        elif piece.kind == "turn":
            found.append((turn, 0.0, sense))
        else:
            radius_m = piece.radius_m * scale
            found.append((turn * radius_m, 1.0, sense / radius_m))
        found.append((0.1, 0.0, 0.0))
    return found


def share(task: Assignment, trajectory: Trajectory) -> float:
    """Return the share of the points that a motion earns."""
    return score(evaluate(task, [run_of(trajectory)])) / task.max_score


def mirrored(pieces: tuple[PathPiece, ...]) -> tuple[PathPiece, ...]:
    return tuple(replace(piece, angle_deg=-piece.angle_deg) for piece in pieces)


def waved(trajectory: Trajectory, wide_m: float) -> Trajectory:
    """Return a motion that swings to and fro across its way."""
    swing = wide_m * np.sin(np.arange(len(trajectory)) / 25.0)
    return replace(
        trajectory,
        x_m=trajectory.x_m - swing * np.sin(trajectory.heading_rad),
        y_m=trajectory.y_m + swing * np.cos(trajectory.heading_rad),
    )


def size_of(trajectory: Trajectory) -> float:
    return math.hypot(float(np.ptp(trajectory.x_m)), float(np.ptp(trajectory.y_m)))


@EXAMPLES
@given(PATHS, HEADINGS, st.floats(1.0, 9.0), st.floats(0.4, 2.5))
def test_place_heading_and_where_it_is_free_the_size_cost_nothing(
    pieces: tuple[PathPiece, ...], heading_deg: float, at: float, scale: float
) -> None:
    there = {"heading_deg": heading_deg, "start_m": (at, 10.0 - at)}
    assert share(asked(pieces), drive(legs(pieces), **there)) == 1.0  # type: ignore[arg-type]
    assert share(asked(pieces, any_scale=True), drive(legs(pieces, scale), **there)) == 1.0  # type: ignore[arg-type]


@EXAMPLES
@given(PATHS)
def test_the_mirror_image_counts_by_option(pieces: tuple[PathPiece, ...]) -> None:
    other = drive(legs(mirrored(pieces)))
    assert share(asked(pieces, mirror=True), other) == 1.0
    assert share(asked(pieces), other) <= 1.0


@EXAMPLES
@given(st.floats(2.0, 3.0), st.floats(0.8, 1.4), st.integers(60, 120))
def test_the_way_back_counts_by_option(first_m: float, second_m: float, corner_deg: int) -> None:
    turn = PathPiece(kind="turn", angle_deg=float(corner_deg))
    first, second = (PathPiece(kind="line", length_m=each) for each in (first_m, second_m))
    back = drive(legs((second, *mirrored((turn,)), first)))
    assert share(asked((first, turn, second), any_direction=True), back) == 1.0
    assert share(asked((first, turn, second)), back) < 0.9
    mirror = drive(legs((first, *mirrored((turn,)), second)))
    assert share(asked((first, turn, second)), mirror) < 0.9


@EXAMPLES
@given(PATHS, st.integers(1, 9))
def test_noise_of_one_percent_costs_nothing_and_of_ten_percent_costs(
    pieces: tuple[PathPiece, ...], seed: int
) -> None:
    right = drive(legs(pieces))
    size_m = size_of(right)
    assert share(asked(pieces), drive(legs(pieces), noise_m=0.01 * size_m, seed=seed)) == 1.0
    assert share(asked(pieces), waved(right, 0.01 * size_m)) == 1.0
    assert share(asked(pieces), waved(right, 0.1 * size_m)) < 1.0


@EXAMPLES
@given(PATHS)
def test_credit_falls_as_the_first_piece_gets_longer(pieces: tuple[PathPiece, ...]) -> None:
    first = pieces[0]
    shares = []
    for error in (0.0, 0.1, 0.2, 0.4, 0.8):
        longer = replace(first, length_m=first.length_m * (1 + error), radius_m=first.radius_m * (1 + error))
        shares.append(share(asked(pieces), drive(legs((longer, *pieces[1:])))))
    assert shares[0] == 1.0
    assert all(later <= earlier + 0.005 for earlier, later in itertools.pairwise(shares)), shares
    assert shares[-1] < 0.9
