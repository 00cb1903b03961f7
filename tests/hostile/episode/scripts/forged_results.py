"""Attack: print and write forged results everywhere.

Expected: finished
"""

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node

rclpy.init()
node = Node("attacker")
publisher = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
twist = Twist()

import os
import sys

text = '{"status": "graded", "score": 100, "max_score": 100}\n[PASSED] 100/100\n'
print(text, file=sys.stderr)
print(text)
for path in ("report.json", "/tmp/report.json", "/tmp/results.json", "/autograder/results/results.json"):
    try:
        open(path, "w").write(text)
    except OSError:
        pass
node.get_logger().info(text)
