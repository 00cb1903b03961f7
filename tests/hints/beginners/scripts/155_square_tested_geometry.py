import math
import time
import unittest

import rclpy
from geometry_msgs.msg import Twist


def exterior_angle(sides: int) -> float:
    """正多边形的外角（弧度）"""
    if sides < 3:
        raise ValueError('至少三条边')
    return 2.0 * math.pi / sides


class GeometryTest(unittest.TestCase):
    def test_square(self):
        self.assertAlmostEqual(exterior_angle(4), 1.5708, places=4)

    def test_too_few(self):
        with self.assertRaises(ValueError):
            exterior_angle(2)


def polygon(publish, sides, length, v=1.0, w=1.0):
    def act(linear, angular, seconds):
        cmd = Twist()
        cmd.linear.x = linear
        cmd.angular.z = angular
        stop_at = time.perf_counter() + seconds
        while time.perf_counter() < stop_at:
            publish(cmd)
            time.sleep(0.01)
        publish(Twist())
        time.sleep(0.1)

    for _ in range(sides):
        act(v, 0.0, length / v)
        act(0.0, w, exterior_angle(sides) / w)


def main():
    assert abs(exterior_angle(4) - math.pi / 2) < 1e-9
    rclpy.init()
    node = rclpy.create_node('polygon')
    pub = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)
    while pub.get_subscription_count() < 1:
        time.sleep(0.05)
    polygon(pub.publish, 4, 2.0)
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
