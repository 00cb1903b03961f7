"""走一个长 3 米、宽 2 米的长方形。把 TODO 补全。"""

import time

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node

LONG = 3.0  # m
SHORT = 2.0  # m
SPEED = 1.0  # m/s


class Rectangle(Node):
    def __init__(self):
        super().__init__('rectangle')
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
        self.drive(SPEED, 0.0, LONG / SPEED)
        # TODO: 转 90°，走宽边，再转，一共走完 4 条边


def main():
    rclpy.init()
    node = Rectangle()
    time.sleep(0.5)  # 等发布者和小乌龟连上
    node.run()
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
