"""走到目标点：根据 /turtle1/pose 边走边修正。"""

import math

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from turtlesim.msg import Pose

GOAL_X, GOAL_Y = 8.0, 3.0  # m
TOLERANCE = 0.05  # m

def fold(angle):
    """把角度折算到 -π 到 π。"""
    return math.atan2(math.sin(angle), math.cos(angle))


class GoToGoal(Node):
    def __init__(self):
        super().__init__('go_to_goal')
        self.publisher = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.create_subscription(Pose, '/turtle1/pose', self.on_pose, 10)
        self.create_timer(0.02, self.control)
        self.pose = None

    def on_pose(self, pose):
        self.pose = pose

    def control(self):
        if self.pose is None:
            return
        dx = GOAL_X - self.pose.x
        dy = GOAL_Y - self.pose.y
        distance = math.hypot(dx, dy)
        msg = Twist()
        if distance < TOLERANCE:
            self.publisher.publish(msg)  # 到了：停下
            raise SystemExit
        error = fold(math.atan2(dy, dx) - self.pose.theta)
        msg.angular.z = 4.0 * error
        msg.linear.x = min(1.5, 1.0 * distance + 0.1) * max(math.cos(error), 0.0)
        self.publisher.publish(msg)


def main():
    rclpy.init()
    node = GoToGoal()
    try:
        rclpy.spin(node)
    except SystemExit:
        pass
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
