"""只发布一次，小车 1 秒后就停了。"""

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node


class Forward(Node):
    def __init__(self):
        super().__init__('forward')
        self.publisher = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        msg = Twist()
        msg.linear.x = 0.2
        self.publisher.publish(msg)


def main():
    rclpy.init()
    rclpy.spin(Forward())


if __name__ == '__main__':
    main()
