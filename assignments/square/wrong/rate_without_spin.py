"""用 create_rate 控制节奏，但没有线程在 spin：rate.sleep() 永远等不到。"""

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node

rclpy.init()
node = Node('square')
publisher = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)
rate = node.create_rate(10)
for _ in range(4):
    for v, w, ticks in ((1.0, 0.0, 20), (0.0, 1.0, 16)):
        for _ in range(ticks):
            msg = Twist()
            msg.linear.x = v
            msg.angular.z = w
            publisher.publish(msg)
            rate.sleep()
publisher.publish(Twist())
rclpy.shutdown()
