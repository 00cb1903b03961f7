"""The robot's messages in CDR, written field by field: they are too many and too long for the general writer.

Names of frames, covariances and constant fields are those of turtlebot3_gazebo and of the plugins it loads
(gazebo_ros_pkgs, branch galactic, which Humble's is made from). A test compares each with the general writer.
"""

import math
import struct
from collections.abc import Sequence
from typing import Final

from grader.contracts.robot import LEAST_RANGE_M, MOST_RANGE_M, RAYS
from grader.sim.car import NS_PER_S, PlanarPose
from grader.sim.cdr import HEADER, encode
from grader.sim.interfaces import header, quaternion
from grader.sim.scanner import LAST_ANGLE_RAD, STEP_RAD

ODOM_FRAME: Final = "odom"
BASE_FRAME: Final = "base_footprint"
SCAN_FRAME: Final = "base_scan"
WHEEL_JOINTS: Final = ("wheel_left_joint", "wheel_right_joint")

_UNKNOWN: Final = 1e12  # variance of what a robot on the floor does not do


def _covariance(*diagonal: float) -> bytes:
    size = len(diagonal)
    flat = [0.0] * (size * size)
    flat[:: size + 1] = diagonal
    return struct.pack(f"<{size * size}d", *flat)


def _text(text: str) -> bytes:
    raw = text.encode() + b"\0"
    return struct.pack("<I", len(raw)) + raw


def _padded(data: bytes, size: int) -> bytes:
    """Fill up to a multiple of `size`, counted from behind the stamp, which is eight bytes long."""
    return data + bytes(-len(data) % size)


_STAMP: Final = struct.Struct("<iI")
_SEVEN: Final = struct.Struct("<7d")
_SIX: Final = struct.Struct("<6d")
_ODOM_HEAD: Final = _padded(_padded(_text(ODOM_FRAME), 4) + _text(BASE_FRAME), 8)
_PLANAR: Final = _covariance(1e-5, 1e-5, _UNKNOWN, _UNKNOWN, _UNKNOWN, 1e-3)
_SCAN_HEAD: Final = _padded(_text(SCAN_FRAME), 4) + struct.pack(
    "<7fI", 0.0, LAST_ANGLE_RAD, STEP_RAD, 0.0, 0.0, LEAST_RANGE_M, MOST_RANGE_M, RAYS
)
_SCAN_TAIL: Final = struct.pack("<I", RAYS) + bytes(4 * RAYS)  # intensities, all zero as in Gazebo


