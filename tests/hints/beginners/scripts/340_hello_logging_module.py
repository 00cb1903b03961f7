import logging
import rclpy
from rclpy.node import Node

logging.basicConfig(level=logging.INFO)


class HelloNode(Node):
    def __init__(self):
        super().__init__('hello_node')
        logging.info('Hello ROS2')


def main():
    rclpy.init()
    node = HelloNode()
    rclpy.spin(node)
    rclpy.shutdown()


if __name__ == '__main__':
    main()
