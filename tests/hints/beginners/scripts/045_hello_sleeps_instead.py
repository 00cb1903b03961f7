import rclpy
import time
from rclpy.node import Node


class HelloNode(Node):
    def __init__(self):
        super().__init__('hello_node')
        self.get_logger().info('Hello! 3秒后退出')


def main():
    rclpy.init()
    node = HelloNode()
    time.sleep(3)
    node.destroy_node()
    rclpy.shutdown()
    print('done')


if __name__ == '__main__':
    main()
