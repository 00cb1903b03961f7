"""用里程计依次走到三个目标：补上 TODO。"""

import math

import rclpy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from rclpy.node import Node

GOALS = [(1.2, 0.6), (1.8, -0.5), (0.4, -0.8)]  # m


class GoToGoals(Node):
    def __init__(self):
        super().__init__('go_to_goals')
        self.publisher = self.create_publisher(Twist, '/cmd_vel', 10)
        self.create_subscription(Odometry, '/odom', self.on_odom, 10)
        self.goals = list(GOALS)

    def on_odom(self, odom):
        position = odom.pose.pose.position
        q = odom.pose.pose.orientation
        yaw = 2.0 * math.atan2(q.z, q.w)
        # TODO: 先转向 self.goals[0]，再开过去；到了就换下一个，最后发布全零的 Twist
        self.get_logger().info(f'{position.x:.2f} {position.y:.2f} {yaw:.2f}')


def main():
    rclpy.init()
    node = GoToGoals()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    node.destroy_node()


if __name__ == '__main__':
    main()
