import rclpy
from rclpy.node import Node

class First(Node):
    def __init__(self):
        super().__init__('first')
        self.get_logger().info('first node ok')

def main():
    node = First()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        print('bye')

if __name__ == '__main__':
    main()
