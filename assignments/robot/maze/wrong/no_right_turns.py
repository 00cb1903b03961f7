import math

import rclpy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import LaserScan

GOAL = (2.4, 0.0)  # m
GAP = 0.36  # 与右墙的距离，m
SPEED = 0.15  # m/s
ANGLE = math.radians(45)


class Maze(Node):
    def __init__(self):
        super().__init__('maze')
        self.publisher = self.create_publisher(Twist, '/cmd_vel', 10)
        self.create_subscription(LaserScan, '/scan', self.on_scan, qos_profile_sensor_data)
        self.create_subscription(Odometry, '/odom', self.on_odom, 10)
        self.arrived = False

    def on_odom(self, odom):
        position = odom.pose.pose.position
        if math.hypot(position.x - GOAL[0], position.y - GOAL[1]) < 0.15:
            self.arrived = True
            self.publisher.publish(Twist())

    def on_scan(self, scan):
        def distance(degrees):
            i = round((math.radians(degrees) % math.tau) / scan.angle_increment) % len(scan.ranges)
            return max(min(scan.ranges[i], scan.range_max), 0.0)

        msg = Twist()
        front = min(distance(d) for d in range(-25, 26, 5))
        side = sum(distance(d) for d in (266, 270, 274)) / 3
        ahead = sum(distance(d) for d in (313, 315, 317)) / 3
        if self.arrived:
            pass
        elif front < 0.34:
            msg.angular.z = 1.0  # 前面是墙：左转
        elif ahead > 0.9:
            msg.linear.x = SPEED  # goes straight on where the wall ends
        else:
            angle = math.atan2(ahead * math.cos(ANGLE) - side, ahead * math.sin(ANGLE))
            gap = side * math.cos(angle)
            msg.linear.x = SPEED
            msg.angular.z = max(-1.0, min(1.0, 3.0 * (GAP - gap - 0.2 * math.sin(angle))))
        self.publisher.publish(msg)


def main():
    rclpy.init()
    node = Maze()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    node.destroy_node()


if __name__ == '__main__':
    main()
