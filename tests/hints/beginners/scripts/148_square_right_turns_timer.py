import math
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist

DT = 0.05
BIAN = 2.0
V = 1.0
ZHUAN_TICKS = 40            # 转弯用 40 次 = 2 秒
W = -(math.pi / 2) / (ZHUAN_TICKS * DT)   # 右转


class SquareTimer(Node):
    """状态机：0 直行，1 转弯，2 结束"""

    def __init__(self):
        super().__init__('square_timer')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.state = -1
        self.ticks = 0
        self.corner = 0
        self.timer = self.create_timer(DT, self.step)

    def step(self):
        msg = Twist()
        self.ticks += 1
        if self.state == -1:            # 先等1秒
            if self.ticks >= 20:
                self.state, self.ticks = 0, 0
        elif self.state == 0:
            msg.linear.x = V
            if self.ticks >= BIAN / V / DT:
                self.state, self.ticks = 1, 0
        elif self.state == 1:
            msg.angular.z = W
            if self.ticks >= ZHUAN_TICKS:
                self.corner += 1
                self.ticks = 0
                self.state = 0 if self.corner < 4 else 2
        self.pub.publish(msg)


def main():
    rclpy.init()
    node = SquareTimer()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass


if __name__ == '__main__':
    main()
