"""Importing rclpy is cheap: what a script did not ask for is not imported."""

import subprocess
import sys

from tests.shim.conftest import SHIM

PROGRAM = """
import sys
sys.path.insert(0, {shim!r})
import rclpy, rclpy.node
from geometry_msgs.msg import Twist
from turtlesim.msg import Pose
print(*sorted(sys.modules))
"""
COSTLY = {
    "asyncio", "contextlib", "dataclasses", "importlib", "inspect", "json", "logging", "numpy", "pathlib",
    "random", "re", "signal", "socket", "threading", "traceback", "typing", "uuid", "warnings", "weakref", "yaml",
}  # fmt: skip


def test_nothing_costly_is_imported_with_a_node_and_its_messages() -> None:
    program = PROGRAM.format(shim=str(SHIM))
    done = subprocess.run(
        [sys.executable, "-I", "-S", "-c", program], capture_output=True, text=True, check=True
    )
    modules = set(done.stdout.split())
    assert {"rclpy.node", "geometry_msgs.msg._twist", "turtlesim.msg._pose"} <= modules
    assert modules.isdisjoint(COSTLY)
    assert "geometry_msgs.msg._pose" not in modules
