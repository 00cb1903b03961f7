import rclpy
from rclpy.node import Node

class Test(Node):
    def __init__(self):
        super().__init__('test')
        self.get_logger().info('test test')

def main():
    rclpy.init()
    node = Test()
    rclpy.spin()
    node.destroy_node()
    rclpy.shutdown()

if __name__ == '__main__':
    main()
