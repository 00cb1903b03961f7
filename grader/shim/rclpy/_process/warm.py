"""Import this last in the process that scripts are forked from: what every run needs is then done once.

Nothing here depends on a script, and nothing a script can see is changed: what ``import rclpy`` does not bring
stays out of its sight until it is imported.
"""

from __future__ import annotations

import _sitebuiltins  # noqa: F401
import atexit  # noqa: F401
import json  # noqa: F401
import linecache  # noqa: F401
import sys
import tokenize  # noqa: F401 - from Python 3.13 on `linecache` imports it late, and it copies `open`
import traceback  # noqa: F401
import typing  # noqa: F401 - many scripts annotate
import weakref  # noqa: F401

from rclpy._interfaces.importer import PACKAGES
from rclpy._patches import install
from rclpy._process.shelf import shelf

_with_rclpy = set(sys.modules)


def _is_for_scripts(name: str) -> bool:
    """Return whether a script may import a module by its name: not the shim's private ones."""
    package, *modules = name.split(".")
    return (
        package in PACKAGES
        or name == "threading"
        or (package == "rclpy" and not any(part.startswith("_") for part in modules))
    )


def _load() -> None:
    """Import what most scripts import, and build what every node, every mover and who listens to the pose need."""
    import threading  # noqa: F401

    import geometry_msgs.msg
    import rcl_interfaces.msg
    import turtlesim.msg

    import rclpy._patches.audit
    import rclpy._patches.python_3_10
    import rclpy._patches.select
    import rclpy._patches.signal
    import rclpy._process.runner
    import rclpy._rcl.ros_args
    import rclpy.executors
    import rclpy.node
    import rclpy.parameter_service
    import rclpy.qos_event
    import rclpy.time_source  # noqa: F401
    from rclpy._interfaces.cdr import deserialize, serialize

    for name in ("FloatingPointRange", "IntegerRange", "ParameterDescriptor", "SetParametersResult"):
        getattr(rcl_interfaces.msg, name)
    serialize(geometry_msgs.msg.Twist())
    deserialize(serialize(turtlesim.msg.Pose()), turtlesim.msg.Pose)


_load()
install.find_copies()
shelf.put(sorted(name for name in sys.modules if name not in _with_rclpy and _is_for_scripts(name)))
