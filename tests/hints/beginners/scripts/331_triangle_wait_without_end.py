import math
import time
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Triangle(Node):
    def __init__(self):
        super().__init__('triangle')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)

    def wait(self):
        while not self.pub.get_subscription_count() > 1:
            self.get_logger().info('等待小乌龟...')
            time.sleep(0.5)

    def drive(self, v, w, t):
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
    node = Triangle()
    node.wait()
    for i in range(3):
        node.drive(1.0, 0.0, 2.0)
        node.drive(0.0, 1.0, 2 * math.pi / 3)
    rclpy.shutdown()


if __name__ == '__main__':
    main()
