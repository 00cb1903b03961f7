"""Import this last in the process that scripts are forked from: what every run needs is then done once.

Nothing here depends on a script, and nothing a script can see is changed but what has been imported already.
"""

import _sitebuiltins  # noqa: F401
import atexit  # noqa: F401
import json  # noqa: F401
import linecache  # noqa: F401
import traceback  # noqa: F401

import geometry_msgs.msg
import rcl_interfaces.msg

import rclpy._patches_audit
import rclpy._patches_select
import rclpy._runner
import rclpy.node  # noqa: F401
from rclpy import _patches

# Classes are built when they are first asked for: these are what every node and every mover asks for.
for _name in ("FloatingPointRange", "IntegerRange", "ParameterDescriptor", "SetParametersResult"):
    getattr(rcl_interfaces.msg, _name)
for _name in ("Twist", "Vector3"):
    getattr(geometry_msgs.msg, _name)

_patches.find_copies()
