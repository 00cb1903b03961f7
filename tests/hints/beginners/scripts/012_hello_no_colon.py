import rclpy
from rclpy.node import Node

class HelloNode(Node)
    def __init__(self):
        super().__init__('hello_node')
        self.get_logger().info('我的第一个ROS2程序')

def main(args=None):
    rclpy.init(args=args)
    node = HelloNode()
    rclpy.spin(node)
    node.destroy_node()
    rclpy.shutdown()

if __name__ == '__main__':
    main()
