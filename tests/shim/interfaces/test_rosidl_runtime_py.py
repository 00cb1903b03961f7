"""rosidl_runtime_py: classes from names, messages from plain data and back."""

import pytest
from geometry_msgs.msg import Polygon, Twist
from nav_msgs.msg import Odometry
from rosidl_runtime_py import message_to_csv, message_to_ordereddict, message_to_yaml, set_message_fields
from rosidl_runtime_py.utilities import get_action, get_message, get_service
from sensor_msgs.msg import LaserScan
from std_msgs.msg import String
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
