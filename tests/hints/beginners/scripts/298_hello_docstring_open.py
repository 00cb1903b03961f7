#!/usr/bin/env python3
"""
第一个ROS2 Python节点

import rclpy
from rclpy.node import Node


class HelloNode(Node):
    def __init__(self):
        super().__init__('hello_node')
        self.get_logger().info('Hello ROS2')


def main():
    rclpy.init()
    rclpy.spin(HelloNode())


if __name__ == '__main__':
    main()
