"""Attack: publish without end and without pause.

Expected: interrupted or cpu_limit
"""

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node

rclpy.init()
node = Node("attacker")
publisher = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
twist = Twist()

twist.linear.x = 1.0
while True:
    publisher.publish(twist)
