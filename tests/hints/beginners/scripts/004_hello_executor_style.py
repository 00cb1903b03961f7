import sys

import rclpy
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node


class Greeter(Node):

    def __init__(self, who: str) -> None:
        super().__init__('greeter')
        self.who = who

    def greet(self) -> None:
        self.get_logger().info('Hello, %s!' % self.who)


def main() -> int:
    rclpy.init(args=sys.argv)
    node = Greeter('turtle')
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    node.greet()
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        executor.shutdown()
        node.destroy_node()
        rclpy.try_shutdown()
    return 0


if __name__ == '__main__':
    sys.exit(main())
