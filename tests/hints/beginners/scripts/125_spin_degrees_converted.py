import math
import time

import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


def du(x):
    """角度 -> 弧度"""
    return x * math.pi / 180


class Rotator(Node):
    def __init__(self):
        super().__init__('rotator')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.declare_parameter('deg_per_sec', 60.0)

    def rotate(self, deg):
        w = du(self.get_parameter('deg_per_sec').value)
        msg = Twist()
        msg.angular.z = w
        ticks = round(du(deg) / w / 0.05)
        for _ in range(ticks):
            self.pub.publish(msg)
            time.sleep(0.05)
        self.pub.publish(Twist())
        time.sleep(0.1)


def main():
    rclpy.init()
    r = Rotator()
    time.sleep(1)
    r.get_logger().info('开始旋转 400 度')
    r.rotate(400)
    r.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
