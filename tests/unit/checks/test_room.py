"""Check ``room``: each measure against a drive whose measure is known."""

import math
from dataclasses import replace

import numpy as np
import pytest

from grader.checks import problems, sketch
from grader.checks.kinds.room import explain, measure
from grader.checks.measure import Findings
from grader.checks.mistakes import robot_mistakes
from grader.contracts.assignment import Assignment, ItemSpec, Stripe, World
from grader.contracts.outcome import Endpoint, RunStatus
from grader.contracts.robot import FRONT_M, HALF_WIDTH_M, SCANNER_X_M
from grader.contracts.scoring import Run
from grader.contracts.text import Text
from grader.contracts.trajectory import Command, Contact, Trajectory
from tests.unit.checks.trajectories import run_of
from tests.unit.sim.rooms import room, solid

NAME = Text(zh="x", en="x")
ROOM = room(-1.0, -1.0, 2.0, 1.0, solid("cylinder", 0.5, 0.7, 0.2, 0.2))


def examine(assignment: Assignment, run: Run) -> Findings:
    measures = measure(assignment, run)
    return Findings(measures, explain(assignment, run, measures))


def task(*measures: str, **options: float | str) -> Assignment:
    items = tuple(
        ItemSpec(id=each, title=NAME, points=1.0, measure=each, low=0.4, high=0.6) for each in measures
    )
    return Assignment(
        id="a", version=1, order=1, title=NAME, brief=NAME, check="room", items=items,
        options=dict(options), world=World(kind="robot", room=ROOM),
    )  # fmt: skip


def straight(
    to_m: float, *, y_m: float = 0.0, moving: bool = False, contacts: tuple[Contact, ...] = ()
) -> Run:
    """Return a run along y = `y_m` from x = 0 to `to_m` at 0.2 m/s, and a rest of a second unless `moving`."""
    count = round(to_m / 0.2 * 60.0) + 1
    t_ns = np.arange(count, dtype=np.int64) * 16_666_667
    v = np.full(count, 0.2)
    if not moving:
        v[-1] = 0.0
    track = Trajectory(
        t_ns=t_ns, x_m=np.linspace(0.0, to_m, count), y_m=np.full(count, y_m), heading_rad=np.zeros(count),
        v_mps=v, w_radps=np.zeros(count), end_ns=int(t_ns[-1]) + (0 if moving else 10**9), contacts=contacts,
    )  # fmt: skip
    return run_of(track)


def test_where_it_stopped_and_how_near_it_came() -> None:
    found = examine(task("ahead_m"), straight(1.5)).measures
    assert found["distance_m"].value == pytest.approx(1.5)
    assert found["ahead_m"].value == pytest.approx(0.5 - SCANNER_X_M)
    assert found["clearance_m"].value == pytest.approx(min(0.5 - FRONT_M, 0.6 - HALF_WIDTH_M))
    assert found["settled"].value == 1.0
    assert found["moving_s"].value == pytest.approx(7.5, abs=0.05)
    assert found["contacts"].value == 0.0
    assert "band_pct" not in found


def test_the_band_counts_from_where_it_was_first_kept() -> None:
    found = examine(task("band_pct", band_low_m=0.25, band_high_m=0.45), straight(1.5, y_m=-0.6)).measures
    assert found["band_pct"].value == pytest.approx(100.0)  # 0.4 m from the bottom, 0.5 m from the right
    assert found["band_m"].value == pytest.approx(1.5, abs=0.02)
    far = examine(task("band_pct", band_low_m=0.25, band_high_m=0.45), straight(1.9)).measures
    # in the middle 0.6 m from the post, then nearer to the right wall: 0.45 m at x = 1.55, 0.25 m at 1.75
    assert far["band_m"].value == pytest.approx(0.0, abs=0.02)  # towards the wall, not along it
    assert far["band_pct"].value == pytest.approx(100.0 * 0.2 / 0.35, abs=5.0)


def test_circles_beside_a_wall_lead_nowhere() -> None:
    run, laps = straight(1.5, y_m=-0.6), 5
    angle = np.linspace(0.0, -math.tau * laps, len(run.trajectory))
    x, y = 0.1 * np.sin(-angle), -0.6 + 0.1 * (np.cos(angle) - 1.0)
    track = replace(run.trajectory, x_m=x, y_m=y, heading_rad=angle)
    for options in ({}, {"wall_side": "right"}):
        rubric = task("band_m", band_low_m=0.1, band_high_m=0.6, **options)
        assert examine(rubric, replace(run, trajectory=track)).measures["band_m"].value < 0.05


def test_driving_and_floor_count_until_something_is_touched() -> None:
    touch = Contact(start_ns=4 * 10**9, end_ns=5 * 10**9, wall="box")
    free, touched = (
        examine(task("moving_s"), straight(1.5, contacts=each)).measures for each in ((), (touch,))
    )
    assert touched["moving_s"].value == pytest.approx(4.0, abs=0.05)
    assert touched["covered_pct"].value < free["covered_pct"].value


def along_bottom(*, heading_deg: float = 0.0, there_and_back: bool = False) -> Findings:
    """Return what is found of 1.5 m along the bottom wall, which is on the right of a robot that faces east."""
    run = straight(1.5, y_m=-0.6)
    track = run.trajectory
    if there_and_back:
        track = replace(track, x_m=np.abs(np.linspace(-0.75, 0.75, len(track))))
    track = replace(track, heading_rad=np.full(len(track), np.radians(heading_deg)))
    wanted = task("band_pct", band_low_m=0.25, band_high_m=0.45, wall_side="right")
    return examine(wanted, replace(run, trajectory=track))


