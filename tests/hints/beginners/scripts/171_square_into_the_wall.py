import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist
import time
import math


class BigSquare(Node):

    def __init__(self):
        super().__init__('big_square')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.side = 6.0
        self.v = 2.0
        self.w = 1.0

    def run_for(self, v, w, t):
        msg = Twist()
        msg.linear.x = v
        msg.angular.z = w
        begin = time.time()
        while time.time() - begin < t:
            self.pub.publish(msg)
            time.sleep(0.01)
        self.pub.publish(Twist())
        time.sleep(0.1)

    def go(self):
        for _ in range(4):
            self.run_for(self.v, 0.0, self.side / self.v)
            self.run_for(0.0, self.w, math.pi / 2 / self.w)


rclpy.init()
node = BigSquare()
time.sleep(1)
node.go()
node.destroy_node()
rclpy.shutdown()
