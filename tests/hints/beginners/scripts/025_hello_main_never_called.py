import rclpy
from rclpy.node import Node

class HelloNode(Node):
    '''最简单的节点'''
    def __init__(self):
        super().__init__('hello_node')
        self.get_logger().info('hello ros2 humble')

def main():
    rclpy.init()
    node = HelloNode()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    node.destroy_node()
    rclpy.try_shutdown()
