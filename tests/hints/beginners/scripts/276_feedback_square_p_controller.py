"""反馈控制走正方形：先转向目标，再一边走一边修正"""
import math

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from turtlesim.msg import Pose

SIDE = 2.0
SPEED = 0.8


def diff(a, b):
    return math.atan2(math.sin(a - b), math.cos(a - b))


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
        msg.linear.x = float(v)
        msg.angular.z = float(w)
        self.publisher.publish(msg)
        rclpy.spin_once(self)

    def turn_to(self, heading):
        ok = 0
        while ok < 10:                 # 连续10次都对准才算好
            e = diff(heading, self.pose.theta)
            ok = ok + 1 if abs(e) < 0.015 else 0
            w = max(-1.2, min(1.2, 1.5 * e))
            if abs(w) < 0.05 and abs(e) > 0.01:
                w = math.copysign(0.05, e)
            self.send(0.0, w)

    def drive_to(self, x, y, heading):
        while True:
            dx = x - self.pose.x
            dy = y - self.pose.y
            along = dx * math.cos(heading) + dy * math.sin(heading)
            across = -dx * math.sin(heading) + dy * math.cos(heading)
            if along < 0.02:
                break
            v = max(0.08, min(SPEED, 1.0 * along))
            # 偏离直线时稍微转回来
            want = heading + max(-0.5, min(0.5, 1.5 * across))
            self.send(v, 2.5 * diff(want, self.pose.theta))
        for _ in range(30):
            self.send(0.0, 0.0)

    def run(self):
        while self.pose is None:
            rclpy.spin_once(self)
        x, y, heading = self.pose.x, self.pose.y, self.pose.theta
        for _ in range(4):
            x += SIDE * math.cos(heading)
            y += SIDE * math.sin(heading)
            self.drive_to(x, y, heading)
            heading += math.pi / 2
            self.turn_to(heading)
        for _ in range(10):
            self.send(0.0, 0.0)


def main():
    rclpy.init()
    node = FeedbackSquare()
    node.run()
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
