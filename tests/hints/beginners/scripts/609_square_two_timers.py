import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist

class S(Node):
    def __init__(self):
        super().__init__('s')
        self.p = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.create_timer(0.1, self.go)
        self.create_timer(2.0, self.turn)
    def go(self):
        m = Twist()
        m.linear.x = 1.0
        self.p.publish(m)
    def turn(self):
        m = Twist()
        m.angular.z = 1.5708
        self.p.publish(m)
rclpy.init()
rclpy.spin(S())
