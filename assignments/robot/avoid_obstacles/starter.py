"""避障：补上 TODO。"""

import math

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import LaserScan

NEAR = 0.4  # m


class Avoider(Node):
    def __init__(self):
        super().__init__('avoider')
        self.publisher = self.create_publisher(Twist, '/cmd_vel', 10)
        self.create_subscription(LaserScan, '/scan', self.on_scan, qos_profile_sensor_data)

    def on_scan(self, scan):
        def nearest(first, last):
            found = []
            for degrees in range(first, last + 1, 2):
                i = round((math.radians(degrees) % math.tau) / scan.angle_increment) % len(scan.ranges)
                found.append(max(min(scan.ranges[i], scan.range_max), 0.0))
            return min(found)

        front = nearest(-40, 40)
        msg = Twist()
        # TODO: 前方太近就转向，否则前进，再发布 msg
        self.get_logger().info(f'{front:.2f} m')


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
