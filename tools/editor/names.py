"""Make grader/service/web/static/names.json: the names that the editor completes, as the shim has them.

``python tools/editor/names.py`` writes the file; ``names()`` returns what belongs into it.
"""

import json
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
OUT = ROOT / "grader" / "service" / "web" / "static" / "names.json"
_MODULES = (
    "rclpy", "rclpy.action", "rclpy.duration", "rclpy.executors", "rclpy.node", "rclpy.parameter", "rclpy.qos",
    "rclpy.time", "geometry_msgs.msg", "nav_msgs.msg", "sensor_msgs.msg", "std_msgs.msg", "std_srvs.srv",
    "turtlesim.action", "turtlesim.msg", "turtlesim.srv",
)  # fmt: skip
_OF_PYTHON = {  # what the course uses; Python's versions differ in the rest
    "math": [
        "atan2",
        "ceil",
        "cos",
        "degrees",
        "fabs",
        "floor",
        "hypot",
        "pi",
        "radians",
        "sin",
        "sqrt",
        "tan",
        "tau",
    ],
    "time": ["monotonic", "perf_counter", "sleep", "time"],
}
_MESSAGES = (
    "geometry_msgs.msg.Twist",
    "geometry_msgs.msg.Vector3",
    "turtlesim.msg.Pose",
    "turtlesim.msg.Color",
)
_OBJECTS = (
    "rclpy.publisher.Publisher", "rclpy.timer.Timer", "rclpy.clock.Clock", "rclpy.time.Time",
    "rclpy.client.Client", "rclpy.task.Future", "rclpy.impl.rcutils_logger.RcutilsLogger",
)  # fmt: skip
_LOOK = """
import importlib, json, sys
shim, modules, messages, objects = json.loads(sys.argv[1])
sys.path.insert(0, shim)
from rclpy._interfaces import importer

def of_module(name):
    module = importlib.import_module(name)
    listed = {one for one in {*dir(module), *getattr(module, "__all__", ())} if not one.startswith("_")}
    origin = {one: getattr(getattr(module, one), "__module__", "") for one in listed}
    # what it only imports is documented elsewhere
    return sorted(one for one in listed if (origin[one] or "").startswith(name) and not one.isupper())

def of_class(path):
    module, _, name = path.rpartition(".")
    return getattr(importlib.import_module(module), name)

def public(kind):
    return {one for one in dir(kind) if not one.startswith("_")}

fields = {one for path in messages for one in of_class(path).get_fields_and_field_types()}
methods = set().union(*(public(of_class(path)) for path in objects))
print(json.dumps({
    "modules": {name: of_module(name) for name in modules},
    "node": sorted(public(of_class("rclpy.node.Node"))),
    "members": sorted(fields | methods),
}))
"""


def names() -> dict[str, object]:
    """Return the names by module, those of a node, and those of messages and of what a node makes."""
    asked = json.dumps([str(ROOT / "grader" / "shim"), _MODULES, _MESSAGES, _OBJECTS])
    command = [sys.executable, "-I", "-S", "-c", _LOOK, asked]
    told = json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)
    return {**told, "modules": {**told["modules"], **_OF_PYTHON}}


def written() -> str:
    """Return the file's text."""
    return json.dumps(names(), separators=(",", ":")) + "\n"


if __name__ == "__main__":
    OUT.write_text(written(), encoding="utf-8")
