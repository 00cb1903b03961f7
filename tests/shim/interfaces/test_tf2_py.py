"""The tree of frames: composition, interpolation, and tf2's own exceptions and texts."""

import math
from types import SimpleNamespace
from typing import Any

import pytest
from builtin_interfaces.msg import Time
from geometry_msgs.msg import Pose, Quaternion, TransformStamped
from hypothesis import given
from hypothesis import strategies as st
from tf2_py import (
    BufferCore,
    ConnectivityException,
    ExtrapolationException,
    InvalidArgumentException,
    LookupException,
    TransformException,
)
from tf2_geometry_msgs import do_transform_pose

LATEST = Time()


def pose(
    parent: str, child: str, x: float = 0.0, y: float = 0.0, yaw: float = 0.0, t_s: float = 1.0
) -> TransformStamped:
    message = TransformStamped(child_frame_id=child)
    message.header.frame_id = parent
    message.header.stamp = at(t_s)
    message.transform.translation.x = x
    message.transform.translation.y = y
    message.transform.rotation.z = math.sin(yaw / 2)
    message.transform.rotation.w = math.cos(yaw / 2)
    return message


def at(t_s: float) -> Time:
    return Time(sec=int(t_s), nanosec=round(t_s % 1 * 10**9))


def xy_yaw(message: TransformStamped) -> tuple[float, float, float]:
    t, q = message.transform.translation, message.transform.rotation
    return t.x, t.y, 2 * math.atan2(q.z, q.w)


def buffer(*poses: TransformStamped) -> BufferCore:
    core = BufferCore()
    for message in poses:
        core.set_transform(message, "test")
    return core


def test_a_pose_and_its_inverse() -> None:
    core = buffer(pose("world", "turtle1", 1.0, 2.0, math.pi / 2))
    found = core.lookup_transform_core("world", "turtle1", LATEST)
    assert xy_yaw(found) == pytest.approx((1.0, 2.0, math.pi / 2))
    assert (found.header.frame_id, found.child_frame_id, found.header.stamp) == ("world", "turtle1", at(1.0))
    assert xy_yaw(core.lookup_transform_core("turtle1", "world", LATEST)) == pytest.approx(
        (-2.0, 1.0, -math.pi / 2)
    )


def test_two_turtles_by_way_of_the_world() -> None:
    core = buffer(pose("world", "turtle1", 1.0, 0.0, math.pi / 2), pose("world", "turtle2", 1.0, 3.0))
    assert xy_yaw(core.lookup_transform_core("turtle1", "turtle2", LATEST)) == pytest.approx(
        (3.0, 0.0, -math.pi / 2)
    )


@given(*[st.tuples(st.floats(-9, 9), st.floats(-9, 9), st.floats(-3, 3)) for _ in range(3)])
def test_chains_multiply(a: tuple[float, ...], b: tuple[float, ...], c: tuple[float, ...]) -> None:
    core = buffer(pose("m", "o", *a), pose("o", "b", *b), pose("b", "l", *c))
    x, y, yaw = 0.0, 0.0, 0.0
    for px, py, pyaw in (a, b, c):
        x, y = x + px * math.cos(yaw) - py * math.sin(yaw), y + px * math.sin(yaw) + py * math.cos(yaw)
        yaw += pyaw
    found = xy_yaw(core.lookup_transform_core("m", "l", LATEST))
    assert found[:2] == pytest.approx((x, y), abs=1e-9)
    assert math.remainder(found[2] - yaw, 2 * math.pi) == pytest.approx(0.0, abs=1e-7)


def test_between_samples_poses_are_interpolated() -> None:
    core = buffer(pose("w", "a", 0.0, yaw=0.0, t_s=1.0), pose("w", "a", 4.0, yaw=1.0, t_s=3.0))
    assert xy_yaw(core.lookup_transform_core("w", "a", at(1.5))) == pytest.approx((1.0, 0.0, 0.25))


def test_latest_common_time_is_the_oldest_of_the_newest() -> None:
    core = buffer(pose("w", "a", 1.0, t_s=1.0), pose("w", "a", 2.0, t_s=2.0), pose("w", "b", 0.0, t_s=1.5))
    core.set_transform(pose("w", "b", 0.0, t_s=1.0), "test")
    assert core.lookup_transform_core("b", "a", LATEST).header.stamp == at(1.5)


