"""Attack: an exit hook and a thread that never return.

Expected: any
"""

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node

rclpy.init()
node = Node("attacker")
publisher = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
twist = Twist()

import atexit
import threading

def forever():
    while True:
        pass

atexit.register(forever)
threading.Thread(target=forever, daemon=False).start()
