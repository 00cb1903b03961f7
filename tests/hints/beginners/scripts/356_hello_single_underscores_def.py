#!/usr/bin/env python3
"""
第一个ROS2 Python节点:Hello World
"""

import rclpy
from rclpy.node import Node


class HelloNode(Node):
    """最简单的ROS2节点"""

    def _init_(self):
        # 调用父类初始化,节点名为 'hello_node'
        super().__init__('hello_node')

        # 打印日志(ROS2的print)
        self.get_logger().info('🎉 Hello ROS2! 我是第一个Python节点!')


def main(args=None):
    """主函数:入口点"""

    # 1. 初始化ROS2(必须的第一步)
    rclpy.init(args=args)

    # 2. 创建节点
    node = HelloNode()

    # 3. 让节点保持运行(spin = 保持监听回调)
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        # Ctrl+C 优雅退出
        pass
    finally:
        # 4. 清理资源
        node.destroy_node()
        rclpy.shutdown()


if __name__ == '__main__':
    main()
