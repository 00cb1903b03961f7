import math
import time
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist

TURNS = [72, 72, 36, 72, 72]


class Pentagon(Node):
    def __init__(self):
        super().__init__('pentagon')
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


def main():
    rclpy.init()
    p = Pentagon()
    time.sleep(1)
    for deg in TURNS:
        p.go(1.0, 0.0, 1.5)
        p.go(0.0, 1.0, math.radians(deg))
    p.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
