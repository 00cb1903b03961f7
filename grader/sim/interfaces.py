"""The ROS 2 interfaces the simulated world speaks, as a table: type name -> its fields in order.

These descriptions are the trusted side's own copy (ROS 2 Humble definitions; services and actions expanded
as rosidl does it). The student's side is generated from `interfaces/`; a test holds the two together.
A field is ``(name, type)``; a type is a primitive, a key of this table, or either with ``[]``, ``[n]`` or
``[<=n]``; ``string<n>`` has at most n characters. Only calls of a script's services may have other types than
these: those of its assignment's own interfaces, and of all that ROS has (`with_interfaces`).
"""

import ast
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import Any, Final, TypeAlias

from grader.contracts.assignment import InterfaceDefinition
from grader.sim.car import NS_PER_S, cos_sin, fold

Fields: TypeAlias = tuple[tuple[str, str], ...]

_STANDARD: Final = Path(__file__).resolve().parents[1] / "shim" / "rosidl_data" / "humble.txt"
_NAMES: Final = {"boolean": "bool", "octet": "uint8", "float": "float32", "double": "float64"}

_TIME = "builtin_interfaces/msg/Time"
_HEADER = "std_msgs/msg/Header"
_POINT = "geometry_msgs/msg/Point"
_VECTOR3 = "geometry_msgs/msg/Vector3"
_QUATERNION = "geometry_msgs/msg/Quaternion"
_TWIST = "geometry_msgs/msg/Twist"
_POSE = "geometry_msgs/msg/Pose"
_UUID = "unique_identifier_msgs/msg/UUID"
_GOAL_INFO = "action_msgs/msg/GoalInfo"
_ROTATE = "turtlesim/action/RotateAbsolute"
_SUCCESS: Fields = (("success", "bool"), ("message", "string"))

