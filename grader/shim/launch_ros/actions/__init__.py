"""Nodes, and what holds for all nodes behind an action, with the names of launch_ros 0.19 or, on Jazzy, 0.26."""

from launch._modules import offer
from rclpy import _distro

from launch_ros.actions._node import ComposableNodeContainer, LifecycleNode, LoadComposableNodes, Node
from launch_ros.actions._settings import (
    LifecycleTransition,
    PushROSNamespace,
    ROSTimer,
    SetParameter,
    SetParametersFromFile,
    SetRemap,
    SetROSLogDir,
    SetUseSimTime,
)

PushRosNamespace = PushROSNamespace
RosTimer = ROSTimer

__all__ = [
    "ComposableNodeContainer",
    "LifecycleNode",
    "LoadComposableNodes",
    "Node",
    "PushRosNamespace",
    "RosTimer",
    "SetParameter",
    "SetParametersFromFile",
    "SetRemap",
    "SetUseSimTime",
]
if _distro.chosen == _distro.HUMBLE:
    del LifecycleTransition, PushROSNamespace, ROSTimer, SetROSLogDir
else:
    __all__ += ["LifecycleTransition", "PushROSNamespace", "ROSTimer", "SetROSLogDir"]

offer(__name__)
