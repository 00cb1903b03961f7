"""The trusted CDR codec: round trips, agreement with rosbags, and refusal of everything malformed."""

import struct
from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rosbags.typesys import Stores, get_typestore

from grader.contracts.errors import ProtocolError
from grader.sim.cdr import HEADER, MAX_MESSAGE_BYTES, decode, encode
from grader.sim.interfaces import ros_types

TYPES = ros_types()
FIELDS = TYPES.fields
TWIST = "geometry_msgs/msg/Twist"
INTEGER_BOUNDS = {
    "int8": (-(2**7), 2**7 - 1),
    "uint8": (0, 2**8 - 1),
    "int16": (-(2**15), 2**15 - 1),
    "uint16": (0, 2**16 - 1),
    "int32": (-(2**31), 2**31 - 1),
    "uint32": (0, 2**32 - 1),
    "int64": (-(2**63), 2**63 - 1),
    "uint64": (0, 2**64 - 1),
}
TEXT = st.text(st.characters(exclude_characters="\0", exclude_categories=["Cs"]), max_size=8)


def values_of(text: str) -> st.SearchStrategy[Any]:
    """Return a strategy for the values of a field type."""
    if text.endswith("]"):
        base, _, count = text[:-1].rpartition("[")
        low, high = (int(count), int(count)) if count.isdigit() else (0, int(count[2:] or 3))
        if base == "uint8":
            return st.binary(min_size=low, max_size=high)
        return st.lists(values_of(base), min_size=low, max_size=high)
    if text in INTEGER_BOUNDS:
        return st.integers(*INTEGER_BOUNDS[text])
    if text in FIELDS:
        return st.fixed_dictionaries({name: values_of(inner) for name, inner in FIELDS[text]})
    return {
        "bool": st.booleans(),
        "float32": st.floats(width=32, allow_nan=False),
        "float64": st.floats(allow_nan=False),
        "string": TEXT,
        "wstring": TEXT,
    }[text.partition("<")[0]]


MESSAGES = st.sampled_from(sorted(FIELDS)).flatmap(lambda name: st.tuples(st.just(name), values_of(name)))


@given(MESSAGES)
def test_what_was_written_is_read_back(message: tuple[str, dict[str, Any]]) -> None:
    name, values = message
    assert decode(name, encode(name, values)) == values


@given(MESSAGES, st.data())
def test_no_proper_prefix_and_no_longer_message_is_read(
    message: tuple[str, dict[str, Any]], data: st.DataObject
) -> None:
    name, values = message
    raw = encode(name, values)
    cut = data.draw(st.integers(0, len(raw) - 1))
    for wrong in (raw[:cut], raw + b"\0"):
        with pytest.raises(ProtocolError):
            decode(name, wrong)


@given(st.sampled_from(sorted(FIELDS)), st.binary(max_size=200))
def test_any_bytes_are_read_or_refused_cleanly(name: str, body: bytes) -> None:
    try:
        values = decode(name, HEADER + body)
    except ProtocolError:
        return
    assert values.keys() == {field for field, _ in FIELDS[name]}


ORACLE = get_typestore(Stores.ROS2_HUMBLE)


def to_rosbags(name: str, values: Mapping[str, Any]) -> Any:
    """Build rosbags' own object for `values`."""
    fields = dict(FIELDS[name])
    arguments = {field: _to_rosbags_value(fields[field], value) for field, value in values.items()}
    for field, (_, kind) in ORACLE.fielddefs[name][1]:
        if kind == ("byte", 0):  # ROS's octet of 0 to 255 has a sign in rosbags
            arguments[field] -= 256 * (arguments[field] > 127)
    if not fields:
        arguments["structure_needs_at_least_one_member"] = 0
    return ORACLE.types[name](**arguments)


def _to_rosbags_value(text: str, value: Any) -> Any:
    base, bracket, _ = text.partition("[")
    if bracket and base in FIELDS:
        return [to_rosbags(base, element) for element in value]
    if bracket and base == "uint8":
        return np.frombuffer(value, np.uint8)
    if bracket and base != "string":
        return np.array(value, base)
    return to_rosbags(base, value) if base in FIELDS else value


