import math

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import LaserScan

GOAL = 0.4  # m
SPEED = 0.15  # m/s
ANGLE = math.radians(45)


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
        # 与墙的夹角：正数表示车头偏离墙
        angle = math.atan2(ahead * math.cos(ANGLE) - side, ahead * math.sin(ANGLE))
        gap = side * math.cos(angle)
        msg = Twist()
        if front < GOAL + 0.12:
            msg.angular.z = 1.0
        else:
            msg.linear.x = SPEED
            error = (gap + 0.25 * math.sin(angle)) - GOAL
            msg.angular.z = max(-1.0, min(1.0, 3.0 * error))
        self.publisher.publish(msg)


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
