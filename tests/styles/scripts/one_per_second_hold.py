import time
import math
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


# 每秒只发一次,靠小乌龟保持 1 秒
class Slow(Node):
    def __init__(self):
        super().__init__('slow')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)

    def go(self, v, w, n):
        m = Twist()
        m.linear.x = float(v)
        m.angular.z = float(w)
        for i in range(n):
            self.pub.publish(m)
            time.sleep(1)


rclpy.init()
s = Slow()
s.go(1, 0, 2)
s.go(0, math.pi / 2, 1)
s.go(1, 0, 3)
rclpy.shutdown()
