"""Attack: drive the figure after the horizon, in `finally`.

Expected: interrupted
"""

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node

rclpy.init()
node = Node("attacker")
publisher = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
twist = Twist()

import time

try:
    while True:
        time.sleep(1.0)
finally:
    for _ in range(4):
        for v, w in ((1.0, 0.0), (0.0, 0.7853981633974483)):
            twist.linear.x, twist.angular.z = v, w
            for _ in range(40):
                publisher.publish(twist)
                time.sleep(0.05)
