import math, time
import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node

class Sq(Node):
    def __init__(self):
        super().__init__('sq')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)

    def go(self, v, w, t):
        m = Twist()
        m.linear.x = v
        m.angular.z = w
        e = time.time() + t
        while time.time() < e:
            self.pub.publish(m)
            time.sleep(0.01)
        self.pub.publish(Twist())
        time.sleep(0.1)

rclpy.init()
s = Sq()
time.sleep(1)
for _ in range(4):
    s.go(1.0, 0.0, 1.0)
    s.go(0.0, 1.0, math.degrees(90))
s.destroy_node()
rclpy.shutdown()
