import rclpy
from rclpy.node import Node


class HelloNode:
    def __init__(self):
        super().__init__('hello_node')
        self.get_logger().info('我是机器人')


def main():
    rclpy.init()
    node = HelloNode()
    rclpy.spin(node)


if __name__ == '__main__':
    main()
