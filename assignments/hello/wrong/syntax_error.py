"""类定义后面少了冒号。"""

import rclpy
from rclpy.node import Node


class Greeter(Node)
    def __init__(self):
        super().__init__('greeter')
        self.get_logger().info('大家好，我启动了！')


rclpy.init()
rclpy.spin(Greeter())