def test_a_wall_is_followed_forwards_and_on_the_wanted_side() -> None:
    ahead, aslant, left = along_bottom(), along_bottom(heading_deg=-40.0), along_bottom(heading_deg=180.0)
    assert ahead.measures["band_pct"].value == pytest.approx(100.0)
    assert aslant.measures["band_pct"].value == pytest.approx(100.0)
    assert left.measures["band_pct"].value == left.measures["band_m"].value == 0.0
    both = along_bottom(there_and_back=True)
    assert both.measures["band_pct"].value == pytest.approx(50.0, abs=2.0)
    assert both.measures["band_m"].value == pytest.approx(0.0, abs=0.03)
    west = straight(1.5, y_m=0.6)
    wanted = task("band_pct", band_low_m=0.25, band_high_m=0.45, wall_side="right")
    assert examine(wanted, west).measures["band_pct"].value < 25.0  # the top wall is on its left
    assert problems(task("band_pct", wall_side="up"))[0][0] == "options.wall_side"


def test_the_floor_that_was_visited() -> None:
    found = examine(task("covered_pct"), straight(1.9, y_m=0.1)).measures
    # 8 of the row's 12 cells, of 12 by 8; those by the walls and round the post are left out
    cells = found["covered_pct"].value
    assert 5.0 < cells < 12.0
    more = examine(task("covered_pct"), straight(0.5)).measures
    assert more["covered_pct"].value < cells


@pytest.mark.parametrize(
    ("contact_s", "status", "ended_s", "code"),
    [(5.0, RunStatus.INTERRUPTED, 9.0, "room_hit")],
)
def test_what_was_hit_and_why(contact_s: float, status: RunStatus, ended_s: float, code: str) -> None:
    at = round(contact_s * 1e9)
    run = straight(1.9, moving=True, contacts=(Contact(start_ns=at, end_ns=at + 1, wall="box"),))
    run = replace(run, outcome=replace(run.outcome, status=status, duration_ns=round(ended_s * 1e9)))
    found = examine(task("contacts"), run)
    assert code in [each.code for each in found.mistakes]
    assert found.measures["clearance_m"].value == 0.0


@pytest.mark.parametrize(
    ("topic", "moved", "told"),
    [
        ("/joystick", False, True),
        ("/joystick", True, False),
        ("/camera/image", True, True),
        ("/scan", False, False),
    ],
)
def test_a_topic_that_a_drive_did_without_is_not_what_it_waits_for(
    topic: str, moved: bool, told: bool
) -> None:
    run = straight(0.5)
    heard = Endpoint(kind="subscription", node="/a", name=topic, type="std_msgs/msg/String")
    outcome = replace(run.outcome, status=RunStatus.INTERRUPTED, endpoints=(heard,), command_count=1)
    commands = (Command(0, 0.2 if moved else 0.0, 0.0),)
    run = replace(run, outcome=outcome, trajectory=replace(run.trajectory, commands=commands))
    found = robot_mistakes(run, task("contacts").world)
    assert ("topic_nowhere" in [each.code for each in found]) == told


def test_the_line_that_was_followed() -> None:
    assignment = task("line_pct", line_within_m=0.1)
    line = replace(ROOM, stripes=(Stripe(points_m=((0.0, 0.0), (1.0, 0.0))),))
    assignment = replace(assignment, world=replace(assignment.world, room=line))
    found = examine(assignment, straight(0.5, y_m=0.05)).measures
    assert found["line_pct"].value == 100.0
    assert found["line_covered_pct"].value == pytest.approx(58.0, abs=3.0)
    beside = examine(assignment, straight(0.5, y_m=0.2)).measures
    assert (beside["line_pct"].value, beside["line_covered_pct"].value) == (0.0, 0.0)
    past = examine(assignment, straight(1.9)).measures
    assert past["line_pct"].value == pytest.approx(100.0 * 1.1 / 1.9, abs=2.0)
    assert past["line_covered_pct"].value == 100.0


def test_pictures_show_the_room() -> None:
    assignment = task("ahead_m")
    with_line = replace(ROOM, stripes=(Stripe(points_m=((0.0, 0.0), (1.0, 0.0), (1.0, 1.0))),))
    assignment = replace(assignment, world=replace(assignment.world, room=with_line))
    kinds = [each.kind for each in sketch(assignment, straight(1.0)).solids]
    assert kinds == ["line", "line", "edge", "edge", "edge", "edge", "cylinder"]


def test_the_check_needs_a_robot_and_its_band() -> None:
    assert [field for field, _ in problems(task("band_pct"))] == ["items.0.measure"]
    turtle = replace(task("contacts"), world=World())
    assert "world" in [field for field, _ in problems(turtle)]
    assert problems(task("band_pct", band_low_m=-1.0, band_high_m=1.0)) != ()


def test_who_only_turns_is_told_to_drive() -> None:
    run = straight(0.0)
    turning = (Command(t_ns=10**9, v_mps=0.0, w_radps=0.2),)
    run = replace(run, trajectory=replace(run.trajectory, commands=turning))
    run = replace(run, outcome=replace(run.outcome, command_count=1))
    assert examine(task("ahead_m"), run).mistakes[0].code == "no_drive"
