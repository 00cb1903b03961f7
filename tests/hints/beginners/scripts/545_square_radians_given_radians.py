import math
import time

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node


class Draw(Node):
    def __init__(self):
        super().__init__('draw')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        time.sleep(1.0)

    def send(self, v, w, t):
        msg = Twist()
        msg.linear.x = v
        msg.angular.z = w
        end = time.time() + t
        while time.time() < end:
            self.pub.publish(msg)
            time.sleep(0.01)
        self.pub.publish(Twist())
        time.sleep(0.2)

    def forward(self, d):
        self.send(1.0, 0.0, d / 1.0)

    def left(self, deg):
        self.send(0.0, 1.0, math.radians(deg) / 1.0)


def main():
    rclpy.init()
    node = Draw()
    for i in range(4):
        node.forward(2.0)
        node.left(math.radians(90))
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
