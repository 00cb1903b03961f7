"""Importing rclpy is cheap: what a script did not ask for is not imported."""

import subprocess
import sys
from collections.abc import Callable

from tests.shim.conftest import SHIM, Run

RunScript = Callable[..., Run]

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


def _with_warm_shim(program: str) -> list[str]:
    head = f"import sys\nsys.path.insert(0, {str(SHIM)!r})\nimport rclpy._process.warm\n"
    command = [sys.executable, "-I", "-S", "-c", head + program]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout.splitlines()


def test_what_is_loaded_ahead_is_not_there_before_it_is_imported() -> None:
    program = """
import rclpy, geometry_msgs
print(hasattr(rclpy, "node"), hasattr(rclpy, "executors"), hasattr(rclpy, "qos"), hasattr(geometry_msgs, "msg"))
print("rclpy.node" in sys.modules, "geometry_msgs.msg._twist" in sys.modules)
import rclpy.node, geometry_msgs.msg
print(hasattr(rclpy, "node"), hasattr(rclpy, "executors"), hasattr(rclpy, "qos"), hasattr(geometry_msgs, "msg"))
"""
    assert _with_warm_shim(program) == ["False False False False", "False False", "True True True True"]


def test_what_is_loaded_ahead_is_the_same_once_imported() -> None:
    program = """
import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
import rclpy.executors, rclpy.impl.rcutils_logger
rclpy.init()
node = rclpy.create_node("n")
print(type(node) is Node, isinstance(rclpy.get_global_executor(), rclpy.executors.Executor))
print(sys.modules["rclpy.node"].__spec__.origin, Twist.__module__, rclpy.executors.__spec__.name)
"""
    node = SHIM / "rclpy" / "node.py"
    assert _with_warm_shim(program) == ["True True", f"{node} geometry_msgs.msg._twist rclpy.executors"]


def test_upstreams_node_module_passes_on_what_it_imports() -> None:
    program = """
import rclpy.node, rclpy.timer, rclpy.qos
from rclpy.node import Executor, Node, Optional, Publisher, QoSProfile, SetParametersResult, Subscription, Timer
print(Timer is rclpy.timer.Timer, QoSProfile is rclpy.qos.QoSProfile, hasattr(rclpy.node, "Twist"))
"""
    assert _with_warm_shim(program) == ["True True False"]


def test_threads_that_are_loaded_ahead_take_the_time_that_their_import_takes(run_script: RunScript) -> None:
    source = """
import sys, time
print("threading" in sys.modules)
import threading
print(time.monotonic_ns(), threading.main_thread().name, threading.get_ident(), threading.__spec__.origin)
print(type(threading.__loader__), threading.__loader__ is threading.__spec__.loader)
started = threading.Event()
thread = threading.Thread(target=lambda: (time.sleep(0.5), started.set()))
thread.start()
print(started.wait(2.0), time.monotonic_ns(), thread.name, threading.current_thread() is threading.main_thread())
"""
    late, ahead = (run_script(source, warm=warm).stdout.splitlines() for warm in (False, True))
    assert late == ahead
    assert late[0] == "False"
