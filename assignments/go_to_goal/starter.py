"""走到目标点：在 control() 里补全。"""

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
        # TODO：算出到目标的距离和方向，转向目标，走过去，到了就停下


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
