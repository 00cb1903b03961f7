"""What an unknown name, attribute or module means: misspelt, of something else, or defined elsewhere."""

import builtins
import difflib
import re
from typing import Final

from grader.contracts.outcome import StudentError
from grader.messages.closer import Closer
from grader.messages.script import LONGEST_NAME, Assigned, Definition, ScriptText

SHELL: Final = (
    r"(apt|apt-get|bash|cat|cd|chmod|colcon|cp|export|git|ls|mkdir|mv|nano|pip3?|python3?|rm|ros2|sh|source|"
    r"sudo)"
)

_SUGGESTION: Final = re.compile(r"\. Did you mean: '(\w+)'\?\s*$")
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

IMPORTS: Final = (
    {name: f"from {module} import {name}" for module, names in _NAMES_BY_MODULE.items() for name in names}
    | {
        name: f"import {name}"
        for name in (
            "argparse",
            "asyncio",
            "json",
            "math",
            "os",
            "random",
            "rclpy",
            "sys",
            "threading",
            "time",
        )
    }
    | {"np": "import numpy as np", "numpy": "import numpy"}
)

_MODULES: Final = tuple(dict.fromkeys((
    *_NAMES_BY_MODULE, "geometry_msgs", "nav_msgs", "numpy", "random", "rclpy", "sensor_msgs", "std_msgs",
    "std_srvs", "sys", "threading", "turtlesim", "argparse", "asyncio", "collections", "datetime", "json",
    "typing",
)))  # fmt: skip

