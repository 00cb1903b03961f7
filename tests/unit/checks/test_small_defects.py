"""What the tolerances promise: 3 % in a side or 2° in a corner cost nothing, 8 % or 6° do, wherever they are."""

import pytest

from grader.checks import evaluate
from tests.unit.checks.shipped import assignment
from tests.unit.checks.trajectories import drive, polygon_legs, run_of

SIDES = {"triangle": 3, "square": 4, "pentagon": 5, "hexagon": 6, "octagon": 8, "rectangle": 4}


def points(name: str, lengths_m: list[float], corners_deg: list[float]) -> float:
    legs = polygon_legs(len(lengths_m), lengths_m=lengths_m, corners_deg=corners_deg)
    scoring = evaluate(assignment(name), [run_of(drive(legs))])
    return sum(item.earned for item in scoring.items)


def shape(name: str) -> tuple[list[float], list[float]]:
    count = SIDES[name]
    lengths = [3.0, 2.0, 3.0, 2.0] if name == "rectangle" else [1.5] * count
    return lengths, [360.0 / count] * count


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("name", SIDES)
def test_each_side_and_corner_is_held_to_the_same_tolerance(name: str, sign: float) -> None:
    lengths, corners = shape(name)
    for i in range(SIDES[name]):
        for percent, full in ((3.0, True), (8.0, False)):
            bent = [one * (1 + sign * percent / 100 * (i == j)) for j, one in enumerate(lengths)]
            assert (points(name, bent, corners) == 100.0) is full, (i, percent)
        for degrees, full in ((2.0, True), (6.0, False)):
            bent = [one + sign * degrees * (i == j) for j, one in enumerate(corners)]
            assert (points(name, lengths, bent) == 100.0) is full, (i, degrees)
