import rclpy
from rclpy.node import Node

class HelloNode(Node):
    def __init__(self):
        super().__init__(‘hello_node’)
        self.get_logger().info(“你好，机器人”)

def main():
    rclpy.init()
    rclpy.spin(HelloNode())

if __name__ == ‘__main__’:
    main()
