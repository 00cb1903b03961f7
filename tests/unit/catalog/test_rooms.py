"""A robot's room in ``assignment.yaml``: what is read, what is drawn by seed, what is refused."""

import re
from pathlib import Path

import pytest

from grader.catalog import Catalog, set_root
from grader.contracts.errors import AssignmentError
from tests.unit.catalog.test_catalog import GOOD, write

ROBOT_CHECKLIST = ["stop_before_wall", "follow_wall", "three_goals", "avoid_obstacles", "maze", "follow_line"]

ROOM = (
    GOOD
    + """\
world:
  kind: robot
  room:
    bounds: [-1, -1.5, [2.5, 3], 1.5]
    walls: [{from: [1, -1.5], to: [1, -0.9]}]
    boxes: [{at: [[1.4, 2.2], [-1, 1]], size: [0.2, 0.3], heading_deg: [0, 90]}]
    cylinders: [{at: [-0.6, 1.1], radius: 0.1}]
    ramps: [{at: [0.5, 1], size: [0.5, 0.5], height_m: 0.05}]
    lines: [{points: [[0, 0], [1, 0]]}]
cases: [{id: a, seed: 1}, {id: b, seed: 2}, {id: c, seed: 1}]
"""
)


def test_the_robots_set_in_order() -> None:
    assert [each.id for each in Catalog(set_root("robot")).all()] == ROBOT_CHECKLIST


@pytest.mark.parametrize("name", ROBOT_CHECKLIST)
def test_every_assignment_of_the_robots_set_is_complete(name: str) -> None:
    catalog = Catalog()
    assignment, attempts = catalog.get(name), catalog.wrong_attempts(name)
    assert assignment.max_score == 100
    assert assignment.world.kind == "robot"
    assert catalog.own_file(assignment, "starter").is_file()
    assert catalog.own_file(assignment, "solution").is_file()
    assert len(attempts) >= 5
    files = {path.name for path in catalog.folder(name).glob("wrong/*")}
    assert {each.file for each in attempts} == files | set(catalog.changed_scripts(name))
    assert all(attempt.high < 100 for attempt in attempts)
    assert name not in {each.id for each in catalog.all()}


def test_further_sets_are_guessed_last() -> None:
    assert Catalog().guess_assignment("stop_before_wall.py") == "stop_before_wall"


def test_a_room_is_read_and_drawn_for_each_case(tmp_path: Path) -> None:
    assignment = write(tmp_path, ROOM).get("demo")
    assert (assignment.world.cmd_vel_topic, assignment.world.start.x_m) == ("/cmd_vel", 0.0)
    one, other, _ = (assignment.in_case(case.id).world.room for case in assignment.cases)
    assert one is not None
    assert other is not None
    assert one != other
    assert assignment.world.room == one
    assert [each.kind for each in one.solids] == ["edge"] * 4 + ["wall", "box", "cylinder", "ramp"]
    assert 2.5 <= one.right_m <= 3.0
    assert (one.solids[4].length_m, one.solids[4].heading_deg) == (pytest.approx(0.65), 90.0)
    assert 1.4 <= one.solids[5].x_m <= 2.2
    assert one.stripes[0].points_m == ((0.0, 0.0), (1.0, 0.0))
    assert Catalog(tmp_path).get("demo") == assignment


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("kind: robot", "kind: turtle", "world.room: only a robot has it"),
        ("kind: robot", "kind: robot\n  walls: false", "world.walls: a robot does not take it"),
        ("kind: robot", "kind: robot\n  topics: {/pose: /p}", "a robot has no topic '/pose'; it has: /odom"),
        ("[-1, -1.5, [2.5, 3], 1.5]", "[-1, -1.5, -0.9, 1.5]", "world.room.bounds: write [left, bottom"),
        ("to: [1, -0.9]", "to: [1, -1.5]", "world.room.walls.0.to: both ends are the same"),
        ("[[1.4, 2.2], [-1, 1]]", "[[-0.1, 0.1], 0]", "world.room.boxes.0: in 200 draws"),
        ("[-1, -1.5, [2.5, 3], 1.5]", "[0.5, -1.5, 3, 1.5]", "world.room.bounds: the robot's start"),
        ("[-1, -1.5, [2.5, 3], 1.5]", "[-0.05, -1.5, 3, 1.5]", "world.room.bounds: the robot's start"),
        ("to: [1, -0.9]", "too: [1, -0.9]", "world.room.walls.0.too: unknown field; did you mean to?"),
        ("at: [-0.6, 1.1]", "at: [0, 0.1]", "world.room.cylinders.0: in 200 draws"),
        ("[[0, 0], [1, 0]]", "[[no, 0], [1, 0]]", "world.room.lines.0.points: write a number"),
        ("radius: 0.1", "radius: 0.1, colour: red", "world.room.cylinders.0.colour: unknown field"),
    ],
)
def test_a_room_that_cannot_be_is_refused(tmp_path: Path, old: str, new: str, words: str) -> None:
    assert old in ROOM
    with pytest.raises(AssignmentError, match=re.escape(words)):
        write(tmp_path, ROOM.replace(old, new)).get("demo")
