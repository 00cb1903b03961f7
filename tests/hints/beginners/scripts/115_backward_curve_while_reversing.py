import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist

class Dao(Node):
    def __init__(self):
        super().__init__('dao')
        self.x = -1.0
        self.z = 0.5
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.tm = self.create_timer(0.05, self.f)

    def f(self):
        t = Twist()
        t.linear.x = self.x
        t.angular.z = self.z
        self.pub.publish(t)

if __name__ == '__main__':
    rclpy.init()
    d = Dao()
    rclpy.spin(d)
