import math
import xml.etree.ElementTree as ElementTree

import pytest
from hypothesis import given
from hypothesis import strategies as st

from grader.sim.car import (
    MAX_SPEED_MPS,
    MAX_YAW_RATE_RADPS,
    RIDE_HEIGHT_M,
    ROUGH_ACCELERATION_MPS2,
    ROUGH_YAW_ACCELERATION_RADPS2,
    STEP_S,
    TRACK_M,
    URDF,
    WHEEL_RADIUS_M,
    RoughDrive,
    clamp_command,
    fold,
    twist_to_wheels,
    wheels_to_twist,
)

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


@given(st.floats(-math.pi, math.pi, exclude_max=True))
def test_folding_keeps_the_bits_of_an_angle_in_range(angle: float) -> None:
    assert fold(angle) == angle


@given(st.floats(-100.0, 100.0), st.floats(-100.0, 100.0))
def test_an_arc_keeps_its_curvature_even_at_the_acceleration_bound(v: float, w: float) -> None:
    drive = RoughDrive(0)
    drive.aim(v, w)
    for _ in range(20):
        drive.step()
        assert drive.v_mps * w == pytest.approx(drive.w_radps * v, rel=1e-9, abs=1e-9)


@given(st.floats(-100.0, 100.0), st.floats(-100.0, 100.0))
def test_acceleration_is_bounded(v: float, w: float) -> None:
    drive = RoughDrive(0)
    drive.aim(v, w)
    before_v = before_w = 0.0
    for _ in range(50):
        drive.step()
        assert abs(drive.v_mps - before_v) <= ROUGH_ACCELERATION_MPS2 * STEP_S * (1 + 1e-9)
        assert abs(drive.w_radps - before_w) <= ROUGH_YAW_ACCELERATION_RADPS2 * STEP_S * (1 + 1e-9)
        before_v, before_w = drive.v_mps, drive.w_radps


def test_the_rough_drive_depends_on_its_seed_only() -> None:
    def run(seed: int) -> list[tuple[float, float]]:
        drive = RoughDrive(seed)
        drive.aim(1.0, 0.5)
        return [drive.step() for _ in range(500)]

    assert run(1) == run(1)
    assert run(1) != run(2)


def test_the_rough_drive_comes_to_rest() -> None:
    drive = RoughDrive(3)
    drive.aim(1.0, 0.0)
    for _ in range(240):
        drive.step()
    drive.aim(0.0, 0.0)
    for _ in range(480):
        last = drive.step()
    assert drive.resting
    assert last == (0.0, 0.0)


def test_halting_is_at_once() -> None:
    drive = RoughDrive(0)
    drive.aim(1.0, 1.0)
    drive.step()
    drive.halt()
    assert drive.resting
    assert drive.step() == (0.0, 0.0)


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
