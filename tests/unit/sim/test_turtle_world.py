"""turtlesim's services and its action, as the script meets them."""

import math

import numpy as np
import pytest

from grader.contracts.assignment import WINDOW_M, World
from grader.contracts.trajectory import Trajectory
from grader.sim.driving import Car
from grader.sim.episode import Episode, EpisodeSpec
from tests.fakes import jail
from tests.fakes.jail import SECOND, FakeLink, Script
from tests.unit.sim.student import Student, run

MS = 1_000_000
TICK = 16 * MS
CENTRE = WINDOW_M / 2.0


def test_a_teleport_is_served_at_the_next_tick_and_is_a_jump(car: Car) -> None:
    student = Student()

    def story() -> Script:
        yield from student.wait(20 * MS)
        assert (yield from student.call("/turtle1/teleport_absolute", x=1.0, y=2.0, theta=math.pi / 2)) == {}
        assert student.now == 2 * TICK
        yield from student.drive(1.0)
        yield from student.wait(SECOND)

    path = run(car, student, story()).trajectory
    (jump,) = path.jumps
    assert (path.x_m[jump], path.y_m[jump]) == (1.0, 2.0)
    assert path.t_ns[jump] - path.t_ns[jump - 1] == 1
    assert path.t_ns[jump] == TICK + 1  # the update of 2 * TICK goes on from there
    assert (path.x_m[jump - 1], path.y_m[jump - 1]) == (CENTRE, CENTRE)
    assert (np.diff(path.t_ns) > 0).all()
    assert path.x_m[-1] == pytest.approx(1.0, abs=1e-3)
    assert path.y_m[-1] == pytest.approx(3.0, abs=0.02)


