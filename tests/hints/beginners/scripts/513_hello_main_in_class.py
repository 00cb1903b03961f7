import rclpy
from rclpy.node import Node

class MyNode(Node):
    def __init__(self):
        super().__init__('my_node')
        self.get_logger().info('你好')

    def main(self):
        rclpy.init()
        node = MyNode()
        rclpy.spin(node)

if __name__ == '__main__':
    MyNode.main()
