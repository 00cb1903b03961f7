import rclpy
from rclpy.node import Node


class HelloNode(Node):
    def __init__(self):
        super().__init__('hello_node')
        self.get_logger().info('你好')


rclpy.init()
node = HelloNode()
rclpy.spin_once(node, timeout_sec=1.0)
node.destroy_node()
rclpy.shutdown()
