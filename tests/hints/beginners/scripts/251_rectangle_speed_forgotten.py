import rclpy
import time
import math
from rclpy.node import Node
from geometry_msgs.msg import Twist


class RectangleNode(Node):
    SPEED = 0.5

    def __init__(self):
        super().__init__('rectangle_node')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)

    def line(self, length):
        self.keep(self.SPEED, 0.0, length)

    def corner(self):
        self.keep(0.0, math.pi / 4, 2.0)

    def keep(self, v, w, t):
        m = Twist()
        m.linear.x = v
        m.angular.z = w
        e = time.time() + t
        while time.time() < e:
            self.pub.publish(m)
            time.sleep(0.01)
        self.pub.publish(Twist())
        time.sleep(0.1)


def main():
    rclpy.init()
    n = RectangleNode()
    time.sleep(1)
    for _ in range(2):
        n.line(3.0)
        n.corner()
        n.line(2.0)
        n.corner()
    n.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
