"""Between TransformStamped messages and poses, and which of them tf2 refuses."""

from __future__ import annotations

from math import isnan
from typing import Any

from tf2_py._algebra import Rigid
from tf2_py._cache import Sample

_NORM_TOLERANCE = 10e-3


def to_ns(moment: Any) -> int:
    """Return nanoseconds of a Time, a Duration or one of their messages.

    Raises TypeError: it is none of them.
    """
    if hasattr(moment, "sec") and hasattr(moment, "nanosec"):
        return int(moment.sec) * 10**9 + int(moment.nanosec)
    if hasattr(moment, "nanoseconds"):
        return int(moment.nanoseconds)
    raise TypeError("time must have sec and nanosec, or nanoseconds.")


def problems(child: str, sample: Sample, authority: str) -> list[tuple[int, str]]:
    """Return why a pose cannot be taken in: lines of buffer_core.cpp, and their texts."""
    parent, (translation, rotation) = sample.parent, sample.rigid
    is_nan = any(isnan(value) for value in (*translation, *rotation))
    is_unit = abs(sum(component**2 for component in rotation) - 1.0) < _NORM_TOLERANCE
    state = {
        (211, child == parent): f'TF_SELF_TRANSFORM: Ignoring transform from authority "{authority}" with '
        f'frame_id and  child_frame_id "{child}" because they are the same',
        (219, not child): f'TF_NO_CHILD_FRAME_ID: Ignoring transform from authority "{authority}" '
        "because child_frame_id not set ",
        (227, not parent): f'TF_NO_FRAME_ID: Ignoring transform with child_frame_id "{child}"  '
        f'from authority "{authority}" because frame_id not set',
        (237, is_nan): f'TF_NAN_INPUT: Ignoring transform for child_frame_id "{child}" '
        f'from authority "{authority}" because of a nan value in the transform '
        "({:f} {:f} {:f}) ({:f} {:f} {:f} {:f})".format(*translation, *rotation),
        (256, not is_unit): f'TF_DENORMALIZED_QUATERNION: Ignoring transform for child_frame_id "{child}" '
        f'from authority "{authority}" because of an invalid quaternion in the transform '
        "({:f} {:f} {:f} {:f})".format(*rotation),
    }
    return [(line, text) for (line, wrong), text in state.items() if wrong]


def from_message(message: Any) -> Sample:
    """Return the pose that a TransformStamped tells."""
    t, q = message.transform.translation, message.transform.rotation
    parent = message.header.frame_id.removeprefix("/")
    return Sample(to_ns(message.header.stamp), parent, Rigid((t.x, t.y, t.z), (q.x, q.y, q.z, q.w)))


def to_message(rigid: Rigid, time_ns: int, target: str, source: str) -> Any:
    """Return the pose of `source` in `target` as a TransformStamped."""
    from geometry_msgs.msg import TransformStamped

    message = TransformStamped(child_frame_id=source)
    message.header.frame_id = target
    message.header.stamp.sec, message.header.stamp.nanosec = divmod(time_ns, 10**9)
    t, q = message.transform.translation, message.transform.rotation
    t.x, t.y, t.z = rigid.translation
    q.x, q.y, q.z, q.w = rigid.rotation
    return message
