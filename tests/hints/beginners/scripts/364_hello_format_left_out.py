import rclpy
from rclpy.node import Node


class A(Node):
    def __init__(self):
        super().__init__('a')
        name = '王'
        self.get_logger().info('我是 {name}')


def main():
    rclpy.init()
    n = A()
    try:
        rclpy.spin(n)
    except KeyboardInterrupt:
        pass


main()
