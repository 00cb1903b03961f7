"""走一个正方形，边长由用户输入。把 TODO 补全。"""

import math
import time

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node

SPEED = 1.0  # m/s
TURN_SPEED = 1.0  # rad/s
ANGLE = math.radians(90.0)


class SquareInput(Node):
    def __init__(self):
        super().__init__('square_input')
        self.publisher = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)

    def drive(self, v, w, seconds):
        """以线速度 v、角速度 w 行驶 seconds 秒，然后停一下。"""
        msg = Twist()
        msg.linear.x = v
        msg.angular.z = w
        end = time.time() + seconds
        while time.time() < end:
            self.publisher.publish(msg)
            time.sleep(0.02)
        self.publisher.publish(Twist())
        time.sleep(0.1)

    def run(self):
        for _ in range(4):
            self.drive(SPEED, 0.0, self.side / SPEED)
            self.drive(0.0, TURN_SPEED, ANGLE / TURN_SPEED)


def main():
    rclpy.init()
    node = SquareInput()
    time.sleep(0.5)  # 等发布者和小乌龟连上
    node.side = 2.0  # TODO: 用 input() 读入边长
    node.run()
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
