import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist
from turtlesim.msg import Pose


class F(Node):
    def __init__(self):
        super().__init__('f')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.sub = self.create_subscription(Pose, '/turtle1/pose', self.on_pose, 10)

    def on_pose(self):
        m = Twist()
        m.linear.x = 1.0
        self.pub.publish(m)


def main():
    rclpy.init()
    rclpy.spin(F())


main()
