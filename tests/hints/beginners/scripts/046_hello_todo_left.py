"""第一个节点。把 TODO 补全。"""

import rclpy
from rclpy.node import Node


class Greeter(Node):
    def __init__(self):
        super().__init__('greeter')
        # TODO 1: 用 self.get_logger().info(...) 输出一句问候
        # self.get_logger().info('你好')


def main():
    rclpy.init()
    node = Greeter()
    # TODO 2: 让节点一直运行，直到按下 Ctrl+C
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
