"""墙前停车：根据激光雷达正前方的距离决定速度。"""

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import LaserScan

GOAL = 0.5  # m


class StopBeforeWall(Node):
    def __init__(self):
        super().__init__('stop_before_wall')
        self.publisher = self.create_publisher(Twist, '/cmd_vel', 10)
        # 传感器数据用 BEST_EFFORT 发布，订阅也要用同样的 QoS
        self.create_subscription(LaserScan, '/scan', self.on_scan, qos_profile_sensor_data)

    def on_scan(self, scan):
        ahead = scan.ranges[178:183]  # 正前方 5 条光线
        distance = sum(ahead) / len(ahead)
        msg = Twist()
        if distance > GOAL + 0.02:
            msg.linear.x = min(0.2, 0.8 * (distance - GOAL) + 0.01)
        self.publisher.publish(msg)


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
