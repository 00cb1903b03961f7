import rclpy, math
from rclpy.node import Node
from geometry_msgs.msg import Twist
from turtlesim.msg import Pose

class Spin(Node):
    def __init__(self):
        super().__init__('spin')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.create_subscription(Pose, '/turtle1/pose', self.cb, 10)

    def cb(self, p):
        m = Twist()
        if abs(p.theta) > 0.05:
            m.angular.z = 1.0
        else:
            m.angular.z = 0.0
        self.pub.publish(m)

rclpy.init()
rclpy.spin(Spin())
