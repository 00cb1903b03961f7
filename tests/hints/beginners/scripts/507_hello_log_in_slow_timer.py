import rclpy
from rclpy.node import Node

class MyNode(Node):
    def __init__(self):
        super().__init__('my_node')
        self.timer = self.create_timer(10.0, self.say)

    def say(self):
        self.get_logger().info('你好')

def main():
    rclpy.init()
    node = MyNode()
    rclpy.spin(node)

if __name__ == '__main__':
    main()
