import rclpy
from rclpy.node import Node


class HelloNode(Node):
    def __init__(self):
        super().__init__('hello_node')
        self.get_logger().info('Hello ROS2, 我来了')


def main(args=None):
    rclpy.init(args=args)
    node = HelloNode()
    # 清理资源
    rclpy.shutdown()
    # 保持运行
    rclpy.spin(node)


if __name__ == '__main__':
    main()
