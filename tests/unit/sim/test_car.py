import hashlib
import math
import random
import struct
import xml.etree.ElementTree as ElementTree
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from grader.sim.car import (
    MAX_SPEED_MPS,
    MAX_YAW_RATE_RADPS,
    PI,
    RIDE_HEIGHT_M,
    ROUGH_ACCELERATION_MPS2,
    ROUGH_YAW_ACCELERATION_RADPS2,
    STEP_S,
    TRACK_M,
    URDF,
    WHEEL_RADIUS_M,
    RoughDrive,
    clamp_command,
    cos_sin,
    fold,
    turtlesim_update,
    twist_to_wheels,
    wheels_to_twist,
)

SHIM = Path(__file__).parents[3] / "grader" / "shim"
DRIVEN = "fe5267cc9a8b57eed40cf2f6204510b333bbb06eb35ef57ae74e1fb82959c264"
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


@given(st.floats(-PI, PI, exclude_max=True))
def test_folding_keeps_the_bits_of_an_angle_in_range(angle: float) -> None:
    assert fold(angle) == angle


@given(st.floats(-1e6, 1e6))
def test_folding_subtracts_whole_turns_of_turtlesims_pi(angle: float) -> None:
    turns = (angle - fold(angle)) / (2.0 * PI)
    assert turns == pytest.approx(round(turns), abs=1e-6)
    assert -PI - 1e-9 <= fold(angle) <= PI + 1e-9


@given(st.floats(-10.0, 10.0))
def test_cosine_and_sine_are_those_of_the_c_library_but_for_a_last_bit(angle: float) -> None:
    assert cos_sin(angle) == pytest.approx((math.cos(angle), math.sin(angle)), rel=0.0, abs=2.3e-16)


def test_the_law_gives_the_same_bits_on_every_machine() -> None:
    """An arc of a thousand updates over all headings; the digest was taken on x86-64 with glibc 2.36."""
    pose, digest = (5.0, 5.0, -3.0), hashlib.sha256()
    for update in range(1_000):
        pose = turtlesim_update(pose, 1.0 + update / 700.0, 1.7 - update / 900.0)
        digest.update(struct.pack("<3d", *pose))
    assert digest.hexdigest() == DRIVEN


def test_the_scripts_side_computes_the_same_bits() -> None:
    spec = spec_from_file_location("reckoning_under_test", SHIM / "rclpy" / "_reckoning.py")
    assert spec is not None
    assert spec.loader is not None
    reckoning = module_from_spec(spec)
    spec.loader.exec_module(reckoning)
    angles = [chance.uniform(-7.0, 7.0) for chance in [random.Random(1)] for _ in range(2_000)]
    for angle in (*angles, 0.0, -0.0, PI, -PI, math.pi, -math.pi, 1e6):
        assert str(reckoning._cos_sin(angle)) == str(cos_sin(angle))  # == would take -0.0 for 0.0
        assert reckoning._fold(angle) == fold(angle)


def test_nothing_of_the_law_comes_from_a_mathematics_library() -> None:
    """`math` is asked for what IEEE 754 defines, and for constants."""
    exact = {"floor", "isfinite", "nan"}
    for function in (fold, turtlesim_update, clamp_command):
        assert set(function.__code__.co_names) & set(dir(math)) <= exact, function


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
