import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist
import math
import time


class Spinner(Node):
    def __init__(self):
        super().__init__('spinner')
        self.vel_pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)

    def rotate(self, angle, w):
        twist = Twist()
        twist.angular.z = w
        duration = angle / w
        begin = self.get_clock().now().nanoseconds
        while self.get_clock().now().nanoseconds - begin < duration * 1e9:
            self.vel_pub.publish(twist)
            time.sleep(0.05)
        twist.angular.z = 0.0
        self.vel_pub.publish(twist)


def main():
    rclpy.init()
    node = Spinner()
    time.sleep(1)
    node.rotate(math.pi, 1.0)
    node.destroy_node()
    rclpy.shutdown()


main()
