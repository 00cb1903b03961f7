"""rosidl_runtime_py: classes from names, messages from plain data and back."""

import pytest
from geometry_msgs.msg import Point32, Polygon, Twist
from nav_msgs.msg import Odometry
from rosidl_parser.definition import NamespacedType
from rosidl_runtime_py import (
    get_action_interfaces,
    get_interface_packages,
    get_interfaces,
    get_message_interfaces,
    get_message_slot_types,
    get_service_interfaces,
    import_message_from_namespaced_type,
    message_to_csv,
    message_to_ordereddict,
    message_to_yaml,
    set_message_fields,
)
from rosidl_runtime_py.utilities import (
    get_action,
    get_message,
    get_namespaced_type,
    get_service,
    is_action,
    is_message,
    is_service,
)
from sensor_msgs.msg import JointState, LaserScan, PointField
from builtin_interfaces.msg import Time
from geometry_msgs.msg import PoseStamped
from std_msgs.msg import ByteMultiArray, Empty, Float64, Header, String
from turtlesim.action import RotateAbsolute
from turtlesim.srv import Spawn


def test_classes_by_name() -> None:
    assert get_message("geometry_msgs/msg/Twist") is Twist
    assert get_service("turtlesim/srv/Spawn") is Spawn
    assert get_action("turtlesim/action/RotateAbsolute") is RotateAbsolute
    with pytest.raises(ValueError, match="Expected the full name of a message, got 'turtlesim/srv/Spawn'"):
        get_message("turtlesim/srv/Spawn")
    with pytest.raises(ValueError, match="Expected the full name"):
        get_message("Twist")
    with pytest.raises(AttributeError):
        get_message("geometry_msgs/msg/Twits")
    with pytest.raises(ModuleNotFoundError):
        get_message("geometry_msg/msg/Twist")


def test_setting_fields_converts() -> None:
    twist = Twist()
    set_message_fields(twist, {"linear": {"x": 1}, "angular": {"z": "0.5"}})
    assert (twist.linear.x, twist.angular.z) == (1.0, 0.5)
    polygon = Polygon()
    set_message_fields(polygon, {"points": [{"x": 1}, {"y": 2.0}]})
    assert [(p.x, p.y) for p in polygon.points] == [(1.0, 0.0), (0.0, 2.0)]
    scan = LaserScan()
    set_message_fields(scan, {"ranges": [1, 2.5], "header": {"frame_id": "laser"}})
    assert (list(scan.ranges), scan.header.frame_id) == ([1.0, 2.5], "laser")
    odometry = Odometry()
    set_message_fields(odometry, {"pose": {"covariance": [1] * 36}})
    assert odometry.pose.covariance.tolist() == [1.0] * 36
    with pytest.raises(AttributeError):
        set_message_fields(twist, {"liner": {}})
    with pytest.raises(TypeError, match="is expected to be a dictionary but is a float"):
        set_message_fields(twist, {"linear": 1.0})


def test_plain_data() -> None:
    values = message_to_ordereddict(Twist())
    assert list(values) == ["linear", "angular"]
    assert values["linear"] == {"x": 0.0, "y": 0.0, "z": 0.0}
    assert message_to_ordereddict(LaserScan(ranges=[1.0, 2.0, 3.0]), truncate_length=2)["ranges"] == [
        1.0,
        2.0,
        "...",
    ]
    assert message_to_ordereddict(String(data="hello"), truncate_length=3)["data"] == "hel..."


def test_text() -> None:
    assert message_to_yaml(Twist()).splitlines() == [
        "linear:",
        "  x: 0.0",
        "  y: 0.0",
        "  z: 0.0",
        "angular:",
        "  x: 0.0",
        "  y: 0.0",
        "  z: 0.0",
    ]
    assert message_to_yaml(LaserScan(ranges=[1.0])).splitlines()[-3:] == [
        "ranges:",
        "- 1.0",
        "intensities: []",
    ]
    assert message_to_csv(Twist()) == "0.0,0.0,0.0,0.0,0.0,0.0"


@pytest.mark.parametrize(
    ("message", "text"),
    [
        (Float64(data=float("inf")), "data: .inf"),
        (Float64(data=float("nan")), "data: .nan"),
        (Float64(data=1e17), "data: 1.0e+17"),
        (String(data="yes"), "data: 'yes'"),
        (String(data="on top: 5"), "data: 'on top: 5'"),
        (String(data="go left"), "data: go left"),
        (String(data="你好"), "data: 你好"),
        (String(data="a\nb"), "data: 'a\n\n  b'"),
        (String(data="a\tb"), 'data: "a\\tb"'),
        (String(data="x " * 100), "data: '" + "x " * 100 + "'"),
        (String(data="5"), "data: '5'"),
        (String(), "data: ''"),
        (Polygon(points=[Point32()]), "points:\n- x: 0.0\n  y: 0.0\n  z: 0.0"),
        (Empty(), "{}"),
    ],
)
def test_text_is_that_of_pyyaml(message: object, text: str) -> None:
    assert message_to_yaml(message) == text + "\n"


