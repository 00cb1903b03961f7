"""忘了 spin：打完招呼就退出。"""

import rclpy
from rclpy.node import Node


class Greeter(Node):
    def __init__(self):
        super().__init__('greeter')
        self.get_logger().info('大家好，我启动了！')


def main():
    rclpy.init()
    node = Greeter()
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
