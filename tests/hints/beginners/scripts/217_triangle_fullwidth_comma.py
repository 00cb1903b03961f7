# 三角形
import rclpy
import time
from rclpy.node import Node
from geometry_msgs.msg import Twist

class San(Node):
    def __init__(self):
        super().__init__('san')
        self.pub = self.create_publisher(Twist， '/turtle1/cmd_vel'， 10)

    def go(self, v, w, t):
        m = Twist()
        m.linear.x = v
        m.angular.z = w
        e = time.time() + t
        while time.time() < e:
            self.pub.publish(m)
            time.sleep(0.01)

rclpy.init()
s = San()
time.sleep(1)
for i in range(3):
    s.go(1.0, 0.0, 2.0)
    s.go(0.0, 1.0, 2.094)
s.go(0.0, 0.0, 0.1)
