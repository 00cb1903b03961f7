"""Attack: a timer callback that never returns.

Expected: cpu_limit
"""

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node

rclpy.init()
node = Node("attacker")
publisher = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
twist = Twist()

def forever():
    while True:
        pass

node.create_timer(0.1, forever)
rclpy.spin(node)
