import math, time, rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist

class Da(Node):
    def __init__(self):
        super().__init__('da')
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
d = Da()
time.sleep(1)
for i in range(3):
    d.go(2.0, 0.0, 3.4)
    d.go(0.0, -1.5, math.radians(120) / 1.5)
rclpy.shutdown()
