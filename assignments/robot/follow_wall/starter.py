"""沿着右边的墙行驶：补上 TODO。"""

import math

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import LaserScan

GOAL = 0.4  # m


class WallFollower(Node):
    def __init__(self):
        super().__init__('wall_follower')
        self.publisher = self.create_publisher(Twist, '/cmd_vel', 10)
        self.create_subscription(LaserScan, '/scan', self.on_scan, qos_profile_sensor_data)

    def on_scan(self, scan):
        def distance(degrees):
            i = round((math.radians(degrees) % math.tau) / scan.angle_increment) % len(scan.ranges)
            return min(scan.ranges[i], scan.range_max)

        front = min(distance(d) for d in range(-20, 21, 4))
        side = sum(distance(d) for d in (268, 270, 272)) / 3
        ahead = sum(distance(d) for d in (313, 315, 317)) / 3
        msg = Twist()
        # TODO: 根据 front（前方）、side（右方）、ahead（右前方）决定速度，再发布 msg
        self.get_logger().info(f'{front:.2f} {side:.2f} {ahead:.2f} m')


def main():
    rclpy.init()
    node = WallFollower()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    node.destroy_node()


if __name__ == '__main__':
    main()
