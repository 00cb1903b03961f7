"""等 /odom 的消息才前进，但 turtlesim 不发布 /odom。"""

import rclpy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from rclpy.node import Node


class Forward(Node):
    def __init__(self):
        super().__init__('forward')
        self.publisher = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.create_subscription(Odometry, '/odom', self.on_odom, 10)

    def on_odom(self, odom):
        msg = Twist()
        if odom.pose.pose.position.x < 2.0:
            msg.linear.x = 1.0
        self.publisher.publish(msg)


def main():
    rclpy.init()
    rclpy.spin(Forward())


if __name__ == '__main__':
    main()
