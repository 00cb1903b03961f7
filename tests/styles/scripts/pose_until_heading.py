import math
import sys
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist
from turtlesim.msg import Pose


class Turner(Node):
    def __init__(self):
        super().__init__('turner')
        self.pose = Pose()
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.sub = self.create_subscription(Pose, '/turtle1/pose', self.on_pose, 10)
        self.timer = self.create_timer(0.02, self.control)

    def on_pose(self, msg):
        self.pose = msg

    def control(self):
        cmd = Twist()
        if self.pose.theta < math.pi / 2:
            cmd.angular.z = 0.5
            self.pub.publish(cmd)
        else:
            self.pub.publish(cmd)
            self.get_logger().info('90 degrees')
            sys.exit(0)


def main():
    rclpy.init()
    rclpy.spin(Turner())


if __name__ == '__main__':
    main()
