"""Mistakes recognised from the shape of a polygon's motion, and from when it ended."""

import math
from dataclasses import replace

import pytest

from grader.checks import evaluate
from grader.contracts.outcome import Endpoint, RunStatus
from grader.contracts.scoring import Scoring
from grader.contracts.trajectory import Command, Contact, Trajectory
from tests.unit.checks.shipped import assignment, graded, score
from tests.unit.checks.trajectories import Leg, drive, once_each, polygon_legs, run_of


def test_much_curve_is_told_before_the_one_corner_it_spoils() -> None:
    rounded: list[Leg] = [(2.0, 1.0, 0.0), (math.pi / 2, 1.0, 1.0)]
    early: list[Leg] = [(2.0, 1.0, 0.0), (1.2, 1.0, 1.0)]
    scoring = graded("square", drive([*rounded, *rounded, *early, *rounded]))
    assert scoring.mistakes == ("kept_driving",)
    assert "linear.x was still 1" in scoring.hint.en
    little: list[Leg] = [(2.0, 1.0, 0.0), (math.pi / 2, 0.3, 1.0)]
    early = [(2.0, 1.0, 0.0), (1.2, 0.3, 1.0)]
    assert graded("square", drive([*little, *little, *early, *little])).mistakes[0] == "one_corner_off"


def test_published_once_is_told_before_the_angle_it_leads_to() -> None:
    scoring = graded("square", once_each([(2.0, 1.0, 0.0), (1.5708, 0.0, 1.0)] * 4))
    assert scoring.mistakes == ("published_once",)
    assert "2 s" in scoring.hint.en


@pytest.mark.parametrize(
    ("name", "legs", "code"),
    [
        ("triangle", [(2.0, 1.0, 0.0), (1.0, 0.0, math.pi / 3)] * 3, "interior_angle"),
        ("square", [(2.0, 1.0, 0.0), (0.5, 0.0, math.pi / 2)] * 4, "turns_too_short"),
        ("square", [(2.0, 1.0, 0.0), (1.0, 0.0, math.pi / 2)] * 3, "sides_missing"),
        ("square", [(3.0, 1.0, 0.0), (1.0, 0.0, math.pi / 2), (0.8, 1.0, 0.0), (1.0, 0.0, math.pi / 2)] * 2,
         "published_once"),
    ],
)  # fmt: skip
def test_drives_that_turtlesim_cuts_to_the_same_length_explain_no_figure(
    name: str, legs: list[tuple[float, float, float]], code: str
) -> None:
    assert graded(name, once_each(legs)).mistakes[0] == code


@pytest.mark.parametrize(
    ("name", "legs", "code"),
    [
        ("square", polygon_legs(4, corners_deg=[57.3] * 4), "one_radian"),
        ("triangle", polygon_legs(3, corners_deg=[57.3] * 3), "one_radian"),
        ("octagon", polygon_legs(8, 1.0, corners_deg=[57.3] * 8), "one_radian"),
        ("octagon", polygon_legs(8, 1.0, corners_deg=[54] * 8), "turns_too_far"),  # ticks of a 10 Hz timer
        ("triangle", polygon_legs(3, corners_deg=[60] * 3), "interior_angle"),
        ("pentagon", polygon_legs(5, corners_deg=[108] * 5), "interior_angle"),
        ("hexagon", polygon_legs(6, corners_deg=[120] * 6), "interior_angle"),
        ("square", polygon_legs(4, laps=0.75), "sides_missing"),
        ("square", polygon_legs(4, laps=1.25), "sides_extra"),
        ("square", polygon_legs(4, corners_deg=[97] * 4), "turns_too_far"),
        ("square", polygon_legs(4, corners_deg=[83] * 4), "turns_too_short"),
        ("square", polygon_legs(4, corners_deg=[90, 80, 90, 90]), "one_corner_off"),
        ("square", polygon_legs(4, corners_deg=[60, 120, 60, 120]), "one_corner_off"),  # not "0° too far"
        ("square", polygon_legs(4, lengths_m=[2, 2, 2, 1.7]), "unequal_sides"),
        ("square", polygon_legs(4, lengths_m=[3, 2, 3, 2]), "unequal_sides"),
        ("hexagon", polygon_legs(6, corners_deg=[57.3] * 6), "one_radian"),  # within the band of the corners
        ("square", polygon_legs(4, corners_deg=[90, 90, 90, 150] * 6, laps=6), "laps_apart"),
        ("square", polygon_legs(4, corners_deg=[90, -90, 90, -90]), "zigzag"),
        ("square", [(2.0, 1.0, 0.0), (math.pi / 2, 1.0, 1.0)] * 4, "kept_driving"),
        ("square", [(2.0, 1.0, 0.0), (math.pi / 2, 0.6, 1.0)] * 4, "arcs"),
        ("square", [(2 * math.pi, 1.0, 1.0)], "arcs"),
        ("square", [(2.0, 1.0, 0.2), (math.pi / 2 - 0.4, 0.0, 1.0)] * 4, "kept_turning"),  # bent sides
        ("square", [(2.0, 1.0, 0.0)], "no_turns"),
        ("square", [(2.0, 1.0, 0.0), *[(math.pi / 2, 0.0, 1.0), (0.016, 1.0, 0.0)] * 4], "turned_instead"),
        ("square", [(2.0, 1.0, 0.0), (1.0, 0.0, 90.0)] * 4, "degrees_as_radians"),
        ("square", polygon_legs(5), "other_figure"),
        ("triangle", polygon_legs(3, corners_deg=[-240] * 3), "long_way"),
        ("square", polygon_legs(4, corners_deg=[90, -270, 90, 90]), "long_way"),
    ],
)
def test_shapes(name: str, legs: list[tuple[float, float, float]], code: str) -> None:
    scoring = graded(name, drive(legs))
    assert scoring.mistakes[0] == code
    assert score(scoring) < 100


