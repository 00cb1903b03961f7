import rclpy
import time
from rclpy.node import Node
from geometry_msgs.msg import Twist

class SquareInput(Node):
    def __init__(self):
        super().__init__('square_input')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.side = float(raw_input('请输入边长：'))

    def run(self):
        for i in range(4):
            self.go(1.0, 0.0, self.side)
            self.go(0.0, 1.0, 1.5708)

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
n = SquareInput()
time.sleep(1)
n.run()
