import rclpy
from rclpy import Node

class HelloNode(Node):
    def __init__(self):
        super().__init__('hello_node')
        self.get_logger().info('Hi')

def main(args=None):
    rclpy.init(args=args)
    rclpy.spin(HelloNode())

if __name__ == '__main__':
    main()
