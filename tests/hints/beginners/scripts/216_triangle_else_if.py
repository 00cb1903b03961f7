import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Tri(Node):
    def __init__(self):
        super().__init__('tri')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.n = 0
        self.create_timer(0.1, self.cb)

    def cb(self):
        self.n += 1
        k = self.n % 40
        m = Twist()
        if k < 20:
            m.linear.x = 1.0
        else if k < 40:
            m.angular.z = 1.0472
        if self.n > 120:
            m = Twist()
        self.pub.publish(m)


rclpy.init()
rclpy.spin(Tri())