def test_a_fixed_frame_is_known_at_any_time() -> None:
    core = buffer(pose("w", "a", 1.0, t_s=5.0))
    core.set_transform_static(pose("a", "laser", 0.5), "test")
    assert xy_yaw(core.lookup_transform_core("w", "laser", at(5.0)))[0] == pytest.approx(1.5)
    assert xy_yaw(core.lookup_transform_core("a", "laser", at(99.0)))[0] == 0.5
    assert core.lookup_transform_core("a", "laser", LATEST).header.stamp == at(0.0)


def test_travel_in_time_by_way_of_a_fixed_frame() -> None:
    core = buffer(pose("w", "a", 1.0, t_s=1.0), pose("w", "a", 5.0, t_s=2.0))
    then = core.lookup_transform_full_core("a", at(2.0), "a", at(1.0), "w")
    assert xy_yaw(then)[0] == pytest.approx(-4.0)
    assert core.can_transform_full_core("a", at(2.0), "a", at(1.0), "w") == (True, "")
    assert core.can_transform_full_core("a", at(9.0), "a", at(1.0), "w")[0] is False


def test_the_same_frame_is_always_known() -> None:
    assert xy_yaw(BufferCore().lookup_transform_core("x", "x", LATEST)) == (0.0, 0.0, 0.0)


@pytest.mark.parametrize(
    ("target", "source", "t_s", "error", "text"),
    [
        (
            "w",
            "x",
            0,
            LookupException,
            '"x" passed to lookupTransform argument source_frame does not exist. ',
        ),
        (
            "x",
            "w",
            0,
            LookupException,
            '"x" passed to lookupTransform argument target_frame does not exist. ',
        ),
        (
            "",
            "w",
            0,
            InvalidArgumentException,
            'Invalid argument "" passed to lookupTransform argument target_frame - '
            "in tf2 frame_ids cannot be empty",
        ),
        (
            "/w",
            "a",
            0,
            InvalidArgumentException,
            'Invalid argument "/w" passed to lookupTransform argument target_frame - '
            "in tf2 frame_ids cannot start with a '/'",
        ),
        (
            "w",
            "island",
            0,
            ConnectivityException,
            "Could not find a connection between 'w' and 'island' because they are not part of the same tree."
            "Tf has two or more unconnected trees.",
        ),
        (
            "w",
            "a",
            9,
            ExtrapolationException,
            "Lookup would require extrapolation into the future.  Requested time 9.000000 but the latest "
            "data is at time 2.000000, when looking up transform from frame [a] to frame [w]",
        ),
        (
            "a",
            "w",
            0.5,
            ExtrapolationException,
            "Lookup would require extrapolation into the past.  Requested time 0.500000 but the earliest "
            "data is at time 1.000000, when looking up transform from frame [w] to frame [a]",
        ),
        (
            "w",
            "b",
            3,
            ExtrapolationException,
            "Lookup would require extrapolation at time 3.000000, but only time 1.000000 is in the buffer, "
            "when looking up transform from frame [b] to frame [w]",
        ),
    ],
)
def test_what_cannot_be_looked_up(
    target: str, source: str, t_s: float, error: type[TransformException], text: str
) -> None:
    core = buffer(
        pose("w", "a", t_s=1.0), pose("w", "a", t_s=2.0), pose("w", "b", t_s=1.0), pose("sea", "island")
    )
    with pytest.raises(error) as caught:
        core.lookup_transform_core(target, source, at(t_s))
    assert str(caught.value) == text
    assert core.can_transform_core(target, source, at(t_s))[0] is False


def test_can_transform_tells_why_not() -> None:
    assert buffer().can_transform_core("w", "a", LATEST) == (
        False,
        'Invalid frame ID "w" passed to canTransform argument target_frame - frame does not exist',
    )


def test_the_past_is_forgotten() -> None:
    core = buffer(pose("w", "a", t_s=1.0), pose("w", "a", t_s=20.0), pose("w", "a", t_s=21.0))
    with pytest.raises(ExtrapolationException, match="the earliest data is at time 20"):
        core.lookup_transform_core("w", "a", at(1.0))
    short = BufferCore(SimpleNamespace(nanoseconds=10**9))
    for t_s in (1.0, 3.0, 3.5):
        short.set_transform(pose("w", "a", t_s=t_s), "test")
    with pytest.raises(ExtrapolationException, match=r"the earliest data is at time 3\.0"):
        short.lookup_transform_core("w", "a", at(2.5))


