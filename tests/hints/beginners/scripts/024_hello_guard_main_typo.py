#!/usr/bin/env python3
import rclpy
from rclpy.node import Node


class HelloNode(Node):
    def __init__(self):
        super().__init__('hello_node')
        self.get_logger().info('hello')


def main(args=None):
    rclpy.init(args=args)
    node = HelloNode()
    rclpy.spin(node)


if __name__ == 'main':
    main()
