"""Importing interface packages: lazily, and with Python's own errors."""

import importlib
import subprocess
import sys
from typing import Any

import pytest
from rclpy._interfaces import own
from rclpy._interfaces.definitions import INTERFACES


def test_every_interface_is_importable_both_ways() -> None:
    assert len(INTERFACES) > 230
    for interface in INTERFACES.values():
        package = importlib.import_module(f"{interface.package}.{interface.kind}")
        module = importlib.import_module(interface.module)
        assert getattr(package, interface.name) is getattr(module, interface.name)
        assert getattr(module, interface.name).__module__ == interface.module


def test_usual_forms_of_import() -> None:
    names: dict[str, Any] = {}
    exec(
        """
import geometry_msgs.msg
import std_srvs.srv
from geometry_msgs.msg import Twist
from geometry_msgs.msg._twist import Twist as Direct
from turtlesim.action import RotateAbsolute
same = geometry_msgs.msg.Twist is Twist is Direct is geometry_msgs.msg._twist.Twist
""",
        names,
    )
    assert names["same"]
    assert names["std_srvs"].srv.Empty.Request.__name__ == "Empty_Request"
    assert names["RotateAbsolute"].Goal.__module__ == "turtlesim.action._rotate_absolute"


def test_star_import_and_dir_show_the_interfaces() -> None:
    namespace: dict[str, object] = {}
    exec("from std_srvs.srv import *", namespace)
    assert {"Empty", "SetBool", "Trigger"} <= namespace.keys()
    assert "Twist" in dir(importlib.import_module("geometry_msgs.msg"))


@pytest.mark.parametrize(
    ("statement", "error", "text"),
    [
        (
            "from geometry_msgs.msg import Twits",
            ImportError,
            "cannot import name 'Twits' from 'geometry_msgs.msg' "
            "(/opt/ros/humble/local/lib/python3.10/dist-packages/geometry_msgs/msg/__init__.py)",
        ),
        ("import geometry_msgs.mgs", ModuleNotFoundError, "No module named 'geometry_msgs.mgs'"),
        ("from geometry_msg.msg import Twist", ModuleNotFoundError, "No module named 'geometry_msg'"),
        ("import geometry_msgs.srv", ModuleNotFoundError, "No module named 'geometry_msgs.srv'"),
        (
            "import geometry_msgs.msg; geometry_msgs.msg.twist",
            AttributeError,
            "module 'geometry_msgs.msg' has no attribute 'twist'",
        ),
        (
            "import geometry_msgs.msg; geometry_msgs.Twist",
            AttributeError,
            "module 'geometry_msgs' has no attribute 'Twist'",
        ),
    ],
)
def test_unknown_names_give_pythons_errors(statement: str, error: type[Exception], text: str) -> None:
    with pytest.raises(error) as caught:
        exec(statement, {})
    assert type(caught.value) is error
    assert str(caught.value) == text


def run(code: str, shim: str) -> str:
    program = f"import sys; sys.path.insert(0, {shim!r}); import rclpy._interfaces.own\n{code}"
    return subprocess.run(
        [sys.executable, "-I", "-S", "-c", program], capture_output=True, text=True, check=True
    ).stdout


@pytest.fixture(scope="module")
def shim() -> str:
    return next(path for path in sys.path if path.endswith("grader/shim"))


def test_a_class_is_built_only_when_asked_for_and_needs_no_numpy(shim: str) -> None:
    code = """
from rclpy._interfaces.messages import STRUCTURES
from rclpy._interfaces.cdr import deserialize, serialize
import nav_msgs.msg, geometry_msgs.msg
before = len(STRUCTURES)
geometry_msgs.msg.Twist
after = {cls.__name__ for cls in STRUCTURES}
odometry = nav_msgs.msg.Odometry()
deserialize(serialize(odometry), nav_msgs.msg.Odometry)
print(before, sorted(after), 'numpy' in sys.modules)
"""
    assert run(code, shim) == "0 ['Twist', 'Vector3'] False\n"


def test_rclpys_own_types_come_by_their_short_names(shim: str) -> None:
    code = """
from rclpy._interfaces import own
print(own.type_name(own.LogType), own.type_name(own.GetParameters))
print(hasattr(own, 'Twist'))
"""
    assert run(code, shim) == "rcl_interfaces/msg/Log rcl_interfaces/srv/GetParameters\nFalse\n"


def test_every_annotated_short_name_exists() -> None:
    names = [name for name in own.__annotations__ if name[0].isupper()]
    assert "ParameterValue" in names
    assert all(hasattr(own, name) for name in names)
