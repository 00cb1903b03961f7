import rclpy
import time
import math
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Oct(Node):
    def __init__(self):
        super().__init__('oct')
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
o = Oct()
time.sleep(1)
for i in range(8):
    o.go(1.25, 0.0, 2.0)
    o.go(0.0, 1.0, math.radians(45))
rclpy.shutdown()
