"""Message classes behave as rosidl_generator_py 0.14.4 (ROS 2 Humble) makes them."""

import array
import copy
import pickle

import numpy as np
import pytest
from action_msgs.msg import GoalStatusArray
from action_msgs.srv import CancelGoal
from geometry_msgs.msg import Point, Pose, PoseWithCovariance, Quaternion, Twist, Vector3
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
from std_msgs.msg import Empty, Header
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
from turtlesim.srv import Spawn
from unique_identifier_msgs.msg import UUID
from visualization_msgs.msg import Marker

from tests.shim.interfaces.refusal import refused


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
