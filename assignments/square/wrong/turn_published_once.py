"""直行和转弯都只发布一次，然后睡够时间：转弯在 1 秒时被超时打断。"""

import time

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node

rclpy.init()
node = Node('square')
publisher = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)
time.sleep(0.5)


def drive(v, w, seconds):
    msg = Twist()
    msg.linear.x = v
    msg.angular.z = w
    publisher.publish(msg)
    time.sleep(seconds)
    publisher.publish(Twist())


for _ in range(4):
    drive(1.0, 0.0, 2.0)
    drive(0.0, 1.0, 1.5708)

node.destroy_node()
rclpy.shutdown()
