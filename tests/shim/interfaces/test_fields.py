"""What fields of messages take and refuse, and in which words, as rosidl_generator_py 0.14.4 has it."""

import array
import math
from collections import UserList, UserString

import numpy as np
import pytest
from geometry_msgs.msg import Point, Point32, Polygon, PoseWithCovariance, Twist, Vector3
from sensor_msgs.msg import LaserScan
from shape_msgs.msg import SolidPrimitive
from std_msgs.msg import String
from test_msgs.msg import (
    Arrays,
    BasicTypes,
    BoundedSequences,
    Strings,
    UnboundedSequences,
)
from turtlesim.msg import Color

from tests.shim.interfaces.refusal import refused

FLOAT32_MAX = "340282346600000016151267322115014000640.000000"
FLOAT64_MAX = f"{1.7976931348623157e308:f}"


@pytest.mark.parametrize(
    ("cls", "field", "value", "text"),
    [
        (Vector3, "x", 1, "The 'x' field must be of type 'float'"),
        (Vector3, "x", "1", "The 'x' field must be of type 'float'"),
        (Vector3, "x", np.float32(1), "The 'x' field must be of type 'float'"),
        (Vector3, "x", True, "The 'x' field must be of type 'float'"),
        (Point32, "y", 1e39, "The 'y' field must be a float in [-3.402823466e+38, 3.402823466e+38]"),
        (Twist, "linear", 1.0, "The 'linear' field must be a sub message of type 'Vector3'"),
        (Twist, "linear", Point(), "The 'linear' field must be a sub message of type 'Vector3'"),
        (String, "data", 5, "The 'data' field must be of type 'str'"),
        (String, "data", UserString("a"), "The 'data' field must be of type 'str'"),
        (BasicTypes, "bool_value", 1, "The 'bool_value' field must be of type 'bool'"),
        (BasicTypes, "int8_value", 1.0, "The 'int8_value' field must be of type 'int'"),
        (BasicTypes, "int8_value", 128, "The 'int8_value' field must be an integer in [-128, 127]"),
        (Color, "r", 256, "The 'r' field must be an unsigned integer in [0, 255]"),
        (Color, "r", -1, "The 'r' field must be an unsigned integer in [0, 255]"),
        (BasicTypes, "char_value", "a", "The 'char_value' field must be of type 'int'"),
        (
            BasicTypes,
            "uint64_value",
            2**64,
            "The 'uint64_value' field must be an unsigned integer in [0, 18446744073709551615]",
        ),
        (
            BasicTypes,
            "byte_value",
            b"ab",
            "The 'byte_value' field must be of type 'bytes' or 'ByteString' with length 1",
        ),
        (
            Strings,
            "bounded_string_value",
            "a" * 23,
            "The 'bounded_string_value' field must be string value not longer than 22",
        ),
        (
            LaserScan,
            "ranges",
            [1],
            "The 'ranges' field must be a set or sequence and each value of type 'float' "
            f"and each float in [-{FLOAT32_MAX}, {FLOAT32_MAX}]",
        ),
        (
            LaserScan,
            "ranges",
            np.zeros(2, np.float32),
            "The 'ranges' field must be a set or sequence and each value of type 'float' "
            f"and each float in [-{FLOAT32_MAX}, {FLOAT32_MAX}]",
        ),
        (LaserScan, "ranges", array.array("d"), "The 'ranges' array.array() must have the type code of 'f'"),
        (
            SolidPrimitive,
            "dimensions",
            [1.0] * 4,
            "The 'dimensions' field must be a set or sequence with length <= 3 "
            f"and each value of type 'float' and each double in [-{FLOAT64_MAX}, {FLOAT64_MAX}]",
        ),
        (
            SolidPrimitive,
            "dimensions",
            array.array("d", [1.0] * 4),
            "The 'dimensions' array.array() must have a size <= 3",
        ),
        (
            Polygon,
            "points",
            [Point()],
            "The 'points' field must be a set or sequence and each value of type 'Point32'",
        ),
        (
            Polygon,
            "points",
            "ab",
            "The 'points' field must be a set or sequence and each value of type 'Point32'",
        ),
        (
            BoundedSequences,
            "int8_values",
            [1, 2, 3, 4],
            "The 'int8_values' field must be a set or sequence with length <= 3 "
            "and each value of type 'int' and each integer in [-128, 127]",
        ),
        (
            Arrays,
            "bool_values",
            [True],
            "The 'bool_values' field must be a set or sequence with length 3 and each value of type 'bool'",
        ),
        (
            Arrays,
            "byte_values",
            ["not", "a", "byte"],
            "The 'byte_values' field must be a set or sequence with length 3 and each value of type 'bytes'",
        ),
        (
            PoseWithCovariance,
            "covariance",
            [1] * 36,
            "The 'covariance' field must be a set or sequence with length 36 and each value of type 'float' "
            f"and each double in [-{FLOAT64_MAX}, {FLOAT64_MAX}]",
        ),
        (
            PoseWithCovariance,
            "covariance",
            np.zeros(36, np.float32),
            "The 'covariance' numpy.ndarray() must have the dtype of 'numpy.float64'",
        ),
        (
            PoseWithCovariance,
            "covariance",
            np.zeros(35),
            "The 'covariance' numpy.ndarray() must have a size of 36",
        ),
    ],
)
def test_refused_assignments(cls: type, field: str, value: object, text: str) -> None:
    message = cls()
    before = repr(message)
    assert refused(message, field, value) == text
    assert repr(message) == before


