"""走一个正方形：根据 /turtle1/pose 的反馈修正方向和距离。把 TODO 补全。"""

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
        pass  # TODO: 转到方向 heading（弧度）：误差越小，角速度越小

    def drive_to(self, x, y):
        pass  # TODO: 开到 (x, y)：边走边用 angle_off() 修正方向，快到时减速

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
