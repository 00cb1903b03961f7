import rclpy
from rclpy.node import Node


class HelloNode(Node):
    def __init__(self):
        super().__init__('hello_node')
        self.get_logger().info('Hello!')


if __name__ == '__main__':
    rclpy.init()
    rclpy.spin(HelloNode)
    rclpy.shutdown()
