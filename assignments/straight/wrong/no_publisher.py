"""节点在运行，但没有创建发布者。"""

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node


class Forward(Node):
    def __init__(self):
        super().__init__('forward')
        self.msg = Twist()
        self.msg.linear.x = 1.0


def main():
    rclpy.init()
    rclpy.spin(Forward())


if __name__ == '__main__':
    main()
