import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import LaserScan


class Robot(Node):
    def __init__(self):
        super().__init__('robot')
        self.publisher = self.create_publisher(Twist, '/cmd_vel', 10)
        self.create_subscription(LaserScan, '/scan', self.on_scan, 10)

    def on_scan(self, scan):
        msg = Twist()
        if scan.ranges[0] > 0.55:
            msg.linear.x = 0.15
        self.publisher.publish(msg)


def main():
    rclpy.init()
    rclpy.spin(Robot())


if __name__ == '__main__':
    main()
