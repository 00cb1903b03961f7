import math
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist
from turtlesim.msg import Pose


class F(Node):
    def __init__(self):
        super().__init__('f')
        self.pose = None
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.create_subscription(Pose, '/turtle1/pose', self.on_pose, 10)
        ziel = self.pose.theta + math.pi / 2
        self.get_logger().info(str(ziel))

    def on_pose(self, p):
        self.pose = p


def main():
    rclpy.init()
    rclpy.spin(F())


main()