FIELDS: Final[dict[str, Fields]] = {
    "builtin_interfaces/msg/Time": (("sec", "int32"), ("nanosec", "uint32")),
    "builtin_interfaces/msg/Duration": (("sec", "int32"), ("nanosec", "uint32")),
    "unique_identifier_msgs/msg/UUID": (("uuid", "uint8[16]"),),
    "rosgraph_msgs/msg/Clock": (("clock", _TIME),),
    "rcl_interfaces/msg/Log": (
        ("stamp", _TIME),
        ("level", "uint8"),
        ("name", "string"),
        ("msg", "string"),
        ("file", "string"),
        ("function", "string"),
        ("line", "uint32"),
    ),
    "rcl_interfaces/msg/ParameterValue": (
        ("type", "uint8"),
        ("bool_value", "bool"),
        ("integer_value", "int64"),
        ("double_value", "float64"),
        ("string_value", "string"),
        ("byte_array_value", "uint8[]"),
        ("bool_array_value", "bool[]"),
        ("integer_array_value", "int64[]"),
        ("double_array_value", "float64[]"),
        ("string_array_value", "string[]"),
    ),
    "rcl_interfaces/msg/Parameter": (("name", "string"), ("value", "rcl_interfaces/msg/ParameterValue")),
    "rcl_interfaces/msg/IntegerRange": (("from_value", "int64"), ("to_value", "int64"), ("step", "uint64")),
    "rcl_interfaces/msg/FloatingPointRange": (
        ("from_value", "float64"),
        ("to_value", "float64"),
        ("step", "float64"),
    ),
    "rcl_interfaces/msg/ParameterDescriptor": (
        ("name", "string"),
        ("type", "uint8"),
        ("description", "string"),
        ("additional_constraints", "string"),
        ("read_only", "bool"),
        ("dynamic_typing", "bool"),
        ("floating_point_range", "rcl_interfaces/msg/FloatingPointRange[]"),
        ("integer_range", "rcl_interfaces/msg/IntegerRange[]"),
    ),
    "rcl_interfaces/msg/ListParametersResult": (("names", "string[]"), ("prefixes", "string[]")),
    "rcl_interfaces/msg/SetParametersResult": (("successful", "bool"), ("reason", "string")),
    "rcl_interfaces/srv/DescribeParameters_Request": (("names", "string[]"),),
    "rcl_interfaces/srv/DescribeParameters_Response": (
        ("descriptors", "rcl_interfaces/msg/ParameterDescriptor[]"),
    ),
    "rcl_interfaces/srv/GetParameters_Request": (("names", "string[]"),),
    "rcl_interfaces/srv/GetParameters_Response": (("values", "rcl_interfaces/msg/ParameterValue[]"),),
    "rcl_interfaces/srv/GetParameterTypes_Request": (("names", "string[]"),),
    "rcl_interfaces/srv/GetParameterTypes_Response": (("types", "uint8[]"),),
    "rcl_interfaces/srv/ListParameters_Request": (("prefixes", "string[]"), ("depth", "uint64")),
    "rcl_interfaces/srv/ListParameters_Response": (("result", "rcl_interfaces/msg/ListParametersResult"),),
    "rcl_interfaces/srv/SetParameters_Request": (("parameters", "rcl_interfaces/msg/Parameter[]"),),
    "rcl_interfaces/srv/SetParameters_Response": (("results", "rcl_interfaces/msg/SetParametersResult[]"),),
    "rcl_interfaces/srv/SetParametersAtomically_Request": (("parameters", "rcl_interfaces/msg/Parameter[]"),),
    "rcl_interfaces/srv/SetParametersAtomically_Response": (
        ("result", "rcl_interfaces/msg/SetParametersResult"),
    ),
    # std_msgs, std_srvs
    "std_msgs/msg/Empty": (),
    "std_msgs/msg/Bool": (("data", "bool"),),
    "std_msgs/msg/Float32": (("data", "float32"),),
    "std_msgs/msg/Float64": (("data", "float64"),),
    "std_msgs/msg/Int32": (("data", "int32"),),
    "std_msgs/msg/String": (("data", "string"),),
    "std_msgs/msg/Header": (("stamp", _TIME), ("frame_id", "string")),
    "std_srvs/srv/Empty_Request": (),
    "std_srvs/srv/Empty_Response": (),
    "std_srvs/srv/SetBool_Request": (("data", "bool"),),
    "std_srvs/srv/SetBool_Response": _SUCCESS,
    "std_srvs/srv/Trigger_Request": (),
    "std_srvs/srv/Trigger_Response": _SUCCESS,
    # geometry_msgs, nav_msgs, tf2_msgs
    "geometry_msgs/msg/Vector3": (("x", "float64"), ("y", "float64"), ("z", "float64")),
    "geometry_msgs/msg/Point": (("x", "float64"), ("y", "float64"), ("z", "float64")),
    "geometry_msgs/msg/Quaternion": (("x", "float64"), ("y", "float64"), ("z", "float64"), ("w", "float64")),
    "geometry_msgs/msg/Pose": (("position", _POINT), ("orientation", _QUATERNION)),
    "geometry_msgs/msg/PoseWithCovariance": (("pose", _POSE), ("covariance", "float64[36]")),
    "geometry_msgs/msg/Twist": (("linear", _VECTOR3), ("angular", _VECTOR3)),
    "geometry_msgs/msg/TwistStamped": (("header", _HEADER), ("twist", _TWIST)),
    "geometry_msgs/msg/TwistWithCovariance": (("twist", _TWIST), ("covariance", "float64[36]")),
    "geometry_msgs/msg/Transform": (("translation", _VECTOR3), ("rotation", _QUATERNION)),
    "geometry_msgs/msg/TransformStamped": (
        ("header", _HEADER),
        ("child_frame_id", "string"),
        ("transform", "geometry_msgs/msg/Transform"),
    ),
    "nav_msgs/msg/Odometry": (
        ("header", _HEADER),
        ("child_frame_id", "string"),
        ("pose", "geometry_msgs/msg/PoseWithCovariance"),
        ("twist", "geometry_msgs/msg/TwistWithCovariance"),
    ),
    "tf2_msgs/msg/TFMessage": (("transforms", "geometry_msgs/msg/TransformStamped[]"),),
    # action_msgs
    "action_msgs/msg/GoalInfo": (("goal_id", _UUID), ("stamp", _TIME)),
    "action_msgs/msg/GoalStatus": (("goal_info", _GOAL_INFO), ("status", "int8")),
    "action_msgs/msg/GoalStatusArray": (("status_list", "action_msgs/msg/GoalStatus[]"),),
    "action_msgs/srv/CancelGoal_Request": (("goal_info", _GOAL_INFO),),
    "action_msgs/srv/CancelGoal_Response": (("return_code", "int8"), ("goals_canceling", _GOAL_INFO + "[]")),
    # turtlesim
    "turtlesim/msg/Pose": (
        ("x", "float32"),
        ("y", "float32"),
        ("theta", "float32"),
        ("linear_velocity", "float32"),
        ("angular_velocity", "float32"),
    ),
    "turtlesim/msg/Color": (("r", "uint8"), ("g", "uint8"), ("b", "uint8")),
    "turtlesim/srv/Kill_Request": (("name", "string"),),
    "turtlesim/srv/Kill_Response": (),
    "turtlesim/srv/SetPen_Request": (
        ("r", "uint8"),
        ("g", "uint8"),
        ("b", "uint8"),
        ("width", "uint8"),
        ("off", "uint8"),
    ),
    "turtlesim/srv/SetPen_Response": (),
    "turtlesim/srv/Spawn_Request": (
        ("x", "float32"),
        ("y", "float32"),
        ("theta", "float32"),
        ("name", "string"),
    ),
    "turtlesim/srv/Spawn_Response": (("name", "string"),),
    "turtlesim/srv/TeleportAbsolute_Request": (("x", "float32"), ("y", "float32"), ("theta", "float32")),
    "turtlesim/srv/TeleportAbsolute_Response": (),
    "turtlesim/srv/TeleportRelative_Request": (("linear", "float32"), ("angular", "float32")),
    "turtlesim/srv/TeleportRelative_Response": (),
    f"{_ROTATE}_Goal": (("theta", "float32"),),
    f"{_ROTATE}_Result": (("delta", "float32"),),
    f"{_ROTATE}_Feedback": (("remaining", "float32"),),
    f"{_ROTATE}_SendGoal_Request": (("goal_id", _UUID), ("goal", f"{_ROTATE}_Goal")),
    f"{_ROTATE}_SendGoal_Response": (("accepted", "bool"), ("stamp", _TIME)),
    f"{_ROTATE}_GetResult_Request": (("goal_id", _UUID),),
    f"{_ROTATE}_GetResult_Response": (("status", "int8"), ("result", f"{_ROTATE}_Result")),
    f"{_ROTATE}_FeedbackMessage": (("goal_id", _UUID), ("feedback", f"{_ROTATE}_Feedback")),
}
"""Every type the world can read or write. An empty tuple is an empty structure (one byte on the wire)."""