def _stamp(t_ns: int) -> bytes:
    return _STAMP.pack(t_ns // NS_PER_S, t_ns % NS_PER_S)


def odometry(t_ns: int, pose: PlanarPose, v_mps: float, w_radps: float) -> bytes:
    """Return nav_msgs/msg/Odometry."""
    x, y, heading = pose
    half = math.remainder(heading, math.tau) / 2.0
    return b"".join(
        (
            HEADER,
            _stamp(t_ns),
            _ODOM_HEAD,
            _SEVEN.pack(x, y, 0.0, 0.0, 0.0, math.sin(half), math.cos(half)),
            _PLANAR,
            _SIX.pack(v_mps, 0.0, 0.0, 0.0, 0.0, w_radps),
            _PLANAR,
        )
    )


def laser_scan(t_ns: int, ranges: bytes) -> bytes:
    """Return sensor_msgs/msg/LaserScan; `ranges` are 360 little-endian float32."""
    return b"".join((HEADER, _stamp(t_ns), _SCAN_HEAD, ranges, _SCAN_TAIL))


def transforms(t_ns: int, pose: PlanarPose) -> bytes:
    """Return tf2_msgs/msg/TFMessage: where the robot is by its odometry."""
    x, y, heading = pose
    values = {
        "header": header(t_ns, ODOM_FRAME),
        "child_frame_id": BASE_FRAME,
        "transform": {"translation": {"x": x, "y": y}, "rotation": quaternion(heading)},
    }
    return encode("tf2_msgs/msg/TFMessage", {"transforms": [values]})


def clock(t_ns: int) -> bytes:
    """Return rosgraph_msgs/msg/Clock."""
    return HEADER + _stamp(t_ns)


_FIXED_FRAMES: Final = (
    ("base_footprint", "base_link", (0.0, 0.0, 0.01)),
    ("base_link", "base_scan", (-0.032, 0.0, 0.172)),
    ("base_link", "imu_link", (-0.032, 0.0, 0.068)),
    ("base_link", "caster_back_link", (-0.081, 0.0, -0.004)),
)


def static_transforms(t_ns: int) -> bytes:
    """Return tf2_msgs/msg/TFMessage: what is fixed to the robot, as its URDF has it."""
    fixed = []
    for parent, child, at in _FIXED_FRAMES:
        turned = {"x": math.sin(-0.785), "w": math.cos(-0.785)} if child == "caster_back_link" else {"w": 1.0}
        fixed.append(
            {
                "header": header(t_ns, parent),
                "child_frame_id": child,
                "transform": {"translation": dict(zip("xyz", at, strict=True)), "rotation": turned},
            }
        )
    return encode("tf2_msgs/msg/TFMessage", {"transforms": fixed})


IMU_FRAME: Final = "imu_link"
CAMERA_FRAME: Final = "camera_link"
TURN_NOISE_RADPS, PUSH_NOISE_MPS2 = 2e-4, 1.7e-2
_GRAVITY_MPS2: Final = 9.8
_IMU_HEAD: Final = _padded(_text(IMU_FRAME), 8)
_TURNS: Final = _covariance(*(3 * (TURN_NOISE_RADPS**2,)))
_PUSHES: Final = _covariance(*(3 * (PUSH_NOISE_MPS2**2,)))
_IMU: Final = struct.Struct("<4d")
_THREE: Final = struct.Struct("<3d")


def imu(t_ns: int, heading_rad: float, turn_radps: Sequence[float], push_mps2: Sequence[float]) -> bytes:
    """Return sensor_msgs/msg/Imu of a robot on the floor; gravity is added to what pushes it."""
    half = math.remainder(heading_rad, math.tau) / 2.0
    x, y, z = push_mps2
    return b"".join(
        (
            HEADER,
            _stamp(t_ns),
            _IMU_HEAD,
            _IMU.pack(0.0, 0.0, math.sin(half), math.cos(half)),
            bytes(72),
            _THREE.pack(*turn_radps),
            _TURNS,
            _THREE.pack(x, y, z + _GRAVITY_MPS2),
            _PUSHES,
        )
    )


def image(t_ns: int, width: int, height: int, pixels: bytes) -> bytes:
    """Return sensor_msgs/msg/Image of encoding rgb8."""
    head = _padded(_text(CAMERA_FRAME), 4) + struct.pack("<II", height, width) + _text("rgb8") + b"\0"
    return b"".join(
        (HEADER, _stamp(t_ns), _padded(head, 4), struct.pack("<II", 3 * width, len(pixels)), pixels)
    )


def compressed_image(t_ns: int, png: bytes) -> bytes:
    """Return sensor_msgs/msg/CompressedImage, a PNG file; image_transport would send JPEG."""
    head = _padded(_padded(_text(CAMERA_FRAME), 4) + _text("rgb8; png compressed bgr8"), 4)
    return b"".join((HEADER, _stamp(t_ns), head, struct.pack("<I", len(png)), png))


def joint_states(t_ns: int, angles_rad: Sequence[float], rates_radps: Sequence[float]) -> bytes:
    """Return sensor_msgs/msg/JointState of the two wheels; efforts are left out, as Gazebo does."""
    head = _stamp(t_ns) + _padded(_text(""), 4) + struct.pack("<I", len(WHEEL_JOINTS))
    for name in WHEEL_JOINTS:
        head = _padded(head, 4) + _text(name)
    head = _padded(head, 4) + struct.pack("<I", 2)
    head = _padded(head, 8) + struct.pack("<2d", *angles_rad) + struct.pack("<I", 2)
    return HEADER + _padded(head, 8) + struct.pack("<2d", *rates_radps) + struct.pack("<I", 0)
