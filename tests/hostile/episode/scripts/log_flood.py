"""Attack: log without end.

Expected: output_limit
"""

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node

rclpy.init()
node = Node("attacker")
publisher = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
twist = Twist()

while True:
    node.get_logger().error("x" * 1000)
