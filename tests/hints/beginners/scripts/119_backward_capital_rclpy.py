import Rclpy
from Rclpy.node import Node
from geometry_msgs.msg import Twist

class Backward(Node):
    def __init__(self):
        super().__init__('backward')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.timer = self.create_timer(0.1, self.cb)
    def cb(self):
        msg = Twist()
        msg.linear.x = -1.0
        self.pub.publish(msg)

Rclpy.init()
Rclpy.spin(Backward())
