"""Attack: log and publish strings of many megabytes.

Expected: output_limit
"""

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node

rclpy.init()
node = Node("attacker")
publisher = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
twist = Twist()

from std_msgs.msg import String

node.get_logger().info("x" * (8 << 20))
node.create_publisher(String, "/chatter", 10).publish(String(data="y" * (8 << 20)))
node.create_publisher(String, "/rosout", 10)
