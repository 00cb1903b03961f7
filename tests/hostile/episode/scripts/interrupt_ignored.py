"""Attack: catch Ctrl+C at the horizon and go on for ever.

Expected: interrupted or cpu_limit
"""

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node

rclpy.init()
node = Node("attacker")
publisher = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
twist = Twist()

import time

while True:
    try:
        while True:
            time.sleep(1.0)
    except BaseException:
        while True:
            try:
                while True:
                    pass
            except BaseException:
                pass
