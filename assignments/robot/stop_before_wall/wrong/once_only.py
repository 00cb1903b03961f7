import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import LaserScan


class Robot(Node):
    def __init__(self):
        super().__init__('robot')
        self.publisher = self.create_publisher(Twist, '/cmd_vel', 10)
        self.create_subscription(LaserScan, '/scan', self.on_scan, qos_profile_sensor_data)

    def on_scan(self, scan):
        msg = Twist()
        if scan.ranges[0] > 0.5:
            msg.linear.x = 0.15
        self.publisher.publish(msg)


rclpy.init()
node = Robot()
rclpy.spin_once(node, timeout_sec=0.1)  # before the first scan comes
