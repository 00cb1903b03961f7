"""The student side's CDR codec: round trips, agreement with rosbags and with the trusted side."""

import struct
from typing import Any

import pytest
from geometry_msgs.msg import Point, Polygon, Twist, Vector3
from hypothesis import given
from hypothesis import strategies as st
from rclpy._interfaces.cdr import CdrError, deserialize, serialize
from rclpy._kernel import StalledError
from rclpy._rcl.errors import RMWError
from rclpy.serialization import deserialize_message
from rclpy._interfaces.messages import CLASSES, STRUCTURES, interface_name
from rosbags.typesys import Stores, get_typestore
from std_msgs.msg import Empty, Float64MultiArray, String
from test_msgs.msg import Arrays, BoundedSequences, MultiNested, Strings, WStrings

from grader.contracts.errors import ProtocolError
from grader.sim import cdr as trusted
from tests.shim.interfaces import messages as random_messages

ORACLE = get_typestore(Stores.ROS2_HUMBLE)
HEADER = b"\x00\x01\x00\x00"


@given(random_messages.messages())
def test_what_was_serialized_is_deserialized(message: Any) -> None:
    data = serialize(message)
    twin = deserialize(data, type(message))
    assert type(twin) is type(message)
    assert repr(twin) == repr(message)
    assert serialize(twin) == data


@given(random_messages.messages([name for name in random_messages.NAMES if name in ORACLE.types]))
def test_bytes_equal_those_of_rosbags(message: Any) -> None:
    expected = ORACLE.serialize_cdr(
        random_messages.to_rosbags(message, ORACLE), interface_name(type(message))
    )
    assert serialize(message) == bytes(expected)


def test_bytes_of_every_default_equal_those_of_rosbags() -> None:
    names = [name for name in random_messages.NAMES if name in ORACLE.types]
    assert len(names) > 120
    for name in names:
        message = CLASSES[name]()
        expected = ORACLE.serialize_cdr(random_messages.to_rosbags(message, ORACLE), name)
        assert serialize(message) == bytes(expected), name


@given(random_messages.messages())
def test_trusted_side_reads_what_the_student_side_writes(message: Any) -> None:
    name = STRUCTURES[type(message)].full_name
    data = serialize(message)
    assert trusted.encode(name, trusted.decode(name, data)) == data


def test_defaults_of_both_sides_agree() -> None:
    for name in random_messages.NAMES:
        assert trusted.encode(name) == serialize(CLASSES[name]()), name


@given(random_messages.messages(), st.data())
def test_no_proper_prefix_is_read_and_what_follows_is_not_looked_at(
    message: Any, data: st.DataObject
) -> None:
    raw = serialize(message)
    cut = data.draw(st.integers(0, len(raw) - 1))
    with pytest.raises(CdrError):
        deserialize(raw[:cut], type(message))
    assert serialize(deserialize(raw + b"\0", type(message))) == raw  # p25_serial


@given(st.sampled_from(random_messages.NAMES), st.binary(max_size=150))
def test_any_bytes_are_read_or_refused_cleanly(name: str, body: bytes) -> None:
    cls = CLASSES[name]
    try:
        message = deserialize(HEADER + body, cls)
    except CdrError:
        return
    assert isinstance(message, cls)


def test_known_bytes() -> None:
    twist = Twist(linear=Vector3(x=2.0), angular=Vector3(z=-1.0))
    assert serialize(twist) == HEADER + struct.pack("<6d", 2.0, 0, 0, 0, 0, -1.0)
    assert serialize(Empty()) == HEADER + b"\0"
    assert serialize(String(data="é")) == HEADER + b"\x03\0\0\0\xc3\xa9\0"
    # Fast CDR: four bytes for each UTF-16 unit of a wide string.
    assert serialize(WStrings(wstring_value="a😀"))[4:20] == struct.pack("<4I", 3, 0x61, 0xD83D, 0xDE00)
    # Nothing is padded before the elements of an empty sequence.
    assert serialize(Float64MultiArray()) == HEADER + bytes(12)
    assert serialize(Float64MultiArray(data=[1.0]))[12:] == struct.pack("<IId", 1, 0, 1.0)


def test_text_ends_at_its_first_nul_as_in_c() -> None:
    assert deserialize(serialize(String(data="ab\0cd")), String).data == "ab"


@pytest.mark.parametrize(
    ("message", "error"),
    [
        (Polygon(), StalledError),  # what an abort is where no run is to be ended
        (Arrays(), CdrError),
        (BoundedSequences(), CdrError),
    ],
)
def test_lists_spoilt_after_assignment_are_refused(message: Any, error: type[Exception]) -> None:
    if isinstance(message, Polygon):
        message.points.append(Point())
    elif isinstance(message, Arrays):
        message.bool_values.append(True)
    else:
        message.string_values.extend("abcd")
    with pytest.raises(error):
        serialize(message)


@pytest.mark.parametrize(
    ("cls", "body"),
    [
        (String, struct.pack("<I", 0)),
        (String, struct.pack("<I", 3) + b"abc"),
        (String, struct.pack("<I", 3) + b"a\0\0"),
        (String, struct.pack("<I", 3) + b"\xc3(\0"),
        (String, struct.pack("<I", 2**32 - 1) + b"a\0"),
        (Polygon, struct.pack("<I", 2**31)),
        (Float64MultiArray, struct.pack("<III", 0, 0, 2**32 - 1)),
        (Strings, struct.pack("<I", 1) + b"\0"),
        (MultiNested, b""),
    ],
)
def test_malformed_bodies_are_refused(cls: type, body: bytes) -> None:
    with pytest.raises(CdrError):
        deserialize(HEADER + body, cls)
    name = STRUCTURES[cls].full_name
    with pytest.raises(ProtocolError):
        trusted.decode(name, HEADER + body)


def test_deserialized_messages_still_check_assignments() -> None:
    twist = deserialize(serialize(Twist()), Twist)
    with pytest.raises(AssertionError, match="The 'x' field must be of type 'float'"):
        twist.linear.x = 1


def test_bytes_that_are_no_message_are_refused_as_by_the_middleware() -> None:
    with pytest.raises(RMWError, match="failed to deserialize ROS message"):
        deserialize_message(b"abc", String)
    with pytest.raises(TypeError, match="incompatible function arguments"):
        deserialize_message("abc", String)  # type: ignore[arg-type]