def test_accepted_assignments() -> None:
    basic = BasicTypes()
    basic.int32_value = True  # a bool is an int
    basic.float64_value = np.float64(0.5)  # a subclass of float
    basic.byte_value = bytearray(b"x")
    for special in (math.nan, math.inf, -math.inf):
        basic.float32_value = special
    strings = Strings()
    strings.bounded_string_value = UserString("a" * 22)
    sequences = UnboundedSequences()
    sequences.uint8_values = b"\x01\x02"
    assert sequences.uint8_values == array.array("B", [1, 2])
    sequences.int32_values = {7}
    assert sequences.int32_values == array.array("i", [7])
    sequences.bool_values = UserList([True])
    sequences.string_values = ("a", "b")
    assert sequences.string_values == ("a", "b")


@pytest.mark.parametrize(
    ("cls", "field", "value"),
    [
        (UnboundedSequences, "uint8_values", [0, 255, True]),
        (UnboundedSequences, "int8_values", [-128, 127]),
        (UnboundedSequences, "uint64_values", [2**64 - 1]),
        (UnboundedSequences, "float64_values", [1e308, math.inf]),
        (UnboundedSequences, "float32_values", [-3.402823466e38, math.inf, math.nan, 3.402823466e38]),
        (UnboundedSequences, "float32_values", []),
        (BoundedSequences, "int16_values", [1, 2, 3]),
    ],
)
def test_a_list_of_numbers_becomes_an_array(cls, field, value):
    message = cls()
    setattr(message, field, value)
    stored = getattr(message, field)
    assert isinstance(stored, array.array)
    assert stored == array.array(stored.typecode, value) or math.nan in value
    assert len(stored) == len(value)


@pytest.mark.parametrize(
    ("cls", "field", "value"),
    [
        (UnboundedSequences, "uint8_values", [1, 256]),
        (UnboundedSequences, "uint8_values", [1, np.uint8(2)]),
        (UnboundedSequences, "int8_values", [-129]),
        (UnboundedSequences, "int64_values", [2**63]),
        (UnboundedSequences, "int32_values", [1.0]),
        (UnboundedSequences, "float64_values", [1.0, 1]),
        (UnboundedSequences, "float64_values", [np.float32(1)]),
        (UnboundedSequences, "float32_values", [math.nan, 1e39]),
        (UnboundedSequences, "float32_values", [-1e39, 0.0]),
        (BoundedSequences, "int16_values", [1, 2, 3, 4]),
    ],
)
def test_a_list_with_a_wrong_number_is_refused_as_a_sequence(cls, field, value):
    with pytest.raises(AssertionError, match=f"^The '{field}' field must be a set or sequence"):
        setattr(cls(), field, value)
