import rclpy
from rclpy.node import Node


class HelloNode(Node):
    name = 'hello'
    self.get_logger().info('你好')


def main():
    rclpy.init()
    node = HelloNode()
    rclpy.spin(node)


main()
