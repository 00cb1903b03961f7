#!/usr/bin/env python3
# 直行程序 2024.11
import rclpy
from rclpy.node import Node
from geometry_msgs import Twist


class Zhixing(Node):
    def __init__(self):
        super().__init__('zhixing')
        self.fabu = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.create_timer(0.1, self.huidiao)

    def huidiao(self):
        xiaoxi = Twist()
        xiaoxi.linear.x = 1.5
        self.fabu.publish(xiaoxi)


if __name__ == '__main__':
    rclpy.init()
    rclpy.spin(Zhixing())