DEFAULTS: Final[dict[str, dict[str, Any]]] = {_QUATERNION: {"w": 1.0}}
"""Field defaults other than zero, empty and False."""


class Types:
    """The types that the trusted side reads and writes: by the full name, fields and defaults."""

    def __init__(self, fields: Mapping[str, Fields], defaults: Mapping[str, Mapping[str, Any]]) -> None:
        self.fields = fields
        self.defaults = defaults
        self.readers: dict[
            str, Callable[[bytes, int], tuple[Any, int]]
        ] = {}  # of `grader.sim.cdr`, when made


WORLD: Final = Types(FIELDS, DEFAULTS)
"""What the world itself speaks."""


def with_interfaces(own: Iterable[InterfaceDefinition]) -> Types:
    """Return the types that an assignment's calls may have: its own interfaces, and all of ROS's."""
    lines = tuple(each.lines for each in own)
    return _types_with(lines) if lines else _standard_types()


@cache
def _standard_types() -> Types:
    return _types_with(())


def _types_with(own: tuple[str, ...]) -> Types:
    fields, defaults = dict(FIELDS), dict(DEFAULTS)
    entries = _STANDARD.read_text("utf-8").split("\n@")[1:]
    for entry in (*entries, *own):
        for name, members in _structures(entry):
            fields[name] = tuple((field[0], _trusted(field[1])) for field in members)
            literals = {field[0]: ast.literal_eval(field[2]) for field in members if len(field) > 2}
            if literals:
                defaults[name] = {field: _plain(value) for field, value in literals.items()}
    return Types({**fields, **FIELDS}, {**defaults, **DEFAULTS})


def stamp(t_ns: int) -> dict[str, int]:
    """Return `t_ns` as builtin_interfaces/msg/Time."""
    return {"sec": t_ns // NS_PER_S, "nanosec": t_ns % NS_PER_S}


def header(t_ns: int, frame: str) -> dict[str, Any]:
    """Return std_msgs/msg/Header of the instant `t_ns`."""
    return {"stamp": stamp(t_ns), "frame_id": frame}


def quaternion(heading_rad: float) -> dict[str, float]:
    """Return geometry_msgs/msg/Quaternion of a heading in the plane."""
    w, z = cos_sin(fold(heading_rad) / 2.0)
    return {"z": z, "w": w}


def _structures(entry: str) -> Iterator[tuple[str, list[list[str]]]]:
    """Yield the structures of an entry of the data file: full name, and name, type and default of each field."""
    head, *parts = entry.split("\n=")
    namespace = head.partition(" ")[0].rpartition("/")[0]
    for part in parts:
        name, *members = part.rstrip("\n").split("\n")
        yield f"{namespace}/{name}", [each.split(" ", 2) for each in members if each[0] != "!"]


def _trusted(idl: str) -> str:
    """Return the name that this table has for a type of the data file: ``double[3]`` -> ``float64[3]``."""
    base, bracket, count = idl.partition("[")
    return _NAMES.get(base, base) + bracket + count


def _plain(value: Any) -> Any:
    """Return a default as plain data; an octet is a number."""
    if isinstance(value, list):
        return [_plain(each) for each in value]
    return value[0] if isinstance(value, bytes) else value
