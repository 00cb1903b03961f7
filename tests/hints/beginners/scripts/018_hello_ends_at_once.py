import rclpy
from rclpy.node import Node


class Greeter(Node):
    def __init__(self):
        super().__init__('greeter')
        self.get_logger().info('你好！这是我的节点')


def main():
    rclpy.init()
    node = Greeter()
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