@pytest.mark.parametrize(
    ("name", "legs", "code"),
    [
        ("square", polygon_legs(4, laps=0.75), "sides_missing"),
        ("octagon", polygon_legs(8, 1.0, corners_deg=[54] * 8), "turns_too_far"),
    ],
)
def test_who_publishes_stop_until_the_horizon_had_time_enough(name: str, legs: list[Leg], code: str) -> None:
    scoring = graded(name, drive([*legs, (20.0, 0.0, 0.0)]), RunStatus.INTERRUPTED)
    assert scoring.mistakes == (code,)


def test_one_side_is_named_only_if_the_others_are_alike() -> None:
    one = graded("square", drive(polygon_legs(4, lengths_m=[2, 2, 1.5, 2]))).hint
    assert one.en.startswith("Side 3 is 1.5 m long, unlike the others")
    several = graded("square", drive(polygon_legs(4, lengths_m=[3, 2, 3, 2]))).hint
    assert several.en.startswith("The sides differ: the longest is 3 m long, the shortest 2 m")
    assert several.zh.startswith("各边不一样长：最长 3 m，最短 2 m")


def test_too_slow_and_never_ending() -> None:
    slow = drive(polygon_legs(4, v_mps=0.1), horizon_s=60.0)
    assert graded("square", slow, RunStatus.INTERRUPTED).mistakes[0] == "too_slow"
    spinning = drive([(2.0, 1.0, 0.0), (90.0, 0.0, 1.0)], horizon_s=60.0)
    assert graded("square", spinning, RunStatus.INTERRUPTED).mistakes[0] == "endless_turn"
    straying = drive([*polygon_legs(4), (60.0, 0.1, 0.0)], horizon_s=60.0)
    scoring = graded("square", straying, RunStatus.INTERRUPTED)
    assert scoring.mistakes == ("never_stops",)
    assert score(scoring) == 80  # nor is it back at the start


def test_turning_to_and_fro_for_ever_after_one_side_is_a_part_that_never_ends() -> None:
    swaying = drive([(2.0, 1.0, 0.0), *[(0.4, 0.0, 1.0), (0.4, 0.0, -1.0)] * 80], horizon_s=60.0)
    scoring = graded("square", swaying, RunStatus.INTERRUPTED)
    assert scoring.mistakes == ("never_finished",)
    assert "the sign of the error" in scoring.hint.en


def test_spinning_for_ever_after_the_figure_is_only_a_missing_stop() -> None:
    spinning = drive([*polygon_legs(4, last_turn=False), (60.0, 0.0, 1.0)], horizon_s=60.0)
    scoring = graded("square", spinning, RunStatus.INTERRUPTED)
    assert scoring.mistakes == ("never_stops",)
    assert score(scoring) == 95


