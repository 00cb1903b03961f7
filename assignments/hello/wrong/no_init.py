"""忘了 rclpy.init()。"""

import rclpy
from rclpy.node import Node

node = Node('greeter')
node.get_logger().info('大家好，我启动了！')
rclpy.spin(node)
