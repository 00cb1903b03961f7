import math
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist
from turtlesim.msg import Pose


class Zhuan(Node):
    """把每次转过的小角度加起来，够 2π 多一点就停"""

    def __init__(self):
        super().__init__('zhuan')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.create_subscription(Pose, '/turtle1/pose', self.cb, 10)
        self.last = None
        self.total = 0.0

    def cb(self, pose):
        if self.last is not None:
            d = pose.theta - self.last
            if d > math.pi:
                d -= 2 * math.pi
            if d < -math.pi:
                d += 2 * math.pi
            self.total += d
        self.last = pose.theta
        t = Twist()
        if self.total < 2 * math.pi + 0.05:
            t.angular.z = 1.2
        self.pub.publish(t)


rclpy.init()
z = Zhuan()
try:
    rclpy.spin(z)
except KeyboardInterrupt:
    pass
