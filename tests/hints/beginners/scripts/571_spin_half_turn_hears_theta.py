import math, time
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist
from turtlesim.msg import Pose

class Spin(Node):
    def __init__(self):
        super().__init__('spin')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.create_subscription(Pose, '/turtle1/pose', self.cb, 10)
        self.create_timer(0.05, self.tick)
        self.n = 0

    def cb(self, p):
        self.get_logger().debug(f'theta {p.theta}')
        self.theta = p.theta

    def tick(self):
        m = Twist()
        self.n += 1
        if self.n < 63:
            m.angular.z = 1.0
        self.pub.publish(m)

rclpy.init()
rclpy.spin(Spin())
