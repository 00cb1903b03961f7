"""创建了定时器，却没有 spin。"""

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node


class Forward(Node):
    def __init__(self):
        super().__init__('forward')
        self.publisher = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.timer = self.create_timer(0.1, self.tick)

    def tick(self):
        msg = Twist()
        msg.linear.x = 1.0
        self.publisher.publish(msg)


def main():
    rclpy.init()
    node = Forward()
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
