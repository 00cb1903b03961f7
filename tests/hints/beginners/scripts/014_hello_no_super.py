import rclpy
from rclpy.node import Node


class HelloNode(Node):
    """我的节点"""

    def __init__(self):
        self.name = 'hello_node'
        self.get_logger().info('Hello, 我叫' + self.name)


def main(args=None):
    rclpy.init(args=args)
    node = HelloNode()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    finally:
        node.destroy_node()
        rclpy.shutdown()


if __name__ == '__main__':
    main()
