# 长方形 长3m 宽2m   冯琳
import math
import time
import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node

CHANG = 3.0
KUAN = 2.0
V = 1.0
W = 1.0


class Rectangle(Node):
    def __init__(self):
        super().__init__('rectangle')
        self.publisher = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)

    def drive(self, v, w, seconds):
        msg = Twist()
        msg.linear.x = v
        msg.angular.z = w
        end = time.time() + seconds
        while time.time() < end:
            self.publisher.publish(msg)
            time.sleep(0.01)
        self.publisher.publish(Twist())
        time.sleep(0.1)

    def run(self):
        for i in range(4):
            # 偶数是长边，奇数是宽边
            bian = CHANG if i % 2 == 0 else KUAN
            self.drive(V, 0.0, bian / V)
            self.drive(0.0, W, math.pi / 2 / W)


def main():
    rclpy.init()
    node = Rectangle()
    time.sleep(0.5)
    node.run()
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
