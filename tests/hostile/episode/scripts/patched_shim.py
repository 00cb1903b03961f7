"""Attack: patch every function of the shim that sends something.

Expected: any
"""

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node

rclpy.init()
node = Node("attacker")
publisher = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
twist = Twist()

import sys

for name, module in list(sys.modules.items()):
    if name.startswith("rclpy"):
        for key, value in list(vars(module).items()):
            if callable(value) and not isinstance(value, type):
                try:
                    setattr(module, key, lambda *a, **k: 100)
                except Exception:
                    pass
