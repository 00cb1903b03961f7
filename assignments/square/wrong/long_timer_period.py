"""定时器周期 0.5 秒太长，每次转弯都转过了头。"""

import math

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node

PERIOD = 0.5  # 秒


class Square(Node):
    def __init__(self):
        super().__init__('square')
        self.publisher = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.steps = []
        for _ in range(4):
            self.steps += [(1.0, 0.0)] * math.ceil(2.0 / PERIOD)
            self.steps += [(0.0, 1.0)] * math.ceil(math.pi / 2.0 / PERIOD)
        self.timer = self.create_timer(PERIOD, self.tick)

    def tick(self):
        msg = Twist()
        if self.steps:
            msg.linear.x, msg.angular.z = self.steps.pop(0)
        self.publisher.publish(msg)


def main():
    rclpy.init()
    rclpy.spin(Square())


if __name__ == '__main__':
    main()
