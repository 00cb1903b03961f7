import math
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist, Pose


class FbSquare(Node):
    def __init__(self):
        super().__init__('fb_square')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.create_subscription(Pose, '/turtle1/pose', self.on_pose, 10)
        self.pose = None

    def on_pose(self, pose):
        self.pose = pose

    def send(self, v, w):
        m = Twist()
        m.linear.x = v
        m.angular.z = w
        self.pub.publish(m)
        rclpy.spin_once(self, timeout_sec=0.1)

    def run(self):
        while self.pose is None:
            rclpy.spin_once(self, timeout_sec=0.1)
        h = self.pose.theta
        for i in range(4):
            x, y = self.pose.x, self.pose.y
            while math.hypot(self.pose.x - x, self.pose.y - y) < 2.0:
                e = math.remainder(h - self.pose.theta, 2 * math.pi)
                self.send(0.6, 2 * e)
            h += math.pi / 2
            while abs(math.remainder(h - self.pose.theta, 2 * math.pi)) > 0.02:
                self.send(0.0, math.remainder(h - self.pose.theta, 2 * math.pi))
        self.send(0.0, 0.0)


rclpy.init()
FbSquare().run()
rclpy.shutdown()
