"""用里程计依次走到三个目标。"""

import math

import rclpy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from rclpy.node import Node

GOALS = [1.2, 0.6, 1.8, -0.5, 0.4, -0.8]  # m
TOLERANCE = 0.06  # m


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
        msg = Twist()
        if self.goals:
            dx = self.goals[0][0] - position.x
            dy = self.goals[0][1] - position.y
            error = math.remainder(math.atan2(dy, dx) - yaw, math.tau)
            if math.hypot(dx, dy) < TOLERANCE:
                self.goals.pop(0)
            elif abs(error) > 0.3:
                msg.angular.z = 1.0 if error > 0 else -1.0  # 先转向目标
            else:
                msg.linear.x = 0.2
                msg.angular.z = 2.0 * error
        self.publisher.publish(msg)


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
