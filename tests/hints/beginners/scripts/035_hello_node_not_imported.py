import rclpy


class HelloNode(Node):
    """hello"""

    def __init__(self):
        super().__init__('hello_node')
        self.get_logger().info('hello hello')


def main():
    rclpy.init()
    node = HelloNode()
    rclpy.spin(node)
    rclpy.shutdown()


if __name__ == '__main__':
    main()
