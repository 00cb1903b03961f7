import math

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import LaserScan

NEAR = 0.4  # m
CLEAR = 0.55  # m


class Avoider(Node):
    def __init__(self):
        super().__init__('avoider')
        self.publisher = self.create_publisher(Twist, '/cmd_vel', 10)
        self.create_subscription(LaserScan, '/scan', self.on_scan, qos_profile_sensor_data)
        self.turning = 0.0

    def on_scan(self, scan):
        def nearest(first, last):
            found = []
            for degrees in range(first, last + 1, 2):
                i = round((math.radians(degrees) % math.tau) / scan.angle_increment) % len(scan.ranges)
                found.append(max(min(scan.ranges[i], scan.range_max), 0.0))
            return min(found)

        front = nearest(-40, 40)
        msg = Twist()
        if self.turning and front > CLEAR:
            self.turning = 0.0
        elif not self.turning and front < NEAR:
            self.turning = 1.0 if nearest(20, 90) > nearest(-90, -20) else -1.0
        if self.turning:
            pass  # stops for good at the first obstacle
        else:
            msg.linear.x = 0.2
        self.publisher.publish(msg)


def main():
    rclpy.init()
    node = Avoider()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    node.destroy_node()


if __name__ == '__main__':
    main()
