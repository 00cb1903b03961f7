"""What ROS 2 Jazzy (rclpy 7.1.3, rosidl_python 0.22) adds to Humble or does otherwise.

| module here | what differs |
|---|---|
| `host` | Ubuntu 24.04, `ROS_DISTRO`, where packages stand, line numbers of rcl 9.2 in texts |
| `interfaces` | new definitions; setters that check nothing unless asked; `Event` of services |
| `conversion` | what `publish` does with a field of a wrong type: the process is aborted |
| `time`, `timer`, `qos` | comparisons with other types; autostart; best available |
| `context`, `executors` | context managers; shutdown waits for nobody; warnings |
| `node`, `parameter` | callbacks before and after parameters are set, `list_parameters`, `wait_for_node`, counts |
| `exceptions` | one text for each about parameters |
| `endpoints`, `introspection` | names of services, time-outs of calls, message infos, events of services |
| `matching` | who is matched with whom |
| `topic_endpoint_info`, `descriptions` | hashes and descriptions of types |
| `logging` | levels by name; child loggers publish on /rosout |
| `names` | what modules pass on, and what ``import rclpy`` brings |
| `action` | loggers of their own (changed when they are imported) |
| `qos_event` | the old name of `rclpy.event_handler` |

`overlay` has the two ways in which they change a module of Humble.
"""

from __future__ import annotations

import sys

TYPE_CHECKING = False
if TYPE_CHECKING:
    from importlib.machinery import ModuleSpec
    from typing import Any

_CHANGES = (
    "host",
    "interfaces",
    "conversion",
    "exceptions",
    "time",
    "timer",
    "qos",
    "context",
    "parameter",
    "logging",
    "matching",
    "endpoints",
    "executors",
    "topic_endpoint_info",
    "node",
    "names",
)
"""In the order in which they are applied: each by being imported."""

_LATER = {
    "rclpy.action.client": ("rclpy._jazzy.action", "change_client"),
    "rclpy.action.server": ("rclpy._jazzy.action", "change_server"),
}
"""Modules that few scripts import -> who changes them then."""

_REDIRECTED = {"rclpy.qos_event": "qos_event.py"}
"""Modules that on Jazzy only tell where their content has gone."""


class _Redirection:
    """Finder of the modules that stand here instead of in their places."""

    @staticmethod
    def find_spec(name: str, path: Any = None, target: Any = None) -> ModuleSpec | None:
        if name not in _REDIRECTED:
            return None
        from importlib.util import spec_from_file_location

        return spec_from_file_location(name, __path__[0] + "/" + _REDIRECTED[name])


def install() -> None:
    """Change what is there, and leave in the script's sight what was in it before."""
    from rclpy._patches.install import LAZY
    from rclpy._process.shelf import shelf

    seen = set(sys.modules)
    for name in shelf.names():
        if name.startswith("rclpy."):
            __import__(name)  # what it has copied from others has to change, too
    for name in _CHANGES:
        __import__(f"rclpy._jazzy.{name}")
    LAZY.update(_LATER)
    new = [name for name in sys.modules if name not in seen and name.startswith("rclpy.")]
    shelf.put(sorted(name for name in new if not any(part.startswith("_") for part in name.split("."))))
    shelf.forget(_REDIRECTED)
    finder: Any = _Redirection
    sys.meta_path.insert(0, finder)
