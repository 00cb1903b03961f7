import time
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist
from turtlesim.msg import Pose


class F(Node):
    def __init__(self):
        super().__init__('f')
        self.pose = None
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.sub = self.create_subscription(Pose, '/turtle1/pose', self.on_pose)

    def on_pose(self, p):
        self.pose = p


def main():
    rclpy.init()
    n = F()
    rclpy.spin(n)


main()