def test_a_teleport_keeps_the_velocity(car: Car) -> None:
    student = Student()

    def story() -> Script:
        yield from student.drive(1.0)
        yield from student.wait(SECOND // 2)
        yield from student.call("/turtle1/teleport_absolute", x=1.0, y=1.0, theta=0.0)
        yield from student.wait(2 * SECOND)

    path = run(car, student, story()).trajectory
    (jump,) = path.jumps
    assert path.v_mps[jump] == pytest.approx(1.0, abs=1e-3)
    assert path.x_m[-1] == pytest.approx(1.0 + 0.5, abs=0.03)


def test_teleport_relative_turns_first_and_stays_in_the_window(car: Car) -> None:
    student = Student()

    def story() -> Script:
        yield from student.call("/turtle1/teleport_relative", linear=2.0, angular=math.pi / 2)
        yield from student.call("/turtle1/teleport_relative", linear=100.0, angular=0.0)
        yield from student.call("/turtle1/teleport_relative", linear=math.nan, angular=0.0)

    path = run(car, student, story()).trajectory
    first, second = path.jumps
    assert (path.x_m[first], path.y_m[first]) == pytest.approx((CENTRE, CENTRE + 2.0), abs=1e-6)
    assert path.heading_rad[first] == pytest.approx(math.pi / 2, abs=1e-6)
    assert path.y_m[second] == WINDOW_M


def test_reset_puts_the_turtle_back_at_rest(car: Car) -> None:
    student = Student()

    def story() -> Script:
        yield from student.drive(1.0, 1.0)
        yield from student.wait(SECOND // 2)
        yield from student.call("/reset")
        yield from student.wait(SECOND)

    path = run(car, student, story(), heading_deg=45.0).trajectory
    assert len(path.jumps) == 1
    assert (path.x_m[-1], path.y_m[-1]) == (CENTRE, CENTRE)
    assert path.heading_rad[-1] == pytest.approx(math.pi / 4, abs=1e-9)
    assert path.v_mps[-1] == 0.0


def test_spawn_names_turtles_and_refuses_what_exists(car: Car) -> None:
    student = Student()

    def story() -> Script:
        assert (yield from student.call("/spawn", x=1.0, y=1.0)) == {"name": "turtle2"}
        assert (yield from student.call("/spawn", x=1.0, y=1.0, name="bob")) == {"name": "bob"}
        assert (yield from student.call("/spawn", x=1.0, y=1.0, name="bob")) == {"name": ""}
        assert (yield from student.call("/spawn", x=1.0, y=1.0, name="turtle1")) == {"name": ""}
        assert (yield from student.call("/kill", name="bob")) == {}
        assert (yield from student.call("/kill", name="nobody")) == {}
        assert (yield from student.call("/spawn", x=2.0, y=2.0, name="bob")) == {"name": "bob"}
        assert (yield from student.call("/clear")) == {}

    assert run(car, student, story()).trajectory.jumps == ()


def test_a_number_is_given_once_until_the_next_reset(car: Car) -> None:
    student = Student()

    def story() -> Script:
        assert (yield from student.call("/spawn", x=1.0, y=1.0)) == {"name": "turtle2"}
        assert (yield from student.call("/spawn", x=1.0, y=1.0, name="turtle3")) == {"name": "turtle3"}
        assert (yield from student.call("/kill", name="turtle2")) == {}
        assert (yield from student.call("/kill", name="turtle1")) == {}
        assert (yield from student.call("/spawn", x=1.0, y=1.0)) == {"name": "turtle4"}
        assert (yield from student.call("/reset")) == {}
        assert (yield from student.call("/spawn", x=1.0, y=1.0)) == {"name": "turtle2"}

    run(car, student, story())


def test_a_killed_turtle_obeys_and_says_nothing(car: Car) -> None:
    student = Student()

    def story() -> Script:
        yield from student.subscribe("/turtle1/pose", "turtlesim/msg/Pose")
        yield from student.drive(1.0)
        yield from student.wait(SECOND // 2)
        yield from student.call("/kill", name="turtle1")
        killed = student.now
        yield from student.drive(1.0)
        yield from student.wait(SECOND)
        assert student.messages("/turtle1/pose", "turtlesim/msg/Pose")[-1][0] <= killed
        yield from student.call("/spawn", x=3.0, y=3.0, theta=1.0, name="turtle1")
        yield from student.drive(0.0, 1.0)
        yield from student.wait(2 * SECOND)

    result = run(car, student, story())
    path = result.trajectory
    (jump,) = path.jumps
    assert path.x_m[jump - 1] == pytest.approx(CENTRE + 0.5, abs=0.03)
    assert path.heading_rad[-1] == pytest.approx(2.0, abs=0.03)
    assert result.command_count == 3


def test_the_colour_sensor_sees_background_and_then_the_line(car: Car) -> None:
    student = Student()

    def story() -> Script:
        yield from student.subscribe("/turtle1/color_sensor", "turtlesim/msg/Color")
        yield from student.call("/turtle1/set_pen", r=255, g=1, b=2, width=3, off=0)
        yield from student.drive(1.0)
        yield from student.wait(SECOND)

    run(car, student, story())
    colors = [color for _, color in student.messages("/turtle1/color_sensor", "turtlesim/msg/Color")]
    assert colors[0] == {"r": 255, "g": 255, "b": 255}
    assert colors[-1] == {"r": 255, "g": 1, "b": 2}


def test_a_turtle_that_is_spawned_again_has_a_new_pen_on_blank_ground(car: Car) -> None:
    student = Student()

    def story() -> Script:
        yield from student.subscribe("/turtle1/color_sensor", "turtlesim/msg/Color")
        yield from student.call("/turtle1/set_pen", r=255, g=1, b=2, width=3, off=0)
        yield from student.drive(1.0)
        yield from student.wait(SECOND)
        yield from student.call("/kill", name="turtle1")
        yield from student.call("/spawn", x=3.0, y=3.0, name="turtle1")
        yield from student.wait(2 * SECOND)
        colors.append(student.messages("/turtle1/color_sensor", "turtlesim/msg/Color")[-1][1])
        yield from student.drive(1.0)
        yield from student.wait(3 * SECOND)

    colors: list[dict[str, int]] = []
    run(car, student, story())
    colors.append(student.messages("/turtle1/color_sensor", "turtlesim/msg/Color")[-1][1])
    assert colors == [{"r": 255, "g": 255, "b": 255}, {"r": 179, "g": 184, "b": 255}]


def test_odometry_does_not_see_a_teleport(car: Car) -> None:
    student = Student()

    def story() -> Script:
        yield from student.subscribe("/odom", "nav_msgs/msg/Odometry")
        yield from student.drive(1.0)
        yield from student.wait(SECOND // 2)
        yield from student.call("/turtle1/teleport_absolute", x=1.0, y=9.0, theta=-1.0)
        yield from student.wait(2 * SECOND)

    run(car, student, story(), heading_deg=30.0)
    positions = [
        odom["pose"]["pose"]["position"] for _, odom in student.messages("/odom", "nav_msgs/msg/Odometry")
    ]
    assert positions[-1]["x"] == pytest.approx(1.0, abs=0.01)
    assert max(abs(position["y"]) for position in positions) < 1e-6
    assert max(np.diff([position["x"] for position in positions])) < 0.03


def test_too_many_requests_are_noted_not_kept(car: Car) -> None:
    student = Student()

    def story() -> Script:
        for _ in range(1_100):
            yield from student.ask("/clear")
        answers = 0
        while answers < 1_000:  # one in each update
            answer = yield jail.advance(20 * SECOND)
            assert answer is not None
            student.now = answer.now_ns
            answers += len(answer.events)
        assert student.now == 1_000 * TICK

    notes = run(car, student, story()).notes
    assert [note.code for note in notes] == ["too_many_requests"]


def test_a_service_serves_one_request_in_an_update(car: Car) -> None:
    student = Student()

    def story() -> Script:
        for x in range(1, 6):
            yield from student.ask("/turtle1/teleport_absolute", x=float(x), y=5.0, theta=0.0)
        yield from student.wait(SECOND)

    path = run(car, student, story()).trajectory
    assert [(path.t_ns[jump] - 1) // TICK for jump in path.jumps] == [0, 1, 2, 3, 4]
    assert [path.x_m[jump] for jump in path.jumps] == [1.0, 2.0, 3.0, 4.0, 5.0]


def test_a_request_is_served_although_the_script_does_not_wait(car: Car) -> None:
    student = Student()

    def story() -> Script:
        yield from student.ask("/turtle1/teleport_absolute", x=1.0, y=1.0, theta=0.0)

    assert run(car, student, story()).trajectory.x_m[-1] == 1.0


def test_a_malformed_request_is_a_violation(car: Car) -> None:
    frames = [jail.node(), jail.entity(5, 5, name="/spawn", type="turtlesim/srv/Spawn")]
    frames += [jail.request(5, 1, 0, b"\0\1\0\0junk"), jail.advance(SECOND)]
    spec = EpisodeSpec(world=World(), horizon_ns=SECOND, source=b"", file_name="a.py")
    result = Episode(spec, car).run(FakeLink(frames))
    assert result.violation is not None
    assert "Spawn_Request" in result.violation


def test_a_teleport_beyond_all_measure_ends_far_away(car: Car) -> None:
    student = Student()

    def story() -> Script:
        yield from student.subscribe("/turtle1/pose", "turtlesim/msg/Pose")
        for _ in range(2):
            yield from student.call("/turtle1/teleport_relative", linear=3e38, angular=0.0)
        yield from student.call("/turtle1/teleport_absolute", x=math.inf, y=0.0, theta=0.0)
        yield from student.wait(SECOND // 2)

    path = run(car, student, story(), walls=False).trajectory
    assert len(path.jumps) == 3
    assert path.x_m[-1] == 1e6
    assert student.messages("/turtle1/pose", "turtlesim/msg/Pose")[-1][1]["x"] == 1e6


def poses_after(car: Car, **target: float) -> tuple[list[dict[str, float]], Trajectory]:
    """Drive at 1 m/s, teleport, and return the poses from then on, and what was recorded."""
    student = Student()
    jumped_ns = 0

    def story() -> Script:
        nonlocal jumped_ns
        yield from student.subscribe("/turtle1/pose", "turtlesim/msg/Pose")
        yield from student.drive(1.0)
        yield from student.wait(100 * MS)
        yield from student.call("/turtle1/teleport_absolute", **target)
        jumped_ns = student.now
        yield from student.wait(2 * SECOND)

    path = run(car, student, story()).trajectory
    heard = student.messages("/turtle1/pose", "turtlesim/msg/Pose")
    return [pose for t_ns, pose in heard if t_ns >= jumped_ns], path


@pytest.mark.parametrize(
    ("target", "x", "y"),
    [
        ({"x": math.nan, "y": 5.0, "theta": 0.0}, math.nan, 5.0),
        ({"x": 5.0, "y": math.nan, "theta": 0.0}, 5.016, WINDOW_M),
        ({"x": 5.0, "y": 5.0, "theta": math.inf}, math.nan, math.nan),
        ({"x": math.inf, "y": -math.inf, "theta": 0.0}, WINDOW_M, 0.0),
    ],
)
def test_a_teleport_to_no_number_is_kept(car: Car, target: dict[str, float], x: float, y: float) -> None:
    poses, path = poses_after(car, **target)
    assert (poses[0]["x"], poses[0]["y"]) == pytest.approx((x, y), abs=1e-6, nan_ok=True)
    assert np.isfinite((path.x_m, path.y_m, path.heading_rad, path.v_mps, path.w_radps)).all()
    assert len(path.jumps) == (not math.isnan(x))  # nobody can say where a turtle without a place is


def test_a_turtle_without_a_place_can_be_given_one(car: Car) -> None:
    student = Student()

    def story() -> Script:
        yield from student.call("/turtle1/teleport_absolute", x=math.nan, y=5.0, theta=0.0)
        yield from student.drive(1.0)
        yield from student.wait(SECOND // 2)
        yield from student.call("/turtle1/teleport_absolute", x=1.0, y=2.0, theta=0.0)
        yield from student.wait(2 * SECOND)

    path = run(car, student, story()).trajectory
    (jump,) = path.jumps
    assert (path.x_m[jump], path.y_m[jump]) == (1.0, 2.0)
    assert path.x_m[-1] == pytest.approx(1.5, abs=0.05)  # the second that a command acts went on


def test_a_turtle_put_outside_moves_before_the_window_holds_it(car: Car) -> None:
    poses, path = poses_after(car, x=-0.01, y=13.0, theta=0.0)
    assert (poses[0]["x"], poses[0]["y"]) == pytest.approx((0.006, WINDOW_M), abs=1e-6)
    assert path.x_m[path.jumps[0]] == 0.0


def test_what_was_commanded_begins_where_a_teleport_put_the_turtle(car: Car) -> None:
    student = Student()

    def story() -> Script:
        yield from student.call("/turtle1/teleport_absolute", x=1.0, y=2.0, theta=math.pi / 2)
        for _ in range(100):
            yield from student.drive(1.0)
            yield from student.wait(student.now + 10 * MS)
        yield from student.drive(0.0)
        yield from student.wait(3 * SECOND)

    path = run(car, student, story()).trajectory
    assert path.commanded is not None
    assert path.commanded.x_m[-1] == pytest.approx(1.0)
    assert path.commanded.y_m[-1] == pytest.approx(3.0, abs=0.017)
    assert path.y_m[-1] == pytest.approx(3.1, abs=0.017)
