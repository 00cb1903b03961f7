#!/usr/bin/env python3
"""
直行  陈洁  机器人2班
"""
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class GoNode(Node):

    def __init__(self):
        super().__init__('go_node')
        self.cmd_vel_pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.timer = self.create_timer(0.1, self.timer_callback)
        self.get_logger().info('小乌龟出发')

    def timer_callback(self):
        msg = Twist()
        msg.linear.x = 0.8
        msg.angular.z = 0.0
        self.cmd_vel_pub.publish(msg)


def main(args=None):
    rclpy.init(args=args)
    node = GoNode()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
