import rclpy, threading
from rclpy.node import Node
from geometry_msgs.msg import Twist

class S(Node):
    def __init__(self):
        super().__init__('s')
        self.p = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        threading.Timer(0.1, self.go)
    def go(self):
        m = Twist()
        m.linear.x = 1.0
        self.p.publish(m)
rclpy.init()
rclpy.spin(S())
