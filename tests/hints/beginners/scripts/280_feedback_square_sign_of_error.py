import math
import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from turtlesim.msg import Pose


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
        rclpy.spin_once(self)

    def error(self, wanted):
        a = self.pose.theta - wanted
        return math.atan2(math.sin(a), math.cos(a))

    def turn_to(self, heading):
        while abs(self.error(heading)) > 0.02:
            self.send(0.0, 1.5 * self.error(heading))

    def drive(self, heading, length):
        x, y = self.pose.x, self.pose.y
        while math.hypot(self.pose.x - x, self.pose.y - y) < length:
            self.send(0.6, 1.5 * self.error(heading))

    def run(self):
        while self.pose is None:
            rclpy.spin_once(self)
        h = self.pose.theta
        for _ in range(4):
            self.drive(h, 2.0)
            h += math.pi / 2
            self.turn_to(h)
        self.send(0.0, 0.0)


def main():
    rclpy.init()
    node = FeedbackSquare()
    node.run()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
