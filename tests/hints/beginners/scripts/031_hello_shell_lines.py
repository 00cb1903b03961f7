import rclpy
from rclpy.node import Node


class HelloNode(Node):
    def __init__(self):
        super().__init__('hello_node')
        self.get_logger().info('Hello ROS2')


def main():
    rclpy.init()
    rclpy.spin(HelloNode())


if __name__ == '__main__':
    main()

chmod +x hello_node.py
python3 hello_node.py
[INFO] [hello_node]: Hello ROS2