KNOWN_TO_ROSBAGS = sorted(FIELDS.keys() & ORACLE.types.keys())


def test_rosbags_knows_the_common_types() -> None:
    assert {TWIST, "nav_msgs/msg/Odometry", "tf2_msgs/msg/TFMessage", "std_msgs/msg/Empty"} <= set(
        KNOWN_TO_ROSBAGS
    )


@given(st.sampled_from(KNOWN_TO_ROSBAGS).flatmap(lambda name: st.tuples(st.just(name), values_of(name))))
def test_bytes_equal_those_of_rosbags(message: tuple[str, dict[str, Any]]) -> None:
    name, values = message
    assert encode(name, values) == bytes(ORACLE.serialize_cdr(to_rosbags(name, values), name))


def test_defaults_of_left_out_fields() -> None:
    pose = decode("geometry_msgs/msg/Pose", encode("geometry_msgs/msg/Pose"))
    assert pose["orientation"] == {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}
    assert (
        decode("nav_msgs/msg/Odometry", encode("nav_msgs/msg/Odometry"))["pose"]["covariance"] == [0.0] * 36
    )


def test_defaults_name_existing_fields() -> None:
    for name, defaults in TYPES.defaults.items():
        assert defaults.keys() <= {field for field, _ in FIELDS[name]}


def test_not_finite_floats_are_passed_on() -> None:
    raw = HEADER + struct.pack("<6d", float("nan"), float("inf"), 0, 0, 0, float("-inf"))
    twist = decode(TWIST, raw)
    assert twist["linear"]["x"] != twist["linear"]["x"]
    assert twist["angular"]["z"] == float("-inf")


@pytest.mark.parametrize(
    ("name", "body"),
    [
        ("std_msgs/msg/String", struct.pack("<I", 0)),
        ("std_msgs/msg/String", struct.pack("<I", 3) + b"abc"),
        ("std_msgs/msg/String", struct.pack("<I", 3) + b"a\0\0"),
        ("std_msgs/msg/String", struct.pack("<I", 3) + b"\xc3(\0"),
        ("std_msgs/msg/String", struct.pack("<I", 2**32 - 1) + b"a\0"),
        ("std_msgs/msg/Bool", b"\x02"),
        ("std_msgs/msg/Empty", b""),
        ("tf2_msgs/msg/TFMessage", struct.pack("<I", 2**31)),
        ("action_msgs/msg/GoalStatusArray", struct.pack("<I", 1)),
    ],
)
def test_malformed_bodies_are_refused(name: str, body: bytes) -> None:
    with pytest.raises(ProtocolError):
        decode(name, HEADER + body)


def test_other_encapsulations_oversize_and_unknown_types_are_refused() -> None:
    twist = encode(TWIST)
    for wrong in (b"", b"\x00\x00" + twist[2:], b"\x00\x03" + twist[2:]):
        with pytest.raises(ProtocolError):
            decode(TWIST, wrong)
    with pytest.raises(ProtocolError, match="bytes"):
        decode("std_msgs/msg/String", HEADER + bytes(MAX_MESSAGE_BYTES))
    with pytest.raises(ProtocolError, match="unknown type"):
        decode("geometry_msgs/msg/Twits", twist)


@pytest.mark.parametrize(
    ("name", "values"),
    [
        (TWIST, {"liner": {}}),
        (TWIST, {"linear": {"x": "fast"}}),
        (TWIST, {"linear": 1.0}),
        ("turtlesim/msg/Color", {"r": 256}),
        ("turtlesim/msg/Pose", {"x": 1e39}),
        ("std_msgs/msg/String", {"data": "a\0b"}),
        ("std_msgs/msg/String", {"data": "\ud800"}),
        ("unique_identifier_msgs/msg/UUID", {"uuid": b"short"}),
    ],
)
def test_values_that_do_not_fit_are_refused(name: str, values: dict[str, Any]) -> None:
    with pytest.raises(ProtocolError):
        encode(name, values)
