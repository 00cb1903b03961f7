import math
import xml.etree.ElementTree as ElementTree

import pytest
from hypothesis import given
from hypothesis import strategies as st

from grader.sim.car import (
    MAX_SPEED_MPS,
    MAX_YAW_RATE_RADPS,
    PROFILES,
    RIDE_HEIGHT_M,
    TRACK_M,
    URDF,
    WHEEL_RADIUS_M,
    Servo,
    clamp_command,
    make_servo,
    twist_to_wheels,
    wheels_to_twist,
)
from grader.sim.timeline import STEP_S

ORDINARY_V = st.floats(-3.0, 3.0)
ORDINARY_W = st.floats(-2.0 * math.pi, 2.0 * math.pi)
ANY = st.floats(allow_nan=True, allow_infinity=True)


@given(ORDINARY_V, ORDINARY_W)
def test_wheels_and_twist_are_inverse(v: float, w: float) -> None:
    assert wheels_to_twist(*twist_to_wheels(v, w)) == pytest.approx((v, w), abs=1e-12)


def test_a_left_turn_turns_the_right_wheel_faster() -> None:
    left, right = twist_to_wheels(0.0, 1.0)
    assert left == -right
    assert right == pytest.approx(TRACK_M / 2 / WHEEL_RADIUS_M)


@given(ANY, ANY)
def test_a_clamped_command_is_finite_and_bounded(v: float, w: float) -> None:
    clamped_v, clamped_w, finite = clamp_command(v, w)
    assert abs(clamped_v) <= MAX_SPEED_MPS
    assert abs(clamped_w) <= MAX_YAW_RATE_RADPS
    assert finite == (math.isfinite(v) and math.isfinite(w))
    if not finite:
        assert (clamped_v, clamped_w) == (0.0, 0.0)


@given(st.lists(st.tuples(st.integers(1, 30), ORDINARY_V, ORDINARY_W), max_size=6))
def test_the_servo_keeps_the_commanded_distance_and_angle(commands: list[tuple[int, float, float]]) -> None:
    # What the lag takes at every change it gives back at the next: also for commands too short to be reached.
    servo = make_servo("nominal", 0)
    asked_m = asked_rad = got_m = got_rad = 0.0
    for steps, v, w in [*commands, (400, 0.0, 0.0)]:
        servo.aim(v, w)
        for _ in range(steps):
            now_v, now_w = servo.step()
            got_m += now_v * STEP_S
            got_rad += now_w * STEP_S
        asked_m += steps * v * STEP_S
        asked_rad += steps * w * STEP_S
    assert servo.resting
    # A blend of (1 - q) per step leaves the sum of v short of the commanded one by nothing but the ending.
    assert got_m == pytest.approx(asked_m, abs=1e-6)
    assert got_rad == pytest.approx(asked_rad, abs=1e-6)


@given(st.floats(-100.0, 100.0), st.floats(-100.0, 100.0))
def test_an_arc_keeps_its_curvature_even_at_the_acceleration_bound(v: float, w: float) -> None:
    servo = Servo(PROFILES["nominal"])
    servo.aim(v, w)
    for _ in range(20):
        now_v, now_w = servo.step()
        assert now_v * w == pytest.approx(now_w * v, rel=1e-9, abs=1e-9)


@given(st.floats(-100.0, 100.0), st.floats(-100.0, 100.0), st.sampled_from(["nominal", "rough"]))
def test_acceleration_is_bounded(v: float, w: float, profile: str) -> None:
    parameters = PROFILES[profile]  # type: ignore[index]
    servo = Servo(parameters)
    servo.aim(v, w)
    before_v = before_w = 0.0
    for _ in range(50):
        now_v, now_w = servo.step()
        assert abs(now_v - before_v) <= parameters.max_acceleration_mps2 * STEP_S * (1 + 1e-9)
        assert abs(now_w - before_w) <= parameters.max_yaw_acceleration_radps2 * STEP_S * (1 + 1e-9)
        before_v, before_w = now_v, now_w


def test_commands_are_reached_within_a_tenth_of_a_second() -> None:
    servo = make_servo("nominal", 0)
    servo.aim(3.0, 2.0 * math.pi)
    for _ in range(24):
        v, w = servo.step()
    assert (v, w) == pytest.approx((3.0, 2.0 * math.pi), rel=0.02)


def test_the_rough_drive_depends_on_its_seed_only() -> None:
    def run(seed: int) -> list[tuple[float, float]]:
        servo = make_servo("rough", seed)
        servo.aim(1.0, 0.5)
        return [servo.step() for _ in range(500)]

    assert run(1) == run(1)
    assert run(1) != run(2)


def test_the_rough_drive_comes_to_rest() -> None:
    servo = make_servo("rough", 3)
    servo.aim(1.0, 0.0)
    for _ in range(240):
        servo.step()
    servo.aim(0.0, 0.0)
    for _ in range(480):
        last = servo.step()
    assert servo.resting
    assert last == (0.0, 0.0)


def test_halting_is_at_once() -> None:
    servo = make_servo("nominal", 0)
    servo.aim(1.0, 1.0)
    servo.step()
    servo.halt()
    assert servo.resting
    assert servo.step() == (0.0, 0.0)


def test_the_urdf_has_the_measures_of_the_parameters() -> None:
    root = ElementTree.parse(URDF).getroot()
    spheres = {
        collision.attrib["name"]: (collision.find("origin"), collision.find("geometry/sphere"))
        for collision in root.iter("collision")
    }
    assert set(spheres) == {"front_caster", "rear_caster", "left_tyre", "right_tyre"}
    heights = []
    for name, (origin, sphere) in spheres.items():
        assert origin is not None
        assert sphere is not None
        _, y, z = map(float, origin.attrib["xyz"].split())
        radius = float(sphere.attrib["radius"])
        heights.append(z - radius)
        if name.endswith("tyre"):
            assert radius == WHEEL_RADIUS_M
            assert abs(y) == TRACK_M / 2
    assert heights == pytest.approx([-WHEEL_RADIUS_M] * 4)
    centre = root.find("link[@name='base_link']/inertial/origin")
    assert centre is not None
    x, y, z = map(float, centre.attrib["xyz"].split())
    assert (x, y) == (0.0, 0.0)
    assert z + WHEEL_RADIUS_M == pytest.approx(RIDE_HEIGHT_M)
