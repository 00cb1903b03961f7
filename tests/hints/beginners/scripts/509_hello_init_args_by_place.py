import rclpy
from rclpy.node import Node

def main(args=None):
    rclpy.init(args)
    node = Node('hello')
    node.get_logger().info('hello')
    rclpy.spin(node)

if __name__ == '__main__':
    main()
