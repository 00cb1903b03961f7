import rclpy
import time
from rclpy.node import Node
from geometry_msgs.msg import Twist


class DriveAndSpin(Node):
    def __init__(self):
        super().__init__('drive_and_spin')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)

    def go(self, v, w, t):
        m = Twist()
        m.linear.x = v
        m.angular.z = w
        s = time.time()
        while time.time() < s + t:
            self.pub.publish(m)
            time.sleep(0.02)
        self.pub.publish(Twist())
        time.sleep(0.1)


def main():
    rclpy.init()
    n = DriveAndSpin()
    time.sleep(1)
    n.go(1.0, 0.0, 1.0)     # 先走到空的地方
    n.go(0.0, 1.0, 6.6)
    n.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
