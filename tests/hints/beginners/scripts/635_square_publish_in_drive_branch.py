#!/usr/bin/env python3
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist
import time
import math

class M(Node):
    def __init__(self):
        super().__init__('m')
        self.p = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.timer = self.create_timer(0.05, self.cb)
        self.step = 0
        self.i = 0
    def cb(self):
        msg = Twist()
        if self.step == 0:
            msg.linear.x = 1.0
            self.p.publish(msg)
            self.i += 1
            if self.i > 40:
                self.step = 1
                self.i = 0
        elif self.step == 1:
            msg.angular.z = math.pi / 4
            self.i += 1
            if self.i > 40:
                self.step = 0
                self.i = 0

rclpy.init()
rclpy.spin(M())
