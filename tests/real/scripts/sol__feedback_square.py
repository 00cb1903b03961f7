"""走一个正方形：根据 /turtle1/pose 的反馈修正方向和距离。"""

import math

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from turtlesim.msg import Pose

SIDE = 2.0  # m
SPEED = 1.0  # m/s


def angle_off(wanted, actual):
    """两个角度之差，折算到 -π 到 π。"""
    return math.atan2(math.sin(wanted - actual), math.cos(wanted - actual))


class FeedbackSquare(Node):
    def __init__(self):
        super().__init__('feedback_square')
        self.publisher = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.create_subscription(Pose, '/turtle1/pose', self.on_pose, 10)
        self.pose = None

    def on_pose(self, pose):
        self.pose = pose

    def send(self, v, w):
        msg = Twist()
        msg.linear.x = v
        msg.angular.z = w
        self.publisher.publish(msg)
        rclpy.spin_once(self)  # 等下一个位姿

    def turn_to(self, heading):
        while abs(angle_off(heading, self.pose.theta)) > 0.01 or abs(self.pose.angular_velocity) > 0.05:
            self.send(0.0, 2.0 * angle_off(heading, self.pose.theta))

    def drive_to(self, x, y):
        while True:
            dx, dy = x - self.pose.x, y - self.pose.y
            left = dx * math.cos(self.pose.theta) + dy * math.sin(self.pose.theta)  # 前方还剩的距离
            if left < 0.01:
                break
            # 离目标很近时方向角没有意义，保持原方向
            w = 4.0 * angle_off(math.atan2(dy, dx), self.pose.theta) if left > 0.2 else 0.0
            self.send(min(SPEED, 0.1 + 1.5 * left), w)
        while abs(self.pose.linear_velocity) > 0.02:
            self.send(0.0, 0.0)

    def run(self):
        while self.pose is None:
            rclpy.spin_once(self)
        x, y, heading = self.pose.x, self.pose.y, self.pose.theta
        for _ in range(4):
            x += SIDE * math.cos(heading)
            y += SIDE * math.sin(heading)
            self.turn_to(math.atan2(y - self.pose.y, x - self.pose.x))
            self.drive_to(x, y)
            heading += math.radians(90.0)
        self.turn_to(heading)
        self.send(0.0, 0.0)


def main():
    rclpy.init()
    node = FeedbackSquare()
    node.run()
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
