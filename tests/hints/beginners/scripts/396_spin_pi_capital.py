import time
from math import Pi

import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Spinner(Node):
    """原地转一圈"""

    def __init__(self):
        super().__init__('spinner')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)

    def zhuan(self, w, shijian):
        msg = Twist()
        msg.angular.z = w
        kaishi = time.time()
        while time.time() - kaishi < shijian:
            self.pub.publish(msg)
            time.sleep(0.05)
        self.pub.publish(Twist())
        time.sleep(0.2)


def main():
    rclpy.init()
    node = Spinner()
    time.sleep(1)
    node.zhuan(1.0, 2 * Pi)
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
