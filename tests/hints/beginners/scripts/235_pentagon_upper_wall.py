import rclpy
import time
import math
from rclpy.node import Node
from geometry_msgs.msg import Twist


class BigPentagon(Node):
    def __init__(self):
        super().__init__('big_pentagon')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)

    def drive(self, v, w, t):
        m = Twist()
        m.linear.x = v
        m.angular.z = w
        s = time.time()
        while time.time() - s < t:
            self.pub.publish(m)
            time.sleep(0.01)
        self.pub.publish(Twist())
        time.sleep(0.1)


def main():
    SIDE = 4.0       # 大一点好看
    V = 2.0
    rclpy.init()
    node = BigPentagon()
    time.sleep(1)
    for i in range(5):
        node.drive(V, 0.0, SIDE / V)
        node.drive(0.0, 1.0, 2 * math.pi / 5)
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