def test_poses_arriving_late_are_sorted_in() -> None:
    core = buffer(pose("w", "a", 1.0, t_s=1.0), pose("w", "a", 3.0, t_s=3.0), pose("w", "a", 9.0, t_s=2.0))
    assert xy_yaw(core.lookup_transform_core("w", "a", at(2.5)))[0] == pytest.approx(6.0)


@pytest.mark.parametrize(
    ("message", "word"),
    [
        (pose("w", "w"), "TF_SELF_TRANSFORM"),
        (pose("w", ""), "TF_NO_CHILD_FRAME_ID"),
        (pose("", "a"), "TF_NO_FRAME_ID"),
        (pose("w", "a", math.nan), "TF_NAN_INPUT"),
        (TransformStamped(header=pose("w", "a").header, child_frame_id="a"), None),
    ],
)
def test_malformed_poses_are_ignored_with_a_line(
    message: TransformStamped, word: str | None, capsys: pytest.CaptureFixture[str]
) -> None:
    core = buffer(message)
    if word is None:
        message.transform.rotation.w = 0.5
        core = buffer(message)
        word = "TF_DENORMALIZED_QUATERNION"
    assert core.all_frames_as_yaml() == "[]"
    assert capsys.readouterr().err.startswith(f"Error:   {word}: Ignoring transform")


def test_loops_are_noticed() -> None:
    core = buffer(pose("b", "a"), pose("a", "b"), pose("w", "v"))
    with pytest.raises(LookupException, match="it contains a loop"):
        core.lookup_transform_core("v", "a", at(1.0))


def test_frames_as_text() -> None:
    core = buffer(pose("w", "a"))
    assert core.all_frames_as_string() == "Frame a exists with parent w.\n"
    assert core.all_frames_as_yaml().splitlines() == [
        "a: ", "  parent: 'w'", "  broadcaster: 'test'", "  rate: 10000.000", "  most_recent_transform: 1.000000",
        "  oldest_transform: 1.000000", "  buffer_length: 0.000",
    ]  # fmt: skip


def test_clearing_leaves_fixed_frames() -> None:
    core = buffer(pose("w", "a"))
    core.set_transform_static(pose("a", "s", 2.0), "test")
    core.clear()
    assert xy_yaw(core.lookup_transform_core("a", "s", at(0.0)))[0] == 2.0
    assert not core.can_transform_core("w", "a", at(0.0))[0]


def test_all_that_is_wrong_with_a_pose_is_told(capsys: pytest.CaptureFixture[str]) -> None:
    buffer(pose("", "", math.nan))
    core = buffer(pose("w", "a", t_s=20.0), pose("w", "a", t_s=1.0))
    told = capsys.readouterr().err.splitlines()
    assert [line.split(":")[1].strip().split(" ")[0] for line in told if ": " in line] == [
        "TF_SELF_TRANSFORM", "TF_NO_CHILD_FRAME_ID", "TF_NO_FRAME_ID", "TF_NAN_INPUT", "TF_OLD_DATA",
    ]  # fmt: skip
    assert told[-3:] == [
        "Warning: TF_OLD_DATA ignoring data from the past for frame a at time 1.000000 according to authority test",
        "Possible reasons are listed at http://wiki.ros.org/tf/Errors%20explained",
        "         at line 294 in ./src/buffer_core.cpp",
    ]
    assert core.can_transform_full_core("w", at(20.0), "a", at(20.0), "nope") == (
        False, 'Invalid frame ID "nope" passed to canTransform argument fixed_frame - frame does not exist',
    )  # fmt: skip


def test_frames_are_texts() -> None:
    core: Any = buffer(pose("w", "a"))
    with pytest.raises(TypeError, match="argument 2 must be str, not int"):
        core.lookup_transform_core("w", 5, at(1.0))
    with pytest.raises(TypeError, match="argument 1 must be str, not None"):
        core.can_transform_core(None, "w", at(1.0))


def test_a_moved_pose_has_a_positive_w() -> None:
    turned = Pose(orientation=Quaternion(z=0.6, w=-0.8))
    moved = do_transform_pose(turned, pose("w", "a"))
    assert (moved.orientation.z, moved.orientation.w) == pytest.approx((-0.6, 0.8))


def test_times_must_be_times() -> None:
    with pytest.raises(TypeError, match="time must have sec and nanosec, or nanoseconds"):
        buffer(pose("w", "a")).lookup_transform_core("w", "a", 1.0)
