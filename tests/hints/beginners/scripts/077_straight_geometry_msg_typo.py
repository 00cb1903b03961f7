import rclpy
from geometry_msg.msg import Twist
from rclpy.node import Node

class F(Node):
    def __init__(self):
        super().__init__('f')
        self.p = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.t = self.create_timer(0.1, self.c)
    def c(self):
        m = Twist()
        m.linear.x = 1.0
        self.p.publish(m)

rclpy.init()
rclpy.spin(F())
