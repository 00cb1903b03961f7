import math
import time

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from turtlesim.msg import Pose


class GoToGoal(Node):
    def __init__(self):
        super().__init__('go_to_goal')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.sub = self.create_subscription(Pose, '/turtle1/pose', self.pose_callback, 10)
        self.timer = self.create_timer(0.05, self.control)
        self.goal_x = 8.0
        self.goal_y = 3.0
        self.pose = None

    def pose_callback(self, msg):
        self.pose = msg

    def control(self):
        if self.pose is None:
            return
        dx = self.goal_x - self.pose.x
        dy = self.goal_y - self.pose.y
        dist = math.sqrt(dx ** 2 + dy ** 2)
        cmd = Twist()
        if dist < 0.1:
            self.pub.publish(cmd)
            return
        angle = math.atan2(dy, dx)
        err = angle - self.pose.theta
        while err > math.pi:
            err -= 2 * math.pi
        while err < -math.pi:
            err += 2 * math.pi
        if abs(err) > 0.1:
            cmd.angular.z = 2.0 * err
        else:
            cmd.linear.x = 1.0
            cmd.angular.z = 2.0 * err
        self.pub.publish(cmd)
        time.sleep(1)


def main():
    rclpy.init()
    rclpy.spin(GoToGoal())


if __name__ == '__main__':
    main()
