# 用记事本写的
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist

class Notepad(Node):
    def __init__(self):
        super().__init__('notepad')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.timer = self.create_timer(0.1, self.cb)
    def cb(self):
        m = Twist()
        m.linear.x = 0.7
        self.pub.publish(m)

rclpy.init()
rclpy.spin(Notepad())
