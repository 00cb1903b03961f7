"""Message classes behave as rosidl_generator_py 0.14.4 (ROS 2 Humble) makes them."""

import array
import copy
import math
import pickle
from collections import UserList, UserString
from typing import Any

import numpy as np
import pytest
from action_msgs.msg import GoalStatusArray
from action_msgs.srv import CancelGoal
from geometry_msgs.msg import Point, Point32, Polygon, Pose, PoseWithCovariance, Quaternion, Twist, Vector3
from rcl_interfaces.msg import Log
from rosidl_parser.definition import (
    Array,
    BasicType,
    BoundedSequence,
    BoundedString,
    NamespacedType,
    UnboundedSequence,
    UnboundedString,
    UnboundedWString,
)
from sensor_msgs.msg import LaserScan
from shape_msgs.msg import SolidPrimitive
from std_msgs.msg import Empty, Header, String
from std_srvs.srv import SetBool
from test_msgs.msg import (
    Arrays,
    BasicTypes,
    BoundedSequences,
    Constants,
    Defaults,
    Strings,
    UnboundedSequences,
    WStrings,
)
from turtlesim.action import RotateAbsolute
from turtlesim.msg import Color
from turtlesim.srv import Spawn
from unique_identifier_msgs.msg import UUID
from visualization_msgs.msg import Marker

FLOAT32_MAX = "340282346600000016151267322115014000640.000000"
FLOAT64_MAX = f"{1.7976931348623157e308:f}"


def refused(message: Any, field: str, value: object) -> str:
    """Assign and return the text of the AssertionError, without pytest's explanation of operands."""
    with pytest.raises(AssertionError) as caught:
        setattr(message, field, value)
    return str(caught.value)


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


def test_constructor() -> None:
    assert Twist(linear=Vector3(x=1.0)).linear == Vector3(x=1.0, y=0.0, z=0.0)
    with pytest.raises(TypeError, match=r"Twist.__init__\(\) takes 1 positional argument but 2 were given"):
        Twist(Vector3())
    with pytest.raises(AssertionError) as caught:
        Twist(liner=1, angle=2, linear=Vector3())
    assert str(caught.value) == "Invalid arguments passed to constructor: angle, liner"
    with pytest.raises(AssertionError, match="sub message of type 'Vector3'"):
        Twist(linear=1.0)
    with pytest.raises(AssertionError, match="Invalid arguments"):
        Empty(data=1)
    assert LaserScan(ranges=[1, 2]).ranges == array.array("f", [1.0, 2.0])  # the constructor converts


def test_slots_refuse_misspelt_fields() -> None:
    twist = Twist()
    with pytest.raises(AttributeError, match="'Twist' object has no attribute 'liner'"):
        _ = twist.liner
    with pytest.raises(AttributeError, match="'Twist' object has no attribute 'linear_x'"):
        twist.linear_x = 1.0
    assert Twist.__slots__ == ["_linear", "_angular"]
    assert not hasattr(twist, "__dict__")


def test_defaults() -> None:
    assert Quaternion() == Quaternion(x=0.0, y=0.0, z=0.0, w=1.0)
    assert Quaternion.W__DEFAULT == 1.0
    defaults = Defaults()
    assert defaults.bool_value is True
    assert (defaults.byte_value, defaults.char_value, defaults.int64_value) == (b"2", 100, -40000000)
    assert type(Quaternion().x) is float
    assert Strings().string_value_default4 == "Hello'world!"
    assert WStrings().wstring_value_default3 == "ハローワールド"
    assert BoundedSequences().float32_values_default == array.array("f", [1.125, 0.0, -1.125])
    assert Arrays().byte_values == [b"\0"] * 3
    assert Arrays().int8_values_default.tolist() == [0, 127, -128]
    assert Arrays.INT8_VALUES_DEFAULT__DEFAULT.dtype == np.int8
    assert Arrays().INT8_VALUES_DEFAULT__DEFAULT.tolist() == [0, 127, -128]
    with pytest.raises(AttributeError):
        Quaternion.W__DEFAULT = 2.0


def test_objects_do_not_share_their_defaults() -> None:
    first, second = UnboundedSequences(), UnboundedSequences()
    first.int32_values_default.append(1)
    first.string_values.append("a")
    first.basic_types_values.append(BasicTypes())
    assert second == UnboundedSequences()
    one, other = PoseWithCovariance(), PoseWithCovariance()
    one.covariance[0] = 5.0
    assert one.covariance[0] == 5.0
    assert other.covariance[0] == 0.0


def test_nested_messages_are_references() -> None:
    vector = Vector3()
    twist = Twist(linear=vector, angular=vector)
    twist.linear.x = 2.0
    assert twist.angular.x == 2.0


def test_constants() -> None:
    assert (Constants.BOOL_CONST, Constants.BYTE_CONST, Constants.CHAR_CONST) == (True, b"2", 100)
    assert Log.INFO == b"\x14"
    assert Marker.CUBE == Marker().CUBE == 1
    assert CancelGoal.Response.ERROR_REJECTED == 1
    with pytest.raises(AttributeError, match="has no setter"):
        Marker.CUBE = 5
    with pytest.raises(AttributeError, match="read-only"):
        Marker().CUBE = 5


def test_fixed_arrays_are_numpys() -> None:
    message = PoseWithCovariance(covariance=list(range(36)))
    assert isinstance(message.covariance, np.ndarray)
    assert message.covariance.dtype == np.float64
    assert message.covariance.tolist() == list(range(36))
    mine = np.ones(36)
    message.covariance = mine
    assert message.covariance is mine
    with pytest.raises(AssertionError, match="must have a size of 36"):
        PoseWithCovariance(covariance=[0.0])
    with pytest.raises(AssertionError):
        PoseWithCovariance(covariance=np.zeros((6, 6)))
    assert UUID().uuid.dtype == np.uint8
    with pytest.raises(ValueError, match="invalid literal"):
        UUID(uuid=b"0123456789abcdef")  # numpy's own answer to bytes


