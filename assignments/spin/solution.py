"""原地左转一整圈（2π 弧度），再多转一点点保险。"""

import math
import time

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node

TURN_SPEED = 1.0  # rad/s


class Spinner(Node):
    def __init__(self):
        super().__init__('spinner')
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
        self.drive(0.0, TURN_SPEED, (2.0 * math.pi + 0.05) / TURN_SPEED)


def main():
    rclpy.init()
    node = Spinner()
    time.sleep(0.5)  # 等发布者和小乌龟连上
    node.run()
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