_LIBRARIES_NOT_HERE: Final = frozenset((
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

_NODE_ATTRIBUTES: Final = (
    "create_client", "create_publisher", "create_rate", "create_service", "create_subscription", "create_timer",
    "declare_parameter", "destroy_node", "get_clock", "get_logger", "get_name", "get_parameter",
    "handle",
)  # fmt: skip
"""Attributes of Node that beginners use, or that `rclpy.spin` uses for them."""

_NODE_LISTS: Final = ("clients", "guards", "publishers", "services", "subscriptions", "timers", "waitables")
"""Python suggests these for `self.publisher` and the like, but the student meant a variable of their own."""

NODE_PROPERTIES: Final = tuple(sorted((*_NODE_LISTS, "context", "default_callback_group", "handle")))
"""Attributes of Node that break it if a method of the student's class takes their name."""

_NODE_METHODS: Final = (
    "create_client", "create_publisher", "create_service", "create_subscription", "create_timer",
    "declare_parameter", "declare_parameters", "get_clock", "get_logger", "get_parameter", "has_parameter",
    "set_parameters",
)  # fmt: skip
"""Methods of Node that it calls itself, or that a method of the student's class means to call by its own name."""
_OTHER_LANGUAGES: Final = {
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
_OF_ROS_1: Final = {
    "Rate": "time.sleep(0.1)",
    "Publisher": "node.create_publisher(Twist, '/turtle1/cmd_vel', 10)",
    "Subscriber": "node.create_subscription(Pose, '/turtle1/pose', callback, 10)",
    "init_node": "rclpy.init(); node = rclpy.create_node('my_node')",
    "is_shutdown": "not rclpy.ok()",
    "loginfo": "node.get_logger().info('...')",
    "sleep": "time.sleep(0.1)",
    "Time": "node.get_clock().now()",
    "Service": "node.create_service(SetBool, '/my_service', callback)",
    "ServiceProxy": "node.create_client(Spawn, '/spawn')",
    "Timer": "node.create_timer(0.1, callback)",
    "get_param": "node.declare_parameter('side', 2.0).value",
}
"""Attributes that ``rclpy`` does not have, each with what to write instead."""
_DURATION_OF_ROS_1: Final = {
    "to_sec": ".nanoseconds / 1e9",
    "to_nsec": ".nanoseconds",
    "secs": ".nanoseconds / 1e9",
    "nsecs": ".nanoseconds",
    "seconds": ".nanoseconds / 1e9",
}
"""Attributes of times and durations in ROS 1, each with what ROS 2 has instead."""
_WORDS: Final = ("self", "True", "False", "None", "break", "continue", "pass", "return")
"""Words of Python, for which it suggests nothing where letters changed places."""
_NAMING: Final = r"\b__init__|\bNode|\bcreate_node|\b(?:get|declare|has)_parameter"
"""Calls whose first argument is a name, which is text."""
NEAR: Final = 0.75
_NODE_OF_ROS_1: Final = {
    "advertise": "create_publisher(Twist, '/turtle1/cmd_vel', 10)",
    "subscribe": "create_subscription(Pose, '/turtle1/pose', callback, 10)",
    "get_param": "declare_parameter('side', 2.0).value",
    "loginfo": "get_logger().info('...')",
    "logwarn": "get_logger().warning('...')",
    "logerr": "get_logger().error('...')",
}
"""What a node had in ROS 1, or what ``rospy`` had, each with what a node of ROS 2 has."""
_MEANT_OF_NODE: Final = {
    "create_sub": "create_subscription",
    "create_subscriber": "create_subscription",
    "create_pub": "create_publisher",
    "logger": "get_logger()",
    "clock": "get_clock()",
    "get_time": "get_clock().now()",
    "now": "get_clock().now()",
}
"""What Node does not have under these names, for which Python suggests something far from it."""
_FIELDS: Final = {
    "Odometry": "pose.pose.position (x, y, z), pose.pose.orientation, twist.twist (linear, angular)",
    "PoseWithCovariance": "pose.position (x, y, z), pose.orientation (x, y, z, w)",
    "TwistWithCovariance": "twist.linear (x, y, z), twist.angular (x, y, z)",
    "LaserScan": "ranges, angle_min, angle_max, angle_increment, range_min, range_max",
}
"""The fields of the messages that beginners read."""
_FIELDS_OF_POSE: Final = {
    "turtlesim": "x, y, theta, linear_velocity, angular_velocity",
    "geometry_msgs": "position (x, y, z), orientation (x, y, z, w)",
}
TURTLE: Final = r"^[ \t]*(import[ \t]+turtle\b|from[ \t]+turtle[ \t]+import)"


def suggested(error: StudentError) -> str | None:
    """Return the name that Python suggests instead of an unknown one; None if it suggests none."""
    found = _SUGGESTION.search(error.traceback)
    return None if found is None or re.match(r"_(?!_)", found[1]) else found[1]


def _of_ros_1(used: str, name: str, line: int, script: ScriptText) -> Closer:
    """Say what ROS 2 has instead, with the node as it is called on that line."""
    instead = _OF_ROS_1.get(name, "rclpy").replace("node.", f"{script.node_name_at(line)}.")
    if script.lines_with(r"\brclpy\.init\("):
        instead = instead.removeprefix("rclpy.init(); ")
    return "ros_1_habit", {"name": used, "instead": instead}


def is_of_node(owner: str | None, name: str, script: ScriptText) -> bool:
    """Whether a class of the script, a node it seems, has a method under the name of one of Node's."""
    made = script.definition(name) if owner and name in _NODE_METHODS else None
    return made is not None and made.takes_self and not script.class_without_base(owner or "")


def _name(error: StudentError, script: ScriptText) -> Closer:
    """Look closer at an unknown name."""
    found = re.match(r"name '(\w+)' is not defined", error.message)
    if found is None:
        return None
    name = found[1]
    written = script_line(error)
    if re.fullmatch(SHELL, name) and re.match(rf"{SHELL}([ \t]+[-~/.\w].*)?$", written):
        return "shell_line", {}
    if name in {"name", "main"} and re.match(r"if\b", written):
        return "underscores", {}
    if name == "rospy":
        used = re.search(r"\brospy\.(\w+)", written)
        return _of_ros_1(used[0] if used else name, used[1] if used else "", error.line or 0, script)
    if name in _OTHER_LANGUAGES:
        return "other_language", {"name": name, "instead": _OTHER_LANGUAGES[name]}
    if name in IMPORTS:
        return "missing_import", {"name": name, "statement": IMPORTS[name]}
    if (near := _respelt(name, written)) is not None:
        return "misspelt", {"suggestion": near}
    suggestion = suggested(error)
    if suggestion is None:
        return None
    is_class = re.search(rf"\b{name}[ \t]*\(|^class\b.*\({name}\b", written) is not None
    if not is_class and suggestion not in ("True", "False", "None") and _is_function(suggestion, name):
        return None  # `node`, which nobody made, is not the class `Node`, nor `size` the function `slice`
    return "misspelt", {"suggestion": suggestion}


def _respelt(name: str, written: str) -> str | None:
    """Return the module, or the word of Python, that is written with other capitals or its letters exchanged."""
    if IMPORTS.get(name.lower(), "").startswith("import ") and re.search(rf"\b{name}\.", written):
        return name.lower()
    return next((known for known in _WORDS if sorted(known) == sorted(name)), None)


def _is_function(suggestion: str, name: str) -> bool:
    """Whether Python suggests one of its own functions, or a class for the name of a variable."""
    return hasattr(builtins, suggestion) or (suggestion[:1].isupper() and name.islower())


def unknown_name(error: StudentError, script: ScriptText) -> Closer:
    """Look closer at an unknown name that may be a method of the student's own class."""
    found = re.match(r"name '(\w+)' is not defined", error.message)
    if found is None:
        return None
    name, line, written = found[1], error.line or 0, script_line(error)
    if re.search(rf"({_NAMING})\([ \t]*{name}[ \t]*[,)]", written) or _is_text(name, written, script):
        return "name_without_quotes", {"name": name}
    node = script.node_name_at(line)
    made = script.definition(name)
    if made is not None and made.takes_self:
        called = re.search(rf"\b{name}[ \t]*\(", written) is not None
        return _of_node(name, "(...)" if called else "", line, script)
    if made is not None and script.owner_of(made.line) is not None:
        return "function_inside", {"name": name, "begins": made.line}
    if name in _NODE_ATTRIBUTES and script.in_method(line):
        return "missing_self", {"name": name, "call": "(...)"}
    if (given := _assigned_in_class(name, script)) and line not in given:
        if node != "self":
            return "missing_object", {"name": name, "object": node, "call": ""}
        return "missing_self_value", {"name": name, "given": given[0]}
    if (local := script.assigned(name)) is not None and (
        closer := _of_other(local, line, script)
    ) is not None:
        return closer
    if script.node_class and name not in ("rospy", *_OTHER_LANGUAGES) and _is_node(name, written):
        return _node_meant(name, line, script)
    return _nearest_own(name, line, script, _name(error, script))


def _node_meant(name: str, line: int, script: ScriptText) -> Closer:
    """Say what the function around a line calls its node, or else that it makes none."""
    made = script.matches(rf"^[ \t]*(\w+) ?= ?{script.node_class}\(")
    around = script.function_around(line)
    nodes = [found[1] for at, found in made if at < line and script.function_around(at) == around]
    if nodes:
        return "misspelt", {"suggestion": nodes[-1]}
    return "node_not_made", {"name": name, "owner": script.node_class}


def _of_node(name: str, call: str, line: int, script: ScriptText) -> Closer:
    """Say that a method belongs to the object, and what that is called on the line."""
    node = script.node_name_at(line)
    code = "missing_self" if node == "self" else "missing_object"
    return code, {"name": name, "call": call, "object": node}


def _is_text(name: str, written: str, script: ScriptText) -> bool:
    """Whether a line assigns, or compares with, what others do in quotes: the name of a state."""
    quoted = "\n".join(script.written(line) for line in script.lines_with('""'))
    taken = re.search(rf"(=|\bis( not)?) ?{name}( ?[:#]|$)", written)
    return taken is not None and re.search(rf"= ?[\"']{name}[\"']", quoted) is not None


def _assigned_in_class(name: str, script: ScriptText) -> list[int]:
    """Return the lines that assign an attribute: ``self.name = ...``, or ``name = ...`` in the class itself."""
    own = script.lines_with(rf"\bself\.{re.escape(name)}[ \t]*(:[^=]*)?=(?!=)")
    plain = script.lines_with(rf"^[ \t]+{re.escape(name)} ?(:[^=]*)?=(?!=)")
    owners = ((number, script.owner_of(number)) for number in plain)
    return own or [n for n, above in owners if above and re.match(r"[ \t]*class\b", script.lines[above - 1])]


def _nearest_own(name: str, line: int, script: ScriptText, otherwise: Closer) -> Closer:
    """Prefer a similar function or class of the script, not defined yet when it failed, to Python's suggestion."""
    if otherwise is not None and otherwise[0] != "misspelt":
        return otherwise
    if not script.is_short or len(name) > LONGEST_NAME:
        return otherwise
    text = "".join(script.lines[line - 1 : line])
    if name == "publish" and script.publisher and not re.search(r"\bpublish\(([^()]*,| ?-?\d)", text):
        return "publish_left_out", {"publisher": script.publisher}
    if script.publisher and re.search(rf"(?<![\w.]){name}\.publish\(", text):
        return "misspelt", {"suggestion": script.publisher}
    if (message := script.twist_name_at(line)) is not None:
        sent = script.lines_with(rf"\.publish\( ?{re.escape(message)} ?\)")
        around = {script.function_around(at) for at in sent}  # where it is sent, another one is missing
        if script.function_around(line) not in around and re.search(
            rf"\.publish\( ?{name} ?\)|(?<![\w.]){name}\.(linear|angular)\b", text
        ):
            return "misspelt", {"suggestion": message}
        if name in ("linear", "angular"):
            return "misspelt", {"suggestion": f"{message}.{name}"}
    if name in script.defined_names:
        begins = script.lines_with(rf"^(def|class) {name}\b")[-1]
        return ("defined_below", {"name": name, "begins": begins}) if begins > line else None
    near = difflib.get_close_matches(name, script.defined_names, 1, NEAR)
    return ("misspelt", {"suggestion": near[0]}) if near else otherwise


def _of_other(local: Assigned, line: int, script: ScriptText) -> Closer:
    """Look at a name that another function than the one around `line` assigns."""
    around = script.function_around(local.line), script.function_around(line)
    if not all(around) or around[0] == around[1]:
        return None
    if script.in_method(line) and local.value.startswith(f"{script.node_class}("):
        return "node_is_self", {"name": local.name, "given": local.line}
    if re.search(r"\b(now|time)\(", local.value):
        return None  # each of the functions takes a time of its own
    both = script.in_method(line) and script.in_method(local.line)
    code = "local_of_method" if both else "local_of_function"
    return code, {"name": local.name, "given": local.line, "function": around[0]}


def _is_node(name: str, written: str) -> bool:
    """Whether the line takes what `name` stands for to be a node."""
    taken = rf"\bspin\w*\([ \t]*{name}\b|\b{name}\.(destroy_node|get_\w+|create_\w+)\("
    return re.search(taken, written) is not None


def unknown_attribute(error: StudentError, script: ScriptText) -> Closer:
    """Look closer at an unknown attribute."""
    found = re.match(r"'(\w+)' object has no attribute '(\w+)'", error.message)
    closer = _of_module(error, script) if found is None else _of_object(found[1], found[2], error, script)
    if closer is not None:
        return closer
    suggestion = suggested(error)
    own_name = found is not None and _has_no_value_yet(found[2], suggestion, script)
    if suggestion is not None and suggestion not in _NODE_LISTS and not own_name:
        return "misspelt", {"suggestion": suggestion}
    if found is not None and (closer := _message_fields(found[1], found[2], script)) is not None:
        return closer
    own = found is not None and script.class_line(found[1]) is not None
    return None if own or not script.has_code else ("unknown_in_library", {})


def _has_no_value_yet(name: str, suggestion: str | None, script: ScriptText) -> bool:
    """Whether an attribute is the script's own: it is given a value, or added to and similar to a method only."""
    if script.lines_with(rf"\bself\.{re.escape(name)} ?(:[^=]*)?=(?!=)"):
        return True
    counted = script.lines_with(rf"\bself\.{re.escape(name)} ?([-+*/]|//)=")
    return bool(counted) and suggestion is not None and script.definition(suggestion) is not None


def _of_module(error: StudentError, script: ScriptText) -> Closer:
    """Look closer at what a module has not."""
    if error.message == "type object 'Time' has no attribute 'now'":
        return "ros_1_habit", {
            "name": "Time.now()",
            "instead": f"{script.node_name_at(error.line or 0)}.get_clock().now()",
        }
    found = re.match(r"module '(\w+)' has no attribute '(\w+)'", error.message)
    if found is None:
        return None
    module, name = found.groups()
    if module == "time" and name in ("now", "clock"):
        return "misspelt", {"suggestion": "time.time()"}
    if module == "rclpy" and name in _OF_ROS_1:
        return _of_ros_1(f"rclpy.{name}", name, error.line or 0, script)
    if module == "rclpy" and name in _NODE_ATTRIBUTES:
        return _of_node(name, "(...)", error.line or 0, script)
    if module == "rclpy" and IMPORTS.get(name, "").startswith("from rclpy."):
        return "not_in_module", {"name": name, "statement": IMPORTS[name]}
    if name in ("msg", "srv", "action") or f"{module}.{name}" in _MODULES:
        return "import_statement", {"statement": f"import {module}.{name}"}
    return None


def _of_object(owner: str, name: str, error: StudentError, script: ScriptText) -> Closer:
    """Look closer at what an object has not."""
    is_node = owner in ("Node", script.node_class)
    if name in ("spin", "spin_once") and is_node:
        return "spin_of_rclpy", {"name": name}
    if is_node and name in _NODE_OF_ROS_1:
        node = script.node_name_at(error.line or 0)
        return "ros_1_habit", {"name": f"{node}.{name}", "instead": f"{node}.{_NODE_OF_ROS_1[name]}"}
    if owner == "Timer" and name in ("stop", "destroy", "close"):
        return "misspelt", {"suggestion": "cancel"}
    if owner in ("Duration", "Time") and name in _DURATION_OF_ROS_1:
        return "ros_1_habit", {"name": f".{name}", "instead": _DURATION_OF_ROS_1[name]}
    closer = _own_attribute(owner, name, script)
    if closer is None and is_node and name in _MEANT_OF_NODE:
        return "misspelt", {"suggestion": _MEANT_OF_NODE[name]}
    return closer or _of_an_object(name, script_line(error), script)


def _message_fields(kind: str, name: str, script: ScriptText) -> Closer:
    """Return the fields that a message has, instead of the one that was named."""
    fields = _FIELDS.get(kind)
    if kind == "Pose":
        packages = [one for one in _FIELDS_OF_POSE if script.lines_with(rf"\b{one}\.msg import\b.*\bPose\b")]
        fields = _FIELDS_OF_POSE[packages[0]] if len(packages) == 1 else None
    return None if fields is None else ("message_fields", {"type": kind, "name": name, "fields": fields})


def _of_an_object(name: str, written: str, script: ScriptText) -> Closer:
    """Look at how the attribute was used: to publish, or on a variable that hides a module of the same name."""
    if name == "publish":
        return "no_publisher_object", {"publisher": script.publisher or "self.pub"}
    own = script.publisher or ""
    if own.startswith("self.") and re.search(rf"\bself\.{name}\.publish\(", written):
        return "misspelt", {"suggestion": own}
    hidden = re.search(rf"\b(math|random|rclpy|time)\.{name}\b", written)
    return None if hidden is None else ("hidden_module", {"name": hidden[1]})


def _own_attribute(owner: str, name: str, script: ScriptText) -> Closer:
    """Look for the attribute in the student's own class."""
    begins = script.class_line(owner)
    if begins is None:
        return None
    if name in _NODE_ATTRIBUTES and script.class_without_base(owner):
        return "no_base_class", {"line": begins}
    made = script.definition(name)
    if made is not None and (around := script.owner_of(made.line)) != begins:
        return _defined_elsewhere(owner, name, made, around, script)
    given = script.lines_with(rf"\bself\.{re.escape(name)}[ \t]*(:[^=]*)?=(?!=)")
    if not given and (
        outside := script.lines_with(rf"^([\w ,]*, ?)?{re.escape(name)} ?(,[\w ,]*|:[^=]*)?=(?!=)")
    ):
        return "not_of_self", {"name": name, "given": outside[0], "call": ""}
    if len(given) == 1 and given[0] > begins:
        return "not_yet_assigned", {"name": name, "given": given[0]}
    known = (found[1] for _, found in script.matches(r"\bself\.(\w+)[ \t]*=(?!=)"))
    near = [one for one in known if one != name and one.lower() == name.lower()]
    if near:
        return "misspelt", {"suggestion": near[0]}
    local = [] if given else script.lines_with(rf"^[ \t]+{re.escape(name)}[ \t]*(:[^=]*)?=(?!=)")
    return _local(name, local[0], script) if local and local[0] > begins else None


def _defined_elsewhere(
    owner: str, name: str, made: Definition, block: int | None, script: ScriptText
) -> Closer:
    """Look at a ``def`` that is none of the class `owner`, and at the line that begins the block around it."""
    around = "" if block is None else script.lines[block - 1]
    if re.match(r"[ \t]*class\b", around):
        return None
    if (lost := re.match(r"def (\w+) ?\( ?self\b", around)) is not None:
        return "method_outside", {"name": lost[1], "owner": owner, "begins": block}
    if re.match(r"[ \t]*def\b", around):
        return "method_inside", {"name": name, "owner": owner, "begins": made.line}
    if not around and not made.takes_self:
        return "not_of_self", {"name": name, "given": made.line, "call": "(...)"}
    return "method_outside", {"name": name, "owner": owner, "begins": made.line}


def _local(name: str, given: int, script: ScriptText) -> Closer:
    """Look at a variable of a function that is used as if it were the object's."""
    used = {script.function_around(n) for n in script.lines_with(rf"\bself\.{re.escape(name)}\b")}
    if used == {script.function_around(given)}:
        return "not_of_self", {"name": name, "given": given, "call": ""}
    node = script.node_name_at(given)
    made = node == "self" or any(n < given for n in script.lines_with(rf"\b{node} ?=(?!=)"))
    return ("local_only", {"name": name, "given": given, "object": node}) if made else None


def unknown_module(error: StudentError, script: ScriptText) -> Closer:
    """Look closer at an import that failed."""
    found = re.match(r"No module named '([\w.]+)'", error.message)
    if found is None:
        return _imported_name(error)
    name = found[1]
    root = name.partition(".")[0]
    if root in ("_tkinter", "tkinter", "turtle"):
        return ("turtle_graphics" if script.lines_with(TURTLE) else "no_display"), {}
    if name.rpartition(".")[2] in _NAMES_BY_MODULE.get(name.rpartition(".")[0], ()):
        return "import_statement", {"statement": IMPORTS[name.rpartition(".")[2]]}
    if root in _LIBRARIES_NOT_HERE:
        return "library_not_here", {"name": root}
    near = [known for known in _MODULES if sorted(known) == sorted(name.lower())]
    near = near or difflib.get_close_matches(name, _MODULES, 1, 0.8)
    if re.search(r"\.msg\b|\bimport[ \t]+[A-Z]", script_line(error)):  # else it may be the author's own file
        near = near or [one for one in _MODULES if one.partition(".")[0] == f"{root}_msgs"][:1]
    known = near and near[0].partition(".")[0] != name  # the package itself is not there
    if not known and root.endswith(("_interfaces", "_interface", "_msgs", "_srvs", "_actions")):
        return "own_interfaces", {"name": root}
    return ("misspelt", {"suggestion": near[0]}) if known else None


def _is_of(known: str, name: str) -> bool:
    """Whether `known` can be meant: the module `time` is not by std_msgs' `Time`, which ROS 1 had."""
    return known == name or IMPORTS[known].startswith("from ")


def _imported_name(error: StudentError) -> Closer:
    found = re.match(r"cannot import name '(\w+)' from '([\w.]+)'", error.message)
    if found is None:
        return None
    name, module = found.groups()
    near = [known for known in IMPORTS if known.lower() == name.lower() and _is_of(known, name)]
    near = near or difflib.get_close_matches(name, _NAMES_BY_MODULE.get(module, ()), 1, 0.75)
    return ("import_statement", {"statement": IMPORTS[near[0]]}) if near else None


def script_line(error: StudentError) -> str:
    """Return the line that raised the exception, as the traceback shows it."""
    lines = error.traceback.splitlines()
    files = [i for i, line in enumerate(lines) if line.startswith("  File ")]
    return lines[files[-1] + 1].strip() if files and files[-1] + 1 < len(lines) else ""
