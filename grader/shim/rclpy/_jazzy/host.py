"""The PC: Ubuntu 24.04 with Python 3.12; where Jazzy's packages stand; its line numbers in texts."""

from __future__ import annotations

import os

from rclpy._interfaces import definitions
from rclpy._jazzy.overlay import replace
from rclpy._patches import host
from rclpy._rcl import errors, handles

os.environ["ROS_DISTRO"] = "jazzy"
host.UNAME = os.uname_result(("Linux", host.HOST, "6.8.0-45-generic", "#45-Ubuntu SMP", "x86_64"))
replace(definitions, SITE_PACKAGES="/opt/ros/jazzy/lib/python3.12/site-packages/")

replace(
    errors,
    PUBLISHER_CONTEXT="publisher's context is invalid, at ./src/rcl/publisher.c:422",
    SHUTDOWN_TWICE=errors.SHUTDOWN_TWICE.replace("241", "333"),
    NODE_CONTEXT="rcl node's context is invalid, at ./src/rcl/node.c:404",
    NEGATIVE_PERIOD=errors.NEGATIVE_PERIOD.replace("139", "157"),
    TIMER_CANCELED=errors.TIMER_CANCELED.replace("249", "281"),
)


def required(handle: handles.ContextHandle | None) -> handles.ContextHandle:
    """Return the handle of an initialised context.

    Raises TypeError: there is none; Python 3.12 enters ``with None`` and fails with this text.
    """
    if handle is None:
        raise TypeError("'NoneType' object does not support the context manager protocol")
    handle.require()
    return handle


replace(handles, required=required)
