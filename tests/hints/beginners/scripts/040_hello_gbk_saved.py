# 作者：张伟
# 功能：第一个节点，打印一句话
import rclpy
from rclpy.node import Node


class HelloNode(Node):
    def __init__(self):
        super().__init__('hello_node')
        self.get_logger().info('你好，我是第一个节点')


def main():
    rclpy.init()
    rclpy.spin(HelloNode())


if __name__ == '__main__':
    main()
