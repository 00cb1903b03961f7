import time
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist

SIDE = 2.0
V = 1.0
W = 1.0
ANGLE = 2.356   # 弧度


class SquareNode(Node):
    def __init__(self):
        super().__init__('square_node')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        time.sleep(1)
        for k in range(4):
            self.cmd(V, 0.0, SIDE / V)
            self.cmd(0.0, W, ANGLE / W)

    def cmd(self, v, w, t):
        m = Twist()
        m.linear.x = v
        m.angular.z = w
        end = time.time() + t
        while time.time() < end:
            self.pub.publish(m)
            time.sleep(0.01)
        self.pub.publish(Twist())
        time.sleep(0.1)


def main():
    rclpy.init()
    SquareNode()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
