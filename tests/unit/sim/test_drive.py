"""What the car does in PyBullet's world, and turtlesim's walls. How it moves exactly: `test_turtlesim`."""

import math
import subprocess
import sys
from collections.abc import Sequence

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from grader.contracts.assignment import WINDOW_M
from grader.contracts.errors import InfrastructureError
from grader.contracts.trajectory import Trajectory
from grader.sim.car import UPDATE_NS, UPDATE_S
from grader.sim.driving import Car
from grader.sim.recorder import Recorder
from tests.examples import examples

Segment = tuple[float, float, float]
CENTRE = WINDOW_M / 2.0


def drive(
    car: Car,
    segments: Sequence[Segment],
    *,
    heading_deg: float = 0.0,
    walls: bool = False,
    profile: str = "nominal",
    seed: int = 0,
) -> Trajectory:
    """Hold each (seconds, v, w), then stop and let the car come to rest."""
    recorder = Recorder()
    start = (CENTRE, CENTRE, math.radians(heading_deg))
    car.reset(recorder, start, profile=profile, walls=walls, seed=seed)  # type: ignore[arg-type]
    t = 0.0
    for seconds, v, w in segments:
        car.advance(round(t * 1e9))
        car.command(v, w)
        t += seconds
    car.advance(round(t * 1e9))
    car.command(0.0, 0.0)
    car.advance(car.now_ns + 3_000_000_000)
    car.observe()
    return recorder.finish(car.now_ns)


def moved(path: Trajectory) -> tuple[float, float]:
    """Displacement along and across the initial heading."""
    dx, dy = path.x_m[-1] - path.x_m[0], path.y_m[-1] - path.y_m[0]
    c, s = math.cos(path.heading_rad[0]), math.sin(path.heading_rad[0])
    return float(dx * c + dy * s), float(dy * c - dx * s)


def turned_deg(path: Trajectory) -> float:
    return math.degrees(float(path.heading_rad[-1] - path.heading_rad[0]))


def whole_updates(seconds: float) -> float:
    """The lesson's times, as turtlesim rounds them: a command lasts whole updates."""
    return round(seconds / UPDATE_S) * UPDATE_S


@pytest.mark.parametrize("v", [0.05, 1.0, 3.0, -1.0])
@pytest.mark.parametrize("w", [0.0, -1.0, 2.0 * math.pi])
def test_speeds_are_held_from_the_first_update_on(car: Car, v: float, w: float) -> None:
    path = drive(car, [(2.0, v, w)])
    held = (path.t_ns > 0) & (path.t_ns <= 2_000_000_000)
    assert set(path.v_mps[held]) == {v}
    assert set(path.w_radps[held]) == {w}
    assert path.v_mps[-1] == path.w_radps[-1] == 0.0


def test_twenty_seconds_straight_do_not_drift(car: Car) -> None:
    path = drive(car, [(20.0, 1.0, 0.0)], heading_deg=84.0)
    along, across = moved(path)
    assert along == pytest.approx(20.0, abs=1e-9)
    assert abs(across) < 1e-9
    assert not np.ptp(path.heading_rad)


@pytest.mark.parametrize("w", [1.0, -2.0 * math.pi])
def test_turns_in_place_stay_in_place(car: Car, w: float) -> None:
    path = drive(car, [(20.0, 0.0, w)])
    assert turned_deg(path) == pytest.approx(math.degrees(20.0 * w), abs=1e-3)
    assert np.ptp(path.x_m) == np.ptp(path.y_m) == 0.0


@settings(max_examples=examples(25))
@given(
    st.lists(
        st.tuples(st.floats(0.02, 1.5), st.floats(-10.0, 10.0), st.floats(-10.0, 10.0)),
        min_size=1,
        max_size=6,
    )
)
def test_the_body_is_where_the_law_says(car: Car, segments: list[Segment]) -> None:
    drive(car, segments, walls=True)
    x, y, heading = car.body_pose
    assert (x, y) == pytest.approx(car.pose[:2], abs=1e-6)
    assert math.remainder(heading - car.pose[2], math.tau) == pytest.approx(
        0.0, abs=1e-4
    )  # quick wheels are gyroscopes


