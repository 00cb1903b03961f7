"""只发布一次，小车 1 秒后就停了：只转了 1 弧度。"""

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node

rclpy.init()
node = Node('spinner')
publisher = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)
msg = Twist()
msg.angular.z = 1.0
publisher.publish(msg)
rclpy.spin(node)
