"""不写发布者，而是在程序里调用 ros2 命令行工具。"""

import os

import rclpy
from rclpy.node import Node

rclpy.init()
node = Node('backward')
os.system('ros2 topic pub -r 10 /turtle1/cmd_vel geometry_msgs/msg/Twist "{linear: {x: -1.0}}"')
rclpy.shutdown()
