import rclpy, math
from rclpy.node import Node
from geometry_msgs.msg import Twist
from turtlesim.msg import Pose

class Spin(Node):
    def __init__(self):
        super().__init__('spin')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.create_subscription(Pose, '/turtle1/pose', self.cb, 10)
        self.done = False

    def cb(self, p):
        m = Twist()
        if p.theta > 3.0:
            self.done = True
        if not self.done:
            m.angular.z = 1.0
        self.pub.publish(m)

rclpy.init()
rclpy.spin(Spin())