def test_equality_and_hash() -> None:
    assert Twist() == Twist()
    assert Twist() != Twist(linear=Vector3(x=1.0))
    assert Vector3() != Point()
    assert Twist() != "twist"
    assert Empty() == Empty()
    with pytest.raises(TypeError, match="unhashable type: 'Twist'"):
        hash(Twist())
    # Humble compares fixed arrays with all(): one different element does not count.
    nearly = PoseWithCovariance()
    nearly.covariance[3] = 1.0
    assert nearly == PoseWithCovariance()
    assert PoseWithCovariance(covariance=[1.0] * 36) != PoseWithCovariance()


def test_repr() -> None:
    assert repr(Twist(linear=Vector3(x=0.5))) == (
        "geometry_msgs.msg.Twist(linear=geometry_msgs.msg.Vector3(x=0.5, y=0.0, z=0.0), "
        "angular=geometry_msgs.msg.Vector3(x=0.0, y=0.0, z=0.0))"
    )
    assert repr(Empty()) == "std_msgs.msg.Empty()"
    assert repr(Spawn.Request(name="a")) == ("turtlesim.srv.Spawn_Request(x=0.0, y=0.0, theta=0.0, name='a')")
    scan = repr(LaserScan(ranges=[1.0, 2.5]))
    assert scan.endswith("ranges=[1.0, 2.5], intensities=[])")
    assert repr(UUID()).startswith("unique_identifier_msgs.msg.UUID(uuid=array([0, 0,")


@pytest.mark.parametrize("touch", [False, True])
def test_copy_and_pickle(touch: bool) -> None:
    message = PoseWithCovariance(pose=Pose(position=Point(x=1.0)), covariance=[1.0] * 36)
    if touch:
        assert message.covariance[0] == 1.0
    for twin in (copy.deepcopy(message), pickle.loads(pickle.dumps(message))):
        assert twin == message
        twin.pose.position.x = 5.0
        twin.covariance[:] = 7.0
        assert message.pose.position.x == 1.0
        assert message.covariance.tolist() == [1.0] * 36
    assert copy.copy(message).pose is message.pose


def test_field_types() -> None:
    assert Twist.get_fields_and_field_types() == {
        "linear": "geometry_msgs/Vector3",
        "angular": "geometry_msgs/Vector3",
    }
    Twist.get_fields_and_field_types().clear()
    assert Twist().get_fields_and_field_types()
    types = BoundedSequences.get_fields_and_field_types() | Arrays.get_fields_and_field_types()
    assert BoundedSequences.get_fields_and_field_types()["string_values"] == "sequence<string, 3>"
    assert types["byte_values"] == "octet[3]"
    assert types["basic_types_values"] == "test_msgs/BasicTypes[3]"
    assert LaserScan.get_fields_and_field_types()["ranges"] == "sequence<float>"
    assert Strings.get_fields_and_field_types()["bounded_string_value"] == "string<22>"


def test_slot_types() -> None:
    assert (NamespacedType(["geometry_msgs", "msg"], "Vector3"),) * 2 == Twist.SLOT_TYPES
    assert Header().SLOT_TYPES[1] == UnboundedString()
    assert (Array(BasicType("uint8"), 16),) == UUID.SLOT_TYPES
    assert SolidPrimitive.SLOT_TYPES[1] == BoundedSequence(BasicType("double"), 3)
    assert Strings.SLOT_TYPES[6] == BoundedString(22) != BoundedString(21)
    assert WStrings.SLOT_TYPES[-1] == UnboundedSequence(UnboundedWString())
    assert Empty.SLOT_TYPES == ()
    assert Twist.SLOT_TYPES is Twist.SLOT_TYPES


def test_services() -> None:
    assert SetBool.Request(data=True).data is True
    assert SetBool.Response().success is False
    with pytest.raises(NotImplementedError, match="Service classes can not be instantiated"):
        SetBool()
    assert type(SetBool).__name__ == "Metaclass_SetBool"


def test_actions() -> None:
    goal = RotateAbsolute.Goal(theta=1.5)
    request = RotateAbsolute.Impl.SendGoalService.Request(goal=goal)
    assert request.goal.theta == 1.5
    assert refused(request, "goal", RotateAbsolute.Result()) == (
        "The 'goal' field must be a sub message of type 'RotateAbsolute_Goal'"
    )
    assert RotateAbsolute.Impl.GetResultService.Response().get_fields_and_field_types() == {
        "status": "int8",
        "result": "turtlesim/RotateAbsolute_Result",
    }
    feedback = RotateAbsolute.Impl.FeedbackMessage(feedback=RotateAbsolute.Feedback(remaining=0.5))
    assert feedback.feedback.remaining == 0.5
    assert RotateAbsolute.Impl.CancelGoalService is CancelGoal
    assert RotateAbsolute.Impl.GoalStatusMessage is GoalStatusArray
    with pytest.raises(NotImplementedError, match="Action classes can not be instantiated"):
        RotateAbsolute()


def test_type_support_is_what_rclpy_looks_for() -> None:
    assert Twist.__class__._TYPE_SUPPORT is None
    Twist.__class__.__import_type_support__()
    assert Twist.__class__._TYPE_SUPPORT is not None
    assert Pose.__class__._TYPE_SUPPORT is None
