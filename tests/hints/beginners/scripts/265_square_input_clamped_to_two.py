import rclpy
import time
from rclpy.node import Node
from geometry_msgs.msg import Twist

class Safe(Node):
    def __init__(self, side):
        super().__init__('safe')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        if side > 1:
            side = 1       # 防止撞墙
        self.side = side

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
s = Safe(float(input('边长?')))
time.sleep(1)
for _ in range(4):
    s.go(0.5, 0.0, s.side / 0.5)
    s.go(0.0, 1.0, 1.5708)
rclpy.shutdown()
