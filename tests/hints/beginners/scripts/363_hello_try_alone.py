import rclpy
from rclpy.node import Node


def main():
    rclpy.init()
    node = Node('n1')
    node.get_logger().info('hello')
    try:
        rclpy.spin(node)
    rclpy.shutdown()


main()
