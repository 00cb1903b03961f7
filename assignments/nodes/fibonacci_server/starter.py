import rclpy
from rclpy.node import Node
from example_interfaces.action import Fibonacci
from rclpy.action import ActionServer


class FibonacciServer(Node):
    def __init__(self):
        super().__init__('fibonacci_server')
        # TODO: an ActionServer named 'fibonacci'


def main():
    rclpy.init()
    node = FibonacciServer()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass


if __name__ == '__main__':
    main()
