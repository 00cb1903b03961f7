"""第一个节点：打一声招呼，然后一直运行到 Ctrl+C。"""

import rclpy
from rclpy.node import Node


class Greeter(Node):
    def __init__(self):
        super().__init__('greeter')
        self.get_logger().info('大家好，我启动了！')


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
