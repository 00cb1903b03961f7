import rclpy
from rclpy.node import Node


class HelloNode(Node):
    # 构造函数
    def __int__(self):
        super().__init__('hello_node')
        self.get_logger().info('Hello World, 王芳')


def main(args=None):
    rclpy.init(args=args)
    node = HelloNode()
    rclpy.spin(node)
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
