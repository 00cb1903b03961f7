"""用 teleport 服务瞬移出一个正方形，没有让小车行驶。"""

import math

import rclpy
from rclpy.node import Node
from turtlesim.srv import TeleportRelative

SIDE = 2.0  # m


class Square(Node):
    def __init__(self):
        super().__init__('square')
        self.client = self.create_client(TeleportRelative, '/turtle1/teleport_relative')
        self.client.wait_for_service()

    def jump(self, linear, angular):
        request = TeleportRelative.Request()
        request.linear = linear
        request.angular = angular
        future = self.client.call_async(request)
        rclpy.spin_until_future_complete(self, future)

    def run(self):
        for _ in range(4):
            self.jump(SIDE, 0.0)
            self.jump(0.0, math.pi / 2.0)


def main():
    rclpy.init()
    node = Square()
    node.run()
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
