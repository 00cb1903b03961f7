import math
import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from turtlesim.msg import Pose

SIDE = 2.0


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

    def turn_to(self, heading):
        pass  # 不会写

    def drive_to(self, x, y):
        pass  # 不会写

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
        self.send(0.0, 0.0)


def main():
    rclpy.init()
    node = FeedbackSquare()
    node.run()
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