def test_a_body_that_leaves_its_course_is_a_fault(car: Car, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("pybullet")
    monkeypatch.setattr("grader.sim.bullet._step_once", lambda client: None)
    with pytest.raises(InfrastructureError, match="body is not where its law says"):
        drive(car, [(1.0, 1.0, 0.0)])


@pytest.mark.parametrize("heading_deg", [0.0, 30.0, 45.0, 84.0, 90.0, 200.0])
@pytest.mark.parametrize(("v", "w"), [(1.0, 1.0), (2.0, 3.0)])
def test_the_lessons_square_closes(car: Car, heading_deg: float, v: float, w: float) -> None:
    side, corner, pause = (2.0 / v, v, 0.0), (1.5708 / w, 0.0, w), (0.1, 0.0, 0.0)
    path = drive(car, [(1.0, 0.0, 0.0), *[side, pause, corner, pause] * 4], heading_deg=heading_deg)
    # An update is 16 ms: 0.9 degrees at 1 rad/s and 2.8 at 3, in each corner by as much as it is begun too late.
    assert math.hypot(*moved(path)) < 0.05 * w
    assert turned_deg(path) == pytest.approx(360.0, abs=4.0 * w)
    assert np.ptp(path.x_m) > 1.9


def test_a_circle_closes_on_itself(car: Car) -> None:
    path = drive(car, [(whole_updates(2.0 * math.pi), 1.0, 1.0)])
    assert math.hypot(*moved(path)) < 0.016
    assert np.ptp(path.x_m) == pytest.approx(2.0, rel=1e-3)


def test_huge_commands_stay_within_numbers(car: Car) -> None:
    path = drive(car, [(1.0, 100.0, 100.0), (1.0, -100.0, -100.0), (0.01, 100.0, -100.0)])
    for column in (path.x_m, path.y_m, path.heading_rad, path.v_mps, path.w_radps):
        assert np.isfinite(column).all()
    assert np.abs(path.v_mps).max() <= 100.0 * (1 + 1e-6)
    assert path.v_mps[-1] == 0.0
    # 16 ms between samples at 100 rad/s: the heading is followed through all its turns.
    assert np.ptp(path.heading_rad) > 90.0


def test_a_wall_stops_what_runs_into_it_squarely(car: Car) -> None:
    path = drive(car, [(8.0, 1.0, 0.0)], walls=True)
    assert path.x_m.max() == path.x_m[-1] == pytest.approx(WINDOW_M, abs=1e-12)
    assert np.ptp(path.y_m) < 1e-9
    assert abs(turned_deg(path)) < 1e-9
    (contact,) = path.contacts
    assert contact.wall == "right"
    assert contact.start_ns / 1e9 == pytest.approx(WINDOW_M - CENTRE, abs=0.03)
    assert contact.end_ns / 1e9 == pytest.approx(8.0, abs=0.2)
    pushing = (path.t_ns > 6_000_000_000) & (path.t_ns < 8_000_000_000)
    assert np.abs(path.v_mps[pushing]).max() < 1e-9


def test_a_car_slides_along_a_wall_without_turning(car: Car) -> None:
    path = drive(car, [(7.0, 1.0, 0.0)], walls=True, heading_deg=60.0)
    # turtlesim clamps y and leaves x alone: it goes on at cos(60 degrees).
    assert path.y_m[-1] == pytest.approx(WINDOW_M, abs=1e-12)
    assert path.x_m[-1] - CENTRE == pytest.approx(437 * 0.016 * 0.5)  # whole updates within 7 s
    assert abs(turned_deg(path)) < 1e-6
    assert [contact.wall for contact in path.contacts] == ["top"]
    sliding = (path.t_ns > 6_600_000_000) & (path.t_ns < 7_000_000_000)
    assert path.v_mps[sliding] == pytest.approx(np.full(sliding.sum(), 0.25), abs=1e-6)


@pytest.mark.parametrize(("heading_deg", "walls"), [(45.0, {"right", "top"}), (225.0, {"left", "bottom"})])
def test_a_corner_is_two_walls(car: Car, heading_deg: float, walls: set[str]) -> None:
    path = drive(car, [(12.0, 1.0, 0.0)], walls=True, heading_deg=heading_deg)
    assert {contact.wall for contact in path.contacts} == walls


@settings(max_examples=examples(15))
@given(st.lists(st.tuples(st.floats(0.1, 2.0), st.floats(-30.0, 30.0), st.floats(-5.0, 5.0)), max_size=5))
def test_walls_hold(car: Car, segments: list[Segment]) -> None:
    path = drive(car, segments, walls=True)
    for column in (path.x_m, path.y_m):
        assert column.min() >= 0.0
        assert column.max() <= WINDOW_M
    for contact in path.contacts:
        assert contact.start_ns <= contact.end_ns


def test_leaving_a_wall_ends_the_contact_and_coming_back_is_a_new_one(car: Car) -> None:
    path = drive(car, [(4.0, 2.0, 0.0), (1.0, -2.0, 0.0), (2.0, 2.0, 0.0)], walls=True)
    assert [contact.wall for contact in path.contacts] == ["right", "right"]
    assert path.contacts[0].end_ns < path.contacts[1].start_ns


def test_an_open_world_has_no_walls(car: Car) -> None:
    path = drive(car, [(10.0, 3.0, 0.0)])
    assert path.x_m[-1] == pytest.approx(CENTRE + 30.0, abs=1e-3)
    assert path.contacts == ()


@pytest.mark.parametrize("profile", ["nominal", "rough"])
def test_an_episode_does_not_notice_those_before_it(car: Car, profile: str) -> None:
    segments = [(1.0, 1.0, 0.4), (0.3, 0.0, 0.0), (1.0, -2.0, 3.0)]
    fresh = Car()
    first = drive(fresh, segments, profile=profile, walls=True, seed=5)
    for _ in range(2):
        drive(fresh, [(1.0, 100.0, -77.0)], heading_deg=33.0, walls=True)
        drive(fresh, [(0.5, 0.7, 0.0)], profile="rough", seed=1)
        again = drive(fresh, segments, profile=profile, walls=True, seed=5)
        elsewhere = drive(car, segments, profile=profile, walls=True, seed=5)
        for other in (again, elsewhere):
            for name in ("t_ns", "x_m", "y_m", "heading_rad", "v_mps", "w_radps"):
                assert getattr(other, name).tobytes() == getattr(first, name).tobytes()
    fresh.close()


def test_two_cars_at_once_do_not_meet(car: Car) -> None:
    alone = drive(car, [(1.0, 1.0, 1.0)])
    other = Car()
    recorder = Recorder()
    other.reset(recorder, (CENTRE, CENTRE, 0.0), profile="nominal", walls=True, seed=0)
    other.command(2.0, -1.0)
    other.advance(400_000_000)
    together = drive(car, [(1.0, 1.0, 1.0)])
    other.advance(800_000_000)
    other.close()
    assert together.x_m.tobytes() == alone.x_m.tobytes()


def test_the_rough_car_needs_feedback(car: Car) -> None:
    pytest.importorskip("pybullet")
    path = drive(car, [(8.0, 1.0, 0.0)], profile="rough", seed=1)
    assert abs(turned_deg(path)) > 2.0
    assert moved(path)[0] > 2.0
    assert path.v_mps[-1] == 0.0


def test_samples_are_an_update_apart_and_increase(car: Car) -> None:
    path = drive(car, [(1.0, 1.0, 0.5), (0.5, 0.0, 0.0), (1.0, 0.0, 2.0)])
    gaps = np.diff(path.t_ns)
    assert (gaps > 0).all()
    moving = np.abs(path.v_mps[1:]) + np.abs(path.w_radps[1:]) > 0
    assert gaps[moving].max() <= UPDATE_NS
    for index in np.flatnonzero(gaps > UPDATE_NS):
        assert path.x_m[index] == path.x_m[index + 1]
        assert path.heading_rad[index] == path.heading_rad[index + 1]


def test_importing_the_engine_prints_nothing() -> None:
    pytest.importorskip("pybullet")
    code = "import grader.sim.bullet; print('mine')"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert (done.stdout, done.stderr) == ("mine\n", "")
