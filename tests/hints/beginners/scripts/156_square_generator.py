import math
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


def commands():
    """每 0.1 秒给一个 (线速度, 角速度)"""
    for _ in range(10):
        yield 0.0, 0.0
    for _ in range(4):
        for _ in range(20):
            yield 1.0, 0.0
        for _ in range(10):
            yield 0.0, math.pi / 2
    while True:
        yield 0.0, 0.0


class GenNode(Node):
    def __init__(self):
        super().__init__('gen_node')
        self.gen = commands()
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.create_timer(0.1, lambda: self.send(*next(self.gen)))

    def send(self, v, w):
        m = Twist()
        m.linear.x = v
        m.angular.z = w
        self.pub.publish(m)


rclpy.init()
rclpy.spin(GenNode())