@pytest.mark.parametrize("left_s", [0.2, 1.2, 1.9])
@pytest.mark.parametrize("name", ["square", "triangle"])
def test_who_is_cut_in_the_last_turn_or_side_is_not_told_to_stop(name: str, left_s: float) -> None:
    legs = polygon_legs({"square": 4, "triangle": 3}[name], pause_s=0.0)
    cut = drive(legs, horizon_s=sum(leg[0] for leg in legs) - left_s)
    scoring = graded(name, cut, RunStatus.INTERRUPTED)
    assert scoring.mistakes[0] == "time_was_up"
    assert "never_stops" not in scoring.mistakes
    assert graded(name, cut).mistakes[-1] == "never_stops"  # a script that ended by itself had its time


def test_who_leaves_the_stop_to_turtlesim_has_stopped() -> None:
    trajectory = drive(polygon_legs(4))
    values = {name: getattr(trajectory, name) for name in Trajectory.__slots__}
    moving = Command(t_ns=trajectory.commands[-1].t_ns + 1, v_mps=0.0, w_radps=1.0)
    coasting = Trajectory(**{**values, "commands": (*trajectory.commands, moving)})
    scoring = graded("square", coasting)
    assert (scoring.mistakes, score(scoring)) == ((), 100)


def test_a_car_that_slips_is_not_told_to_stop_turning() -> None:
    bent = drive([(2.0, 1.0, 0.25), (math.pi / 2 - 0.5, 0.0, 1.0)] * 4)
    commands = tuple(each._replace(w_radps=0.0) if each.v_mps else each for each in bent.commands)
    assert graded("square", bent).mistakes[0] == "kept_turning"
    task, run = assignment("square"), run_of(replace(bent, commands=commands))
    rough = replace(task, world=replace(task.world, profile="rough"))
    assert evaluate(rough, [run]).mistakes[0] == "slipped"


@pytest.mark.parametrize("cut_m", [0.15, 0.3])
def test_corners_cut_off_are_told_as_such(cut_m: float) -> None:
    half = (math.pi / 4, 0.0, 1.0)
    cut = graded("square", drive([(1.7, 1.0, 0.0), half, (cut_m, 1.0, 0.0), half] * 4))
    assert cut.mistakes == ("crooked",)
    assert 85 < score(cut) < 100


def test_a_corner_within_a_wider_band_is_no_mistake() -> None:
    """The bands of the rubric say what is wrong, no numbers besides."""
    legs = polygon_legs(4, corners_deg=[95, 90, 90, 90])
    assert "one_corner_off" in graded("square", drive(legs)).mistakes
    assert graded("feedback_square", drive(legs)).mistakes == ()
    scoring = graded(
        "feedback_square", drive(polygon_legs(4, corners_deg=[95, 90, 90, 90], lengths_m=[2.2, 2, 2, 2]))
    )
    assert scoring.mistakes == ("unequal_sides",)


BY_POSE = (
    "def tick(self):\n    d, h = pose.x - x0, pose.theta\n    if d < 2.0:\n        go()\n"
    "node.create_timer(0.1, node.tick)\n"
)
POSE = Endpoint(kind="subscription", name="/turtle1/pose", type="turtlesim/msg/Pose", node="/mover")


def by_pose(legs: list[Leg], *, contact_s: float | None = None, source: str = BY_POSE) -> Scoring:
    """Score a drive of a script that steers by the pose; it meets the top wall at `contact_s`."""
    trajectory = drive(legs)
    if contact_s is not None:
        hit_ns = int(contact_s * 1e9)
        trajectory = replace(trajectory, contacts=(Contact(wall="top", start_ns=hit_ns, end_ns=hit_ns + 1),))
    run = replace(run_of(trajectory, endpoints=(POSE,)), source=source)
    return evaluate(assignment("square"), [run])


@pytest.mark.parametrize(
    ("legs", "contact_s", "code"),
    [
        ([(4.0, 1.0, 0.0)], 3.9, "side_goes_on"),
        ([(2.0, 1.0, 0.0), (math.pi / 2, 0.0, 1.0), (4.0, 1.0, 0.0)], 7.5, "side_goes_on"),
        ([(4.0, 1.0, 0.0), (math.pi / 2, 0.0, 1.0), (4.0, 1.0, 0.0)], 9.5, "wall_hit"),  # all sides too long
    ],
)
def test_a_side_by_pose_that_only_a_wall_ended_is_told(legs: list[Leg], contact_s: float, code: str) -> None:
    scoring = by_pose(legs, contact_s=contact_s)
    assert scoring.mistakes[0] == code
    timed = drive(legs)
    hit = replace(timed, contacts=(Contact(wall="top", start_ns=int(contact_s * 1e9), end_ns=1 << 40),))
    assert "side_goes_on" not in graded("square", hit).mistakes


