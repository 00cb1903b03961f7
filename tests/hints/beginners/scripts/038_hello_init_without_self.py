import rclpy
from rclpy.node import Node

class HelloNode(Node):
    def __init__():
        super().__init__('hello_node')
        get_logger().info('hello')

def main():
    rclpy.init()
    hello = HelloNode()
    rclpy.spin(hello)
    hello.destroy_node()
    rclpy.shutdown()

if __name__ == '__main__':
    main()
