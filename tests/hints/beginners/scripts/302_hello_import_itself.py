import rclpy
from my_hello_pkg.hello_node import HelloNode


def main():
    rclpy.init()
    node = HelloNode()
    rclpy.spin(node)
    rclpy.shutdown()


if __name__ == '__main__':
    main()
