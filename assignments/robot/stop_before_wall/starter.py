"""墙前停车：补上 on_scan。"""

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import LaserScan


class StopBeforeWall(Node):
    def __init__(self):
        super().__init__('stop_before_wall')
        self.publisher = self.create_publisher(Twist, '/cmd_vel', 10)
        self.create_subscription(LaserScan, '/scan', self.on_scan, qos_profile_sensor_data)

    def on_scan(self, scan):
        distance = scan.ranges[0]  # 正前方，单位 m
        self.get_logger().info(f'{distance:.2f} m')
        # TODO: 根据 distance 发布 Twist


def main():
    rclpy.init()
    node = StopBeforeWall()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    node.destroy_node()


if __name__ == '__main__':
    main()
