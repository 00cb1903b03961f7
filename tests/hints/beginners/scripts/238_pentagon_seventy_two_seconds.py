from rclpy.node import Node
from geometry_msgs.msg import Twist
import rclpy
import time

bianshu = 5
waijiao = 360 / bianshu      # 72
sudu = 1.0
jiaosudu = 1.0


class Wubianxing(Node):
    def __init__(self):
        super().__init__('wubianxing')
        self.fabu = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)

    def yidong(self, x, z, shijian):
        xinxi = Twist()
        xinxi.linear.x = x
        xinxi.angular.z = z
        kaishi = time.time()
        while time.time() - kaishi < shijian:
            self.fabu.publish(xinxi)
            time.sleep(0.01)
        self.fabu.publish(Twist())
        time.sleep(0.1)


def main():
    rclpy.init()
    w = Wubianxing()
    time.sleep(1)
    for i in range(bianshu):
        w.yidong(sudu, 0.0, 2.0 / sudu)
        w.yidong(0.0, jiaosudu, waijiao / jiaosudu)
    rclpy.shutdown()


if __name__ == '__main__':
    main()
