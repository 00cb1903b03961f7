#!/usr/bin/env python3
# 姓名：李明  学号：2024010115
# 实验一 第一个节点

import rclpy
from rclpy.node import Node


class LiMingNode(Node):

    def __init__(self):
        super().__init__('liming_node')
        self.get_logger().info('大家好，我是李明的第一个节点')


def main(args=None):
    rclpy.init(args=args)
    node = LiMingNode()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    finally:
        node.destroy_node()
        rclpy.shutdown()


if __name__ == '__main__':
    main()
