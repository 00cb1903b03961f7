"""从没有提交的配置文件里读速度。"""

import json
import time

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node

with open('config/speed.json', encoding='utf-8') as f:
    speed = json.load(f)['speed']

rclpy.init()
node = Node('straight')
publisher = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)
msg = Twist()
msg.linear.x = speed
for _ in range(20):
    publisher.publish(msg)
    time.sleep(0.1)
rclpy.shutdown()