def test_values_between_commas() -> None:
    assert message_to_csv(JointState(name=["a", "b"], position=[1.0])) == "0,0,,a,b,1.0,,"
    assert message_to_csv(JointState(name=["a"] * 3), truncate_length=1) == "0,0,,a,...,,,"
    assert message_to_csv(Header(frame_id="map")) == "0,0,map"
    assert message_to_csv(JointState(name=["", "b"])) == "0,0,,b,,,"
    assert message_to_csv(PointField(name="", offset=1)) == "1,0,0"


def test_arrays_and_texts_may_be_shown_by_their_size() -> None:
    shown = message_to_ordereddict(Odometry(child_frame_id="base"), no_arr=True, no_str=True)
    assert shown["pose"]["covariance"] == "<array type: double[36]>"
    assert shown["child_frame_id"] == "<string length: <4>>"
    assert message_to_ordereddict(Polygon(), no_arr=True)["points"] == (
        "<sequence type: geometry_msgs/msg/Point32, length: 0>"
    )
    assert message_to_csv(String(data="abc"), no_str=True) == "<string length: <3>>"
    assert message_to_csv(LaserScan(ranges=[1.0, 2.0]), no_arr=True).endswith(
        "<sequence type: float, length: 2>,<sequence type: float, length: 0>"
    )
    assert message_to_yaml(String(data="abc"), flow_style=True) == "{data: abc}\n"
    assert message_to_yaml(Polygon(points=[]), flow_style=True) == "{points: []}\n"


def test_bytes_are_texts_in_yaml_and_literals_in_csv() -> None:
    message = ByteMultiArray(data=[b"a"])
    assert message_to_ordereddict(message)["data"] == ["a"]
    assert message_to_csv(message).endswith(",b'a'")


def test_times_may_be_set_later() -> None:
    pose = PoseStamped()
    (set_stamp,) = set_message_fields(pose, {"header": "auto"}, expand_header_auto=True)
    set_stamp(Time(sec=3))
    assert pose.header.stamp.sec == 3
    (set_stamp,) = set_message_fields(pose.header, {"stamp": "now"}, expand_time_now=True)
    set_stamp(Time(sec=4))
    assert pose.header.stamp.sec == 4
    assert set_message_fields(pose, {"header": {"frame_id": "map"}}) == []
    with pytest.raises(TypeError, match="expected to be a dictionary but is a str"):
        set_message_fields(pose, {"header": "auto"})


def test_names_without_their_kind_and_kinds_of_classes() -> None:
    assert get_message("geometry_msgs/Twist") is Twist
    assert get_service("turtlesim/Spawn") is Spawn
    assert get_action("turtlesim/RotateAbsolute") is RotateAbsolute
    assert get_namespaced_type("std_msgs/msg/String") == NamespacedType(["std_msgs", "msg"], "String")
    assert import_message_from_namespaced_type(get_namespaced_type("std_msgs/msg/String")) is String
    feedback = get_namespaced_type("turtlesim/action/RotateAbsolute_FeedbackMessage")
    assert import_message_from_namespaced_type(feedback) is RotateAbsolute.Impl.FeedbackMessage
    assert [is_message(each) for each in (Twist, Spawn, RotateAbsolute)] == [True, False, False]
    assert [is_service(each) for each in (Twist, Spawn, RotateAbsolute)] == [False, True, False]
    assert [is_action(each) for each in (Twist, Spawn, RotateAbsolute)] == [False, False, True]
    assert list(get_message_slot_types(Twist())) == ["linear", "angular"]


def test_what_interfaces_packages_have() -> None:
    assert {"turtlesim", "std_msgs"} <= set(get_interface_packages())
    assert get_interfaces(["tf2_msgs"])["tf2_msgs"] == [
        "action/LookupTransform",
        "msg/TF2Error",
        "msg/TFMessage",
        "srv/FrameGraph",
    ]
    assert get_message_interfaces(["turtlesim", "rclpy"]) == {"turtlesim": ["msg/Color", "msg/Pose"]}
    assert "srv/Spawn" in get_service_interfaces()["turtlesim"]
    assert get_action_interfaces(["turtlesim"]) == {"turtlesim": ["action/RotateAbsolute"]}
    with pytest.raises(LookupError, match="Unknown package 'nothing'"):
        get_interfaces(["nothing"])
