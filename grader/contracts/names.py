"""Names that scripts of this course use: whose they are, what other languages call them, which one is near."""

import difflib
from collections.abc import Iterable
from typing import Final

_NEAR: Final = 0.75
_LONGEST: Final = 60  # to compare two names takes the product of their lengths
_NAMES_BY_MODULE: Final = {
    "geometry_msgs.msg": ("Point", "PoseStamped", "Quaternion", "Twist", "TwistStamped", "Vector3"),
    "nav_msgs.msg": ("Odometry", "Path"),
    "sensor_msgs.msg": ("Image", "Imu", "LaserScan"),
    "std_msgs.msg": ("Bool", "Float32", "Float64", "Int32", "String"),
    "std_srvs.srv": ("Empty", "SetBool", "Trigger"),
    "rosclaw_msgs.srv": ("CallService", "GetCapabilities", "PublishMessage"),
    "turtlesim.msg": ("Color", "Pose"),
    "turtlesim.srv": ("Kill", "SetPen", "Spawn", "TeleportAbsolute", "TeleportRelative"),
    "rclpy.action": ("ActionClient", "ActionServer"),
    "rclpy.duration": ("Duration",),
    "rclpy.executors": ("MultiThreadedExecutor", "SingleThreadedExecutor"),
    "rclpy.node": ("Node",),
    "rclpy.parameter": ("Parameter",),
    "rclpy.qos": ("QoSProfile", "qos_profile_sensor_data"),
    "math": ("atan2", "cos", "degrees", "pi", "radians", "sin", "sqrt"),
    "time": ("sleep",),
    "threading": ("Thread",),
}
_WHOLE: Final = ("argparse", "asyncio", "json", "math", "os", "random", "rclpy", "sys", "threading", "time")
IMPORTS: Final = (
    {name: f"from {module} import {name}" for module, names in _NAMES_BY_MODULE.items() for name in names}
    | {name: f"import {name}" for name in _WHOLE}
    | {"np": "import numpy as np", "numpy": "import numpy"}
)
"""The statement that brings each name."""

MODULES: Final = tuple(
    dict.fromkeys(
        (*_NAMES_BY_MODULE, *(one.partition(".")[0] for one in _NAMES_BY_MODULE), *_WHOLE, "numpy", "typing")
    )
)

LIBRARIES_NOT_HERE: Final = frozenset((
    "PIL", "PyKDL", "RPi", "bs4", "controller_manager", "controller_manager_msgs", "cv2", "cv_bridge",
    "flask", "gazebo_msgs", "gazebo_ros", "gym", "gymnasium", "image_geometry", "imageio",
    "joint_state_publisher", "matplotlib", "mediapipe", "moveit", "moveit_commander", "moveit_configs_utils",
    "moveit_msgs", "mpl_toolkits", "nav2_common", "nav2_msgs", "nav2_simple_commander", "open3d", "openai",
    "pandas", "psutil", "pybullet", "pybullet_data", "pygame", "pymoveit2", "requests", "robot_localization",
    "robot_state_publisher", "ros_gz_interfaces", "scipy", "seaborn", "serial", "skimage", "sklearn",
    "slam_toolbox", "smbus", "spidev", "sympy", "tensorflow", "tf2_sensor_msgs", "torch", "torchvision",
    "tqdm", "transforms3d", "ultralytics", "urdf_parser_py", "usb", "xacro", "yolov5",
))  # fmt: skip
"""Libraries that a beginner's PC may have and that the sandbox has not."""

OTHER_LANGUAGES: Final = {
    "this": "self",
    "raw_input": "input()",
    "xrange": "range()",
    "unicode": "str()",
    "cout": "print()",
    "printf": "print()",
    "RCLCPP_INFO": "self.get_logger().info('...')",
    "ROS_INFO": "self.get_logger().info('...')",
    "true": "True",
    "false": "False",
    "null": "None",
    "NULL": "None",
    "nullptr": "None",
    "nil": "None",
    "none": "None",
    "π": "math.pi",
}
"""Names of Python 2, C++ and other languages, each with what Python 3 has instead."""

OF_ROS_1: Final = {
    "Rate": "time.sleep(0.1)",
    "Publisher": "node.create_publisher(Twist, '/turtle1/cmd_vel', 10)",
    "Subscriber": "node.create_subscription(Pose, '/turtle1/pose', callback, 10)",
    "init_node": "node = rclpy.create_node('my_node')",
    "is_shutdown": "not rclpy.ok()",
    "loginfo": "node.get_logger().info('...')",
    "sleep": "time.sleep(0.1)",
    "Time": "node.get_clock().now()",
    "Service": "node.create_service(SetBool, '/my_service', callback)",
    "ServiceProxy": "node.create_client(Spawn, '/spawn')",
    "Timer": "node.create_timer(0.1, callback)",
    "get_param": "node.declare_parameter('side', 2.0).value",
}
"""What ``rospy`` had, each with what to write instead."""

FIELDS: Final = {
    "Odometry": "pose.pose.position (x, y, z), pose.pose.orientation, twist.twist (linear, angular)",
    "LaserScan": "ranges, angle_min, angle_max, angle_increment, range_min, range_max",
}
"""The fields of the messages that beginners read."""

STATEMENTS: Final = (
    "break", "class", "continue", "def", "elif", "else", "except", "finally", "for", "from", "global", "if",
    "import", "pass", "raise", "return", "try", "while", "with",
)  # fmt: skip


def module_of(name: str) -> str:
    """Return the module from which a name is imported; empty where it is a module itself, or unknown."""
    statement = IMPORTS.get(name, "")
    return statement.split()[1] if statement.startswith("from ") else ""


def near_name(name: str, known: Iterable[str]) -> str | None:
    """Return the name that was probably meant: of the same letters, or else the most similar one."""
    if len(name) > _LONGEST:
        return None
    names = [one for one in known if len(one) <= _LONGEST]
    same = next((other for other in names if sorted(other.lower()) == sorted(name.lower())), None)
    return same or next(iter(difflib.get_close_matches(name, names, 1, _NEAR)), None)
