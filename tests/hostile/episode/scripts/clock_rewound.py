"""Attack: set the shim's virtual clock back and forth.

Expected: any
"""

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node

rclpy.init()
node = Node("attacker")
publisher = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
twist = Twist()

from rclpy._kernel import kernel

for name in ("now_ns", "_now_ns", "horizon_ns", "epoch_ns"):
    for value in (10**18, -10**18, 0):
        try:
            setattr(kernel, name, value)
        except Exception:
            pass
        twist.linear.x = 1.0
        publisher.publish(twist)
