import time
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Mover(Node):
    def __init__(self):
        super().__init__('mover')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.xiuzheng = 0.1       # 修正偏移

    def straight(self):
        m = Twist()
        m.linear.x = 1.0
        m.angular.z = self.xiuzheng
        self.keep(m, 2.0)

    def turn(self):
        m = Twist()
        m.angular.z = 1.0
        self.keep(m, 1.5708)

    def keep(self, m, s):
        t = time.time() + s
        while time.time() < t:
            self.pub.publish(m)
            time.sleep(0.01)
        self.pub.publish(Twist())
        time.sleep(0.1)


def main():
    rclpy.init()
    n = Mover()
    time.sleep(1)
    for i in range(4):
        n.straight()
        n.turn()
    n.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
