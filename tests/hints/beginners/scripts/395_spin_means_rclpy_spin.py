import rclpy
from rclpy.node import Node


class Rotate(Node):
    def __init__(self):
        super().__init__('rotate')
        self.get_logger().info('开始旋转')


def main():
    rclpy.init()
    node = Rotate()
    # 原地旋转
    rclpy.spin(node)
    rclpy.shutdown()


main()
