"""8 字。"""

import math
import time

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node


class Driver(Node):
    def __init__(self):
        super().__init__('figure_eight')
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

    def line(self, length):
        """直行 length 米。"""
        self.drive(1.0, 0.0, length / 1.0)

    def turn(self, degrees):
        """原地转 degrees 度，左转为正。"""
        self.drive(0.0, math.copysign(1.0, degrees), abs(math.radians(degrees)) / 1.0)

    def arc(self, degrees, radius):
        """沿半径 radius 米的圆走 degrees 度，左转为正。"""
        self.drive(1.0, math.copysign(1.0 / radius, degrees), abs(math.radians(degrees)) * radius)

    def run(self):
        self.arc(360.0, 1.0)
        self.arc(-360.0, 1.0)


def main():
    rclpy.init()
    node = Driver()
    time.sleep(0.5)  # 等发布者和小乌龟连上
    node.run()
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
