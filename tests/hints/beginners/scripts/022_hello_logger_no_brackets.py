import rclpy
from rclpy.node import Node


class N(Node):
    def __init__(self):
        super().__init__('n1')
        self.get_logger.info('节点 n1 已启动')


def main():
    rclpy.init()
    rclpy.spin(N())


main()
