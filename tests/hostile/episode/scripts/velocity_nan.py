"""Attack: NaN and infinite velocities.

Expected: finished
"""

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node

rclpy.init()
node = Node("attacker")
publisher = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
twist = Twist()

import time

for value in (float("nan"), float("inf"), -float("inf"), 1e308, -1e308, 5e-324):
    for field in ("x", "y", "z"):
        setattr(twist.linear, field, value)
        setattr(twist.angular, field, value)
    publisher.publish(twist)
    time.sleep(0.5)