def test_little_turns_that_lead_into_a_wall_come_before_the_wall() -> None:
    legs: list[Leg] = [(2.0, 1.0, 0.0), (0.4, 0.0, 1.0)]
    scoring = by_pose([*legs, *legs, *legs], contact_s=6.0)
    assert scoring.mistakes[0] == "turns_too_short"
    assert "22.9°" in scoring.hint.en


def test_corners_are_no_matter_of_times_where_the_heading_may_end_the_turns() -> None:
    assert "ends by the heading" in by_pose(polygon_legs(4, corners_deg=[80.0] * 4)).hint.en


def test_one_side_that_was_corrected_on_its_way_is_one_side() -> None:
    corrected: list[Leg] = [(1.0, 1.0, 0.0), (0.2, 1.0, 0.2), (0.2, 1.0, -0.2), (0.6, 1.0, 0.0)]
    scoring = by_pose(corrected)
    assert scoring.mistakes[0] == "sides_missing"


def test_a_fast_turn_by_pose_is_neither_degrees_nor_endless() -> None:
    fast = by_pose([(2.0, 1.0, 0.0), (0.1, 0.0, 15.0), (2.0, 1.0, 0.0)])
    assert not {"degrees_as_radians", "endless_turn_by_pose"} & set(fast.mistakes)


def at_wall(legs: list[Leg], hit_s: float) -> Trajectory:
    hit_ns = round(hit_s * 1e9)
    return replace(drive(legs), contacts=(Contact(wall="right", start_ns=hit_ns, end_ns=hit_ns + 1),))


def test_a_turn_after_one_long_drive_to_the_wall_stands_behind_the_loop() -> None:
    legs: list[Leg] = [(8.0, 1.0, 0.0), (1.57, 0.0, 1.0), (5.0, 0.0, 0.0)]
    waiting = evaluate(assignment("square"), [run_of(at_wall(legs, 5.5), RunStatus.INTERRUPTED)])
    assert waiting.mistakes[0] == "turns_behind_loop"


def test_drives_that_end_at_once_are_told() -> None:
    assert graded("square", drive([(0.02, 1.0, 0.0), (1.57, 0.0, 1.0)] * 4)).mistakes[0] == "drives_too_brief"
    assert "drives_too_brief" not in graded("square", drive([(0.2, 1.0, 0.0), (1.57, 0.0, 1.0)] * 4)).mistakes


def test_tiny_corners_are_no_arcs_of_a_car_that_slips() -> None:
    tiny = drive([(0.2, 1.0, 0.0), (0.16, 0.0, 1.0)] * 4)
    assert graded("square", tiny).mistakes[0] == "turns_too_short"


@pytest.mark.parametrize(("over", "code"), [(True, "no_drive"), (False, "endless_turn")])
def test_a_script_that_never_drives_is_told_to_drive(over: bool, code: str) -> None:
    """A turn that lasts to the end of the run may be all that kept it from driving."""
    turning, status = drive([(14.0, 0.0, 1.0), (0.2, 0.0, 0.0)]), RunStatus.FINISHED
    if not over:
        turning = replace(turning, commands=tuple(one for one in turning.commands if one.w_radps))
        status = RunStatus.INTERRUPTED
    assert evaluate(assignment("square"), [run_of(turning, status)]).mistakes[0] == code


def test_sides_that_were_backed_in_turn_are_told_before_the_corners_they_draw() -> None:
    legs: list[Leg] = [
        (2.0, 1.0, 0.0),
        (2.0944, 0.0, 1.0),
        (2.0, -1.0, 0.0),
        (2.0944, 0.0, 1.0),
        (2.0, 1.0, 0.0),
    ]
    assert graded("triangle", drive(legs)).mistakes[0] == "to_and_fro"
    assert "to_and_fro" not in graded("triangle", drive([(2.0, 1.0, 0.0), (1.05, 0.0, 1.0)] * 3)).mistakes
