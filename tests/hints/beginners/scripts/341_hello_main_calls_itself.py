import rclpy
from rclpy.node import Node


def main():
    rclpy.init()
    node = Node('again')
    node.get_logger().info('再来一次')
    main()


if __name__ == '__main__':
    main()
