"""把数字直接交给日志函数。"""

import rclpy
from rclpy.node import Node


class Greeter(Node):
    def __init__(self):
        super().__init__('greeter')
        self.get_logger().info(2024)


def main():
    rclpy.init()
    node = Greeter()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
