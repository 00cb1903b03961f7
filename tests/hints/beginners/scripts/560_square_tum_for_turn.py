import math
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist
from turtlesim.msg import Pose


class Square(Node):
    def __init__(self):
        super().__init__('square')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.create_subscription(Pose, '/turtle1/pose', self.on_pose, 10)
        self.state = 'drive'
        self.side = 0
        self.start = None
        self.target = 0.0

    def on_pose(self, pose):
        msg = Twist()
        if self.side >= 4:
            self.pub.publish(msg)
            return
        if self.start is None:
            self.start = pose
            self.target = pose.theta
        if self.state == 'drive':
            d = math.hypot(pose.x - self.start.x, pose.y - self.start.y)
            if d < 2.0:
                msg.linear.x = 1.0
            else:
                self.state = 'turn'
                self.target = self.target + math.pi / 2
        elif self.state == 'tum':
            err = math.atan2(math.sin(self.target - pose.theta), math.cos(self.target - pose.theta))
            if abs(err) > 0.01:
                msg.angular.z = 1.5 * err
            else:
                self.state = 'drive'
                self.start = pose
                self.side += 1
        self.pub.publish(msg)


rclpy.init()
rclpy.spin(Square())
