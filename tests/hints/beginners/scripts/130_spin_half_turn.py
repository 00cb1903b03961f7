import time
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist

PI = 3.1415926


class Spin(Node):
    def __init__(self):
        super().__init__('spin')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)

    def spin_once_around(self):
        msg = Twist()
        msg.angular.z = 1.0
        start = time.time()
        while time.time() - start < PI:     # 一圈 = π
            self.pub.publish(msg)
            time.sleep(0.01)
        self.pub.publish(Twist())


def main():
    rclpy.init()
    s = Spin()
    time.sleep(1)
    s.spin_once_around()
    time.sleep(0.5)
    rclpy.shutdown()


if __name__ == '__main__':
    main()
